"""Boundaries drawn from a family, for `sample-boundary --family`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from formats.hdf5 import Writer
from formats.registry import format_for_output
from geometry.boundary import Boundary
from geometry.errors import InputError
from geometry.families.family import FAMILIES, Family, family
from geometry.sampling import Sampling
from meshonet_cli.batch import Destination
from meshonet_cli.member import Item
from meshonet_cli.session import Session

NODES = 101
"""Nodes along xi and eta when nobody says, as in the paper."""

PROCEDURAL = "procedural"


@dataclass(frozen=True, eq=False)
class FamilyBoundary(Boundary):
    """A boundary that knows the parameter it was made with."""

    parameter: float = float("nan")


@dataclass(frozen=True)
class Draw:
    """One member of a family, not made yet.

    Parameters
    ----------
    family : one of the paper's six, or None for random airfoils.
    low, high : range of the parameter.
    seed, index : make the random numbers of this member, whichever others are drawn.
    """

    family: Family | None
    low: float
    high: float
    seed: int
    index: int

    @property
    def name(self) -> str:
        """Family and number."""
        return f"{self.family.name if self.family else PROCEDURAL}-{self.index}"

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the boundary with the node counts of `sampling`."""
        rng = np.random.default_rng([self.seed, self.index])
        ni, nj = sampling.ni or NODES, sampling.nj or NODES
        if self.family is None:
            from geometry.families.procedural import boundary

            return boundary(rng, ni, nj)
        parameter = self.low + (self.high - self.low) * float(rng.random())
        made = self.family.boundary(parameter, ni, nj)
        given: dict[str, Any] = {field.name: getattr(made, field.name) for field in fields(made)}
        return FamilyBoundary(**given, parameter=parameter)


def draws(name: str, count: int, spread: str | None, seed: int, session: Session) -> Iterator[Item[Draw]]:
    """Yield `count` members of the family `name`.

    Parameters
    ----------
    spread : ``A:B``, the range of the parameter, or None for that of the family.
    seed : of all random numbers.

    Raises
    ------
    InputError
        no such family, a range that is none or leaves the family's, fewer than one member.
    """
    if name not in (*FAMILIES, PROCEDURAL):
        known = "use one of " + ", ".join((*FAMILIES, PROCEDURAL))
        raise InputError(f"family {name!r} is not known", known, source="--family")
    kind = None if name == PROCEDURAL else family(name)
    low, high = _range(spread, kind)
    session.batch = count > 1

    def members() -> Iterator[Item[Draw]]:
        for index in range(count):
            session.begin(name, count if count > 1 else None)
            yield Item(index, name, Draw(kind, low, high, seed, index), 0.0, count == 1)

    return members()


def family_file(output: str, to_format: str | None, name: str) -> Destination:
    """Return the destination of a family's boundaries, with their parameters where the format holds them."""
    found = format_for_output(output, to_format, "boundaries")
    if found.name != "hdf5" or name == PROCEDURAL:
        return Destination(output, to_format, "boundaries")
    return Destination(output, to_format, "boundaries", put=_write)


def _write(path: Path, boundaries: Iterable[FamilyBoundary]) -> None:
    with Writer(path, "meshonet-boundary", ["parameter"]) as writer:
        for boundary in boundaries:
            writer.append(boundary, parameters=np.array([boundary.parameter]))


def _range(text: str | None, kind: Family | None) -> tuple[float, float]:
    if kind is None:
        if text is not None:
            raise InputError("random airfoils have no parameter", "leave it out", source="--range")
        return 0.0, 1.0
    if text is None:
        return kind.low, kind.high
    found = re.fullmatch(r"\s*([-+.\w]+)\s*:\s*([-+.\w]+)\s*", text)
    try:
        low, high = (float(word) for word in found.groups()) if found else (1.0, 0.0)
    except ValueError:
        low, high = 1.0, 0.0
    if not low <= high:
        raise InputError(f"{text!r} is not a range", "use A:B with A <= B, e.g. 0.1:0.3", source="--range")
    if not kind.least <= low <= high <= kind.most:
        bounds = f"{kind.least:g}:{kind.most:g}"
        raise InputError(f"{text} leaves what {kind.parameter} can be", f"stay in {bounds}", source="--range")
    return low, high
