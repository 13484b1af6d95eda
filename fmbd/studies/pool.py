"""Jobs side by side in processes of their own: one progress, one Ctrl-C, failures that stay where they arise."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from typing import Any

#: Called by a job with the share of it that is done, 0 to 1.
Report = Callable[[float], None]
#: A picklable function; it is given the report to call, often.
Job = Callable[[Report], Any]

#: Seconds between two looks at the progress.
_TICK = 0.1
#: Several processes with several threads each would only hinder one another.
_ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OPENBLAS", "OMP", "MKL")}


def side_by_side(
    jobs: Sequence[Job], workers: int = 1, on_progress: Report | None = None
) -> Iterator[tuple[int, Any]]:
    """Yield the index of each job with its result, or with the exception that it ended by, as they end.

    The first job is done here, by itself, so that what it compiles is there for the others; these, too, if there is
    one worker. More workers are processes started anew, so that a script that wants them needs
    `if __name__ == "__main__"`. `on_progress` is called with the share of all that is done. Ctrl-C ends the jobs and
    raises KeyboardInterrupt.
    """
    shares = [0.0] * len(jobs)

    def progress(k: int, share: float) -> None:
        shares[k] = share
        if on_progress is not None:
            on_progress(sum(shares) / len(jobs))

    for k, job in enumerate(jobs if workers == 1 else jobs[:1]):
        yield k, _attempted(job, partial(progress, k))
    if workers == 1:
        return
    left = dict(enumerate(jobs[1:], start=1))
    for k, result in _in_processes(dict(left), workers, progress):
        del left[k]
        yield k, result
    for k, job in left.items():  # a process died, and those beside it fell with it: each gets one of its own
        result = dict(_in_processes({k: job}, 1, progress)).get(k)
        yield k, result or MemoryError("its process was killed: was there too little memory?")


def _attempted(job: Job, report: Report) -> Any:
    try:
        return job(report)
    except Exception as error:
        return error


def _in_processes(
    jobs: dict[int, Job], workers: int, progress: Callable[[int, float], None]
) -> Iterator[tuple[int, Any]]:
    """As `side_by_side`; jobs that get lost when a process dies are left out."""
    if not jobs:
        return
    context = multiprocessing.get_context("spawn")
    # without a lock, which a process that dies would keep: the share of each job, and at last whether to stop
    board = context.RawArray("d", max(jobs) + 2)
    with (
        _environment(_ONE_THREAD),
        ProcessPoolExecutor(min(workers, len(jobs)), context, _begin, (board,)) as pool,
    ):
        try:
            waiting = {pool.submit(_work, k, job): k for k, job in jobs.items()}
            while waiting:
                done, _ = wait(waiting, _TICK, FIRST_COMPLETED)
                for k in waiting.values():
                    progress(k, board[k])
                yield from _ended({future: waiting.pop(future) for future in done})
        except BrokenProcessPool:
            return
        except BaseException:
            board[-1] = 1.0
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _ended(done: dict[Future[Any], int]) -> Iterator[tuple[int, Any]]:
    for future, k in done.items():
        try:
            yield k, future.result()
        except BrokenProcessPool:
            continue


@contextmanager
def _environment(variables: dict[str, str]) -> Iterator[None]:
    """Variables for the processes that are started meanwhile; those that are set already stay."""
    new = variables.keys() - os.environ.keys()
    os.environ.update({name: variables[name] for name in new})
    try:
        yield
    finally:
        for name in new:
            del os.environ[name]


_board: Any = None


def _begin(board: Any) -> None:
    """In a new process: Ctrl-C is for the one that started it, and it does not outlive that one."""
    global _board
    _board = board
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _work(k: int, job: Job) -> Any:
    def report(share: float) -> None:
        _board[k] = share
        if _board[-1]:
            raise SystemExit

    result = _attempted(job, report)
    _board[k] = 1.0
    return result
