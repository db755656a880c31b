"""Boundaries drawn at random from a family."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from typing import overload

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Origin
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.family import FAMILIES, Family, family
from meshonet.geometry.families.split import split
from meshonet.geometry.spacing.sampling import Sampling

NODES = 101  # default number of nodes along xi and eta, as in the paper
RANDOM = {"procedural": "procedural", "four-sided": "four_sided", "bodies": "bodies"}
"""Modules in `meshonet.geometry.families` of shapes that have no parameter, by the family's name."""


@dataclass(frozen=True)
class Draw:
    """One member of a family of shapes; `seed` and `index` determine all its random numbers."""

    kind: str
    family: Family | None  # one of the paper's six, or None for random shapes
    low: float
    high: float
    seed: int
    index: int
    split: str = ""

    @property
    def name(self) -> str:
        """Name of the family and index of the member."""
        return f"{self.kind}-{self.index}"

    @property
    def parameter(self) -> float:
        """Value of the shape parameter of this member."""
        rng = np.random.default_rng([self.seed, self.index])
        return self.low + (self.high - self.low) * float(rng.random())

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return the boundary. Raises InputError: `sampling` has settings other than node counts."""
        ni, nj = sampling.ni or NODES, sampling.nj or NODES
        if self.family is None:
            module = import_module(f"meshonet.geometry.families.{RANDOM[self.kind]}")
            drawn: Boundary = module.boundary(np.random.default_rng([self.seed, self.index]), ni, nj)
        else:
            origin = Origin((("parameter", self.parameter),), self.split)
            drawn = replace(self.family.boundary(self.parameter, ni, nj), origin=origin)
        return replace(drawn, name=self.name).boundary(replace(sampling, ni=None, nj=None))


@dataclass(frozen=True)
class Draws(Sequence[Draw]):
    """A sequence of `length` members of a family, for training or test; members are made when used."""

    first: Draw
    length: int
    splits: Sequence[str] = ()

    def __len__(self) -> int:
        return self.length

    @overload
    def __getitem__(self, index: int) -> Draw: ...
    @overload
    def __getitem__(self, index: slice) -> list[Draw]: ...
    def __getitem__(self, index: int | slice) -> Draw | list[Draw]:
        if isinstance(index, slice):
            return [self[k] for k in range(self.length)[index]]
        number = range(self.length)[index]
        return replace(self.first, index=number, split=self.splits[number] if self.splits else "")


def draws(
    name: str, count: int = 1, spread: str | None = None, seed: int = 0, way: str | None = None
) -> Draws:
    """Return `count` members of the family `name`; each boundary is generated at its first use.

    `spread` is the range ``A:B`` of the parameter; if None, it is the default range of the family. `way` is
    how members are split into training and test (see `split`); if None, they are not. Raises InputError: an
    unknown family; a range that is invalid or beyond the limits of the family; members that cannot be split.
    """
    if name not in (*FAMILIES, *RANDOM):
        known = "use one of " + ", ".join((*FAMILIES, *RANDOM))
        raise InputError(f"family {name!r} is not known", known, parameter="family")
    kind = None if name in RANDOM else family(name)
    low, high = _range(spread, kind)
    members = Draws(Draw(name, kind, low, high, seed, 0), count)
    return replace(members, splits=_kept(members, kind, way, seed))


def _kept(every: Sequence[Draw], kind: Family | None, way: str | None, seed: int) -> Sequence[str]:
    if way is None:
        return ()
    if kind is None:
        raise InputError("random shapes have no parameter to split by", "leave it out", parameter="split")
    try:
        return split([draw.parameter for draw in every], way, seed=seed, low=kind.to_low)
    except InputError as error:
        error.parameter = "split"
        raise


def _range(text: str | None, kind: Family | None) -> tuple[float, float]:
    if kind is None:
        if text is not None:
            raise InputError("random shapes have no parameter", "leave it out", parameter="range")
        return 0.0, 1.0
    if text is None:
        return kind.low, kind.high
    match = re.fullmatch(r"\s*([-+.\w]+)\s*:\s*([-+.\w]+)\s*", text)
    try:
        low, high = (float(word) for word in match.groups()) if match else (1.0, 0.0)
    except ValueError:
        low, high = 1.0, 0.0
    if not low <= high:
        raise InputError(f"{text!r} is not a range", "use A:B with A <= B, e.g. 0.1:0.3", parameter="range")
    if not kind.least <= low <= high <= kind.most:
        bounds = f"{kind.least:g}:{kind.most:g}"
        problem = f"{text} leaves what {kind.parameter} can be"
        raise InputError(problem, f"stay in {bounds}", parameter="range")
    return low, high
