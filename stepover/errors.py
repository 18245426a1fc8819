"""What can go wrong, as types: every error that stepover raises on purpose derives from StepOverError."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable


class Advice(Protocol):
    """What can be done instead: an obstacle that can be crossed."""

    def as_advice(self) -> str:
        """In a few words, for the end of a message."""


LONGEST = 1000
"""Letters of a message at most: what a broken file holds may be quoted in it."""


class StepOverError(Exception):
    """Base of all errors of this library. Its message is one line of a readable length."""

    def __init__(self, message: str = "") -> None:
        """Put the message on one line, and leave out the middle of a very long one."""
        line = " ".join(message.splitlines())
        super().__init__(line if len(line) <= LONGEST else f"{line[: LONGEST - 300]} ... {line[-290:]}")


class InvalidInput(StepOverError, ValueError):
    """An argument, a file or an option that makes no sense; the message says what would."""


def require_type(name: str, value: object, kind: type, source: str) -> None:
    """Refuse an argument of another type than the one that `source` gives.

    Raises:
        InvalidInput: names the argument, both types, and where one gets the right one.
    """
    if not isinstance(value, kind):
        raise InvalidInput(f"{name} must be of type {kind.__name__}, not {type(value).__name__}: give {source}")


class CorruptMotion(StepOverError):
    """A motion file that cannot be read, is cut short or contradicts itself."""


class Infeasible(StepOverError):
    """A well-formed request that the robot cannot carry out.

    Attributes:
        constraint: what cannot be met, by how much, and when.
        nearest: the nearest obstacle that can be stepped over, where one was looked for.
        short: what is missing, where that is a length [m]; infinity where it is not.
        walking: whether it happens as the robot walks, before or after the obstacle, so that no other one helps.
    """

    def __init__(
        self,
        constraint: str,
        nearest: Advice | None = None,
        short: float = float("inf"),
        walking: bool = False,
    ) -> None:
        """Keep the binding constraint and, once known, the nearest crossable obstacle."""
        self.constraint = constraint
        self.nearest = nearest
        self.short = short
        self.walking = walking
        super().__init__(constraint)

    def __str__(self) -> str:
        """One line: the constraint, then what can be crossed instead."""
        return self.constraint if self.nearest is None else f"{self.constraint}; {self.nearest.as_advice()}"

    def forget_frames(self) -> None:
        """Drop traceback, cause and context: their frames keep the arrays of a failed attempt in memory."""
        self.__traceback__ = self.__cause__ = self.__context__ = None


class OutOfReach(Infeasible):
    """A sole that a leg cannot reach, by `short`."""


class LimitBroken(Infeasible):
    """A finished motion that breaks a limit.

    Attributes:
        limit: which one: what is checked, and of which part.
        excess: by how much it is broken, in the limit's unit.
    """

    def __init__(self, constraint: str, limit: str, excess: float, short: float, walking: bool) -> None:
        """Keep what a planner needs to tell whether it gets better or worse."""
        super().__init__(constraint, short=short, walking=walking)
        self.limit, self.excess = limit, excess

    def __reduce__(self) -> tuple[type[Infeasible], tuple[str, Advice | None, float, bool]]:
        """Pickle what a user sees."""
        return Infeasible, (self.constraint, self.nearest, self.short, self.walking)


class TrailingLegBlocked(Infeasible):
    """FTA cannot free the trailing leg: the remaining penetration exceeds what its method (3) can correct.

    The exact depth takes time to compute, so it is computed when somebody asks for it.
    """

    def __init__(self, short: float, explain: Callable[[], Infeasible]) -> None:
        """Keep a lower bound of the penetration [m], and the function that computes what exactly remains."""
        self.explain = cache(explain)
        super().__init__("FTA cannot free the trailing leg", short=short)

    def __str__(self) -> str:
        """What remains: the link, the depth and when."""
        return str(self.explain())

    def __reduce__(self) -> tuple[type[Infeasible], tuple[str, Advice | None, float]]:
        """Pickle the finished message: another process has no trajectories to compute it from."""
        return Infeasible, (str(self), self.nearest, self.short)
