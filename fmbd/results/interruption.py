"""Ctrl-C and SIGTERM while a run is computed: noted, so that the run ends in good order."""

import signal
import threading
from types import FrameType, TracebackType
from typing import Any, Self

REASONS = {signal.SIGINT: "interrupted by the user", signal.SIGTERM: "terminated by a signal"}


class Interruption:
    """From `watch` to the end of the context, the first signal only gives a `reason`; a second acts as ever.

    After the context SIGTERM, put off but not forgotten, acts as ever too. Works in the main thread, does
    nothing in others.
    """

    def __init__(self) -> None:
        self.reason = ""
        self._received: int | None = None
        self._before: dict[int, Any] = {}

    def watch(self) -> None:
        """Begin to catch signals; signals that are ignored stay so."""
        if self._before or self._received or threading.current_thread() is not threading.main_thread():
            return
        for number in REASONS:
            handler = signal.getsignal(number)
            if handler not in (signal.SIG_IGN, None):
                self._before[number] = signal.signal(number, self._note)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.reason, self._received = REASONS[signal.Signals(number)], number
        self._restore()

    def _restore(self) -> None:
        while self._before:
            signal.signal(*self._before.popitem())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._restore()
        if self._received == signal.SIGTERM:
            signal.raise_signal(signal.SIGTERM)
