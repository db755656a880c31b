"""The one tree of errors.

::

    MeshonetError                 exit 2 unless said otherwise
    ├── InputError                bad file, bad geometry, bad option value      exit 2
    ├── NoValidGridError          every way to a grid ended in folded cells     exit 3
    ├── SolverError               an iteration diverged and its retries too     exit 3
    └── GateError                 a quality gate the user asked for was not met exit 1
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


class MeshonetError(Exception):
    """Root of every error a user can cause or must hear of."""

    exit_code = 2


class InputError(MeshonetError):
    """Input that cannot be used, said as: place: what is wrong; what to do.

    Parameters
    ----------
    problem : what is wrong, with the offending value.
    remedy : what the user can do about it.
    source : file or option the problem is in; a caller that knows it better may set it later.
    place : where in the source, e.g. ``line 12`` or ``dataset 'south'``.

    Examples
    --------
    >>> print(InputError("'abc' is not a number", "remove the line", source="a.dat", place="line 12"))
    a.dat: line 12: 'abc' is not a number; remove the line
    """

    def __init__(self, problem: str, remedy: str = "", *, source: str = "", place: str = "") -> None:
        super().__init__(problem)
        self.problem, self.remedy, self.source, self.place = problem, remedy, source, place

    def __str__(self) -> str:
        told = ": ".join(part for part in (self.source, self.place, self.problem) if part)
        return f"{told}; {self.remedy}" if self.remedy else told


@dataclass(frozen=True)
class BadCell:
    """A folded cell: indices of its lower-left node and the physical position of its centre."""

    i: int
    j: int
    x: float
    y: float


class NoValidGridError(MeshonetError):
    """Every way tried ended in folded cells.

    Parameters
    ----------
    problem : what was tried and the count of folded cells left.
    worst : the worst cells, ten at the most.
    """

    exit_code = 3

    def __init__(self, problem: str, worst: Sequence[BadCell] = ()) -> None:
        super().__init__(problem)
        self.problem, self.worst = problem, tuple(worst)

    def __str__(self) -> str:
        cells = ", ".join(f"(i={c.i}, j={c.j}, x={c.x:.6g}, y={c.y:.6g})" for c in self.worst[:10])
        return f"{self.problem}; worst cells: {cells}" if cells else self.problem


class SolverError(MeshonetError):
    """An iteration diverged or stalled, and its retries too."""

    exit_code = 3


class GateError(MeshonetError):
    """A quality gate asked for with ``--fail-on`` was not met."""

    exit_code = 1
