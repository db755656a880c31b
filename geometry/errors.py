"""The one tree of errors.

::

    MeshonetError                 exit 2 unless said otherwise
    ├── InputError                bad file, bad geometry, bad option value      exit 2
    ├── NoValidGridError          every way to a grid ended in folded cells     exit 3
    └── SolverError               an iteration diverged and its retries too     exit 3
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass


class MeshonetError(Exception):
    """Root of every error a user can cause or must hear of."""

    exit_code = 2


class InputError(MeshonetError):
    """Input that cannot be used; its message reads ``place: problem; remedy``.

    Problem and remedy refer to parameters in braces, ``{far_field}``: in Python these read ``far_field``, on
    the command line ``--far-field`` (`spelled`).

    Parameters
    ----------
    problem : str
        What is wrong, with the offending value.
    remedy : str, optional
        What the user can do.
    source : str, optional
        A file, which a caller may set later.
    place : str, optional
        A place in it, ``line 12``.
    parameter : str, optional
        Python name of the parameter concerned.

    Examples
    --------
    >>> print(InputError("'abc' is not a number", "remove the line", source="a.dat", place="line 12"))
    a.dat: line 12: 'abc' is not a number; remove the line
    """

    def __init__(
        self, problem: str, remedy: str = "", *, source: str = "", place: str = "", parameter: str = ""
    ) -> None:
        super().__init__(problem)
        self.problem, self.remedy, self.source, self.place = problem, remedy, source, place
        self.parameter = parameter

    def __str__(self) -> str:
        return self.text(str)

    def text(self, spelling: Callable[[str], str]) -> str:
        """Return the message, the names of parameters passed through `spelling`."""
        parameter = spelling(self.parameter) if self.parameter else ""
        parts = (self.source, parameter, self.place, spelled(self.problem, spelling))
        text = ": ".join(part for part in parts if part)
        return f"{text}; {spelled(self.remedy, spelling)}" if self.remedy else text


def meant(word: str, known: Iterable[str], likeness: float = 0.6) -> str:
    """Return ``did you mean ...?`` with the most similar word of `known`, or an empty text.

    `likeness` is the part of their letters that is alike at the least, unless the word begins with one.

    >>> meant("max_angel", ["max_angle", "min_angle"])
    "did you mean 'max_angle'? "
    >>> meant("beauty", ["max_angle", "min_angle"])
    ''
    """
    from difflib import get_close_matches

    names = list(known)
    near = get_close_matches(word, names, n=1, cutoff=likeness)
    near = near or sorted((name for name in names if len(name) > 2 and word.startswith(name)), key=len)
    return f"did you mean {near[-1]!r}? " if near else ""


@contextmanager
def in_source(name: str) -> Iterator[None]:
    """Name the source in the input errors of a block that do not name one."""
    try:
        yield
    except InputError as error:
        error.source = error.source or name
        raise


@contextmanager
def in_place(place: str) -> Iterator[None]:
    """Name the place in the input errors of a block that do not name one."""
    try:
        yield
    except InputError as error:
        error.place = error.place or place
        raise


def spelled(text: str, spelling: Callable[[str], str] = str) -> str:
    """Return `text`, its names of parameters in braces passed through `spelling`; double braces stay single.

    >>> spelled("give {far_field} as 'a-{{index}}'", lambda name: "--" + name.replace("_", "-"))
    "give --far-field as 'a-{index}'"
    """
    name = r"[a-z][a-z0-9_]*"
    return re.sub(rf"\{{(\{{{name}\}})\}}|\{{({name})\}}", lambda match: match[1] or spelling(match[2]), text)


@dataclass(frozen=True)
class BadCell:
    """A folded cell: the indices of its lower-left node and its centre; of many blocks, which of them.

    k is None on a surface and in the plane, z in the plane.
    """

    i: int
    j: int
    x: float
    y: float
    block: int | None = None
    k: int | None = None
    z: float | None = None

    @property
    def indices(self) -> str:
        """``block=2, i=3, j=4, k=5``, what there is of them."""
        places = {"block": self.block, "i": self.i, "j": self.j, "k": self.k}
        return ", ".join(f"{name}={value}" for name, value in places.items() if value is not None)

    @property
    def centre(self) -> str:
        """``x=0.1, y=0.2, z=0.3``, what there is of them."""
        places = {"x": self.x, "y": self.y, "z": self.z}
        return ", ".join(f"{name}={value:.6g}" for name, value in places.items() if value is not None)

    def __str__(self) -> str:
        return f"{self.indices}, {self.centre}"


class NoValidGridError(MeshonetError):
    """Every way tried ended in folded cells.

    Parameters
    ----------
    problem : str
        What was tried, and how many cells are folded.
    worst : sequence of BadCell, optional
        The worst of them.
    """

    exit_code = 3

    def __init__(self, problem: str, worst: Sequence[BadCell] = ()) -> None:
        super().__init__(problem)
        self.problem, self.worst = problem, tuple(worst)

    def __str__(self) -> str:
        return self.text(str)

    def text(self, spelling: Callable[[str], str]) -> str:
        """Return the message, the names of parameters in braces passed through `spelling`."""
        cells = ", ".join(f"({cell})" for cell in self.worst[:10])
        problem = spelled(self.problem, spelling)
        return f"{problem}; worst cells: {cells}" if cells else problem


class SolverError(MeshonetError):
    """An iteration diverged or stalled, and its retries too."""

    exit_code = 3
