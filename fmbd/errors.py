"""The exceptions that a user of fmbd meets."""

from collections.abc import Iterable


class ModelError(Exception):
    """A model that cannot be used as it is written.

    `problems` holds one line for each thing that is wrong, `file:line:column: where: what`.
    """

    def __init__(self, problems: Iterable[str]) -> None:
        self.problems = list(problems)
        super().__init__("\n".join(self.problems))

    def __reduce__(self) -> tuple[type["ModelError"], tuple[list[str]]]:
        return ModelError, (self.problems,)


class UnknownQuantity(KeyError):
    """A name that nothing has: no quantity of a run, no motor, no input; the message is one line."""

    def __str__(self) -> str:
        return str(self.args[0])


class AnalysisError(Exception):
    """An analysis that has no answer; the message says why and where, in one line."""
