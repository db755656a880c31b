"""The exceptions of meshonet, in one tree.

::

    MeshonetError                 exit code 2 unless stated otherwise
    ├── InputError                bad file, bad geometry, bad option value             exit code 2
    ├── NoValidGridError          every method ended in folded cells                   exit code 3
    └── SolverError               an iteration diverged, and so did its retries        exit code 3
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from meshonet.geometry.quality.bad_cell import BadCell


class MeshonetError(Exception):
    """Base class of all errors with a message for the user."""

    exit_code = 2


class InputError(MeshonetError):
    """Error: an input cannot be used. The message has the form ``place: problem; remedy``.

    In `problem` and `remedy`, names of parameters are in braces: ``{far_field}`` becomes ``far_field`` in
    Python, ``--far-field`` on the command line.

    Parameters
    ----------
    problem : str
        What is wrong, with the offending value.
    remedy : str, optional
        What the user can do.
    source : str, optional
        Name of the file; a caller may set it later.
    place : str, optional
        A place in the source, such as ``line 12``.
    parameter : str, optional
        Python name of the parameter that causes the error.

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
        """Return the message, with the function `spelling` applied to the names of parameters in braces."""
        parameter = spelling(self.parameter) if self.parameter else ""
        parts = (self.source, parameter, self.place, spelled(self.problem, spelling))
        text = ": ".join(part for part in parts if part)
        return f"{text}; {spelled(self.remedy, spelling)}" if self.remedy else text


def place_of(point: Iterable[float]) -> str:
    """Return the position of a point (3,) as text, such as ``x=0.1, y=0.2, z=0.3``."""
    return ", ".join(f"{name}={value:.6g}" for name, value in zip("xyz", point, strict=True))


def meant(word: str, known: Iterable[str], likeness: float = 0.6) -> str:
    """Return ``did you mean ...?`` with the word of `known` that is most similar to `word`, or ''.

    Their similarity, from 0 to 1, must be at least `likeness`, unless `word` begins with the known word.

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
    """Within the ``with`` block, input errors without a source get the source `name`."""
    try:
        yield
    except InputError as error:
        error.source = error.source or name
        raise


@contextmanager
def in_place(place: str) -> Iterator[None]:
    """Within the ``with`` block, input errors without a place get this `place`."""
    try:
        yield
    except InputError as error:
        error.place = error.place or place
        raise


def spelled(text: str, spelling: Callable[[str], str] = str) -> str:
    """Return `text` with the function `spelling` applied to names in braces; double braces become single.

    >>> spelled("give {far_field} as 'a-{{index}}'", lambda name: "--" + name.replace("_", "-"))
    "give --far-field as 'a-{index}'"
    """
    name = r"[a-z][a-z0-9_]*"
    return re.sub(
        rf"\{{(\{{{name}(?::[^{{}}]*)?\}})\}}|\{{({name})\}}",
        lambda match: match[1] or spelling(match[2]),
        text,
    )


_SHOWN = 3  # of the worst cells in a message


class NoValidGridError(MeshonetError):
    """Error: the grids of all methods that were tried have folded cells.

    Parameters
    ----------
    problem : str
        The methods that were tried, and the number of folded cells.
    worst : sequence of BadCell, optional
        The worst cells; the message shows three of them.
    """

    exit_code = 3

    def __init__(self, problem: str, worst: Sequence[BadCell] = ()) -> None:
        super().__init__(problem)
        self.problem, self.worst = problem, tuple(worst)

    def __str__(self) -> str:
        return self.text(str)

    def text(self, spelling: Callable[[str], str]) -> str:
        """Return the message, with the function `spelling` applied to the names of parameters in braces."""
        cells = ", ".join(f"({cell})" for cell in self.worst[:_SHOWN])
        problem = spelled(self.problem, spelling)
        return f"{problem}; worst cells: {cells}" if cells else problem


class SolverError(MeshonetError):
    """Error: an iteration diverges or stalls, even when it is repeated with other settings."""

    exit_code = 3
