"""Sections stacked along z, and the interpolation between them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, TypeAlias, get_args

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.section import Fade, Section, placed

Kind: TypeAlias = Literal["wing", "blade", "duct"]
Tip: TypeAlias = Literal["round", "flat", "open"]
Between: TypeAlias = Literal["linear", "smooth"]
KINDS: tuple[Kind, ...] = get_args(Kind)
TIPS: tuple[Tip, ...] = get_args(Tip)
BETWEEN: tuple[Between, ...] = get_args(Between)


@dataclass(frozen=True, eq=False)
class Stack:
    """A wing, blade or duct: at least two sections with increasing z.

    Parameters
    ----------
    sections : tuple of Section
        Sections in the order of z; the first one is the root of a wing.
    kind : {'wing', 'blade', 'duct'}, optional
        A ``wing`` ends with a tip at the last section, a ``blade`` stands between two walls, and a ``duct``
        has internal flow.
    tip : {'round', 'flat', 'open'}, optional
        Shape of the tip of a wing; ``open``: the tip is not closed.
    between : {'linear', 'smooth'}, optional
        Interpolation between sections: ``linear``, or ``smooth`` by cubics in z that do not overshoot.
    tip_spacing : float, optional
        Length of the last cells along the span of a wing, in chords of the last section.
    le_spacing, te_spacing : float, optional
        Length of the cells at leading and trailing edges, in chords of each section.
    name : str, optional
        Name of the stack in the input.

    Raises
    ------
    InputError
        Fewer than two sections; z that does not increase; a length that is not positive or does not apply to
        this kind.
    """

    sections: tuple[Section, ...]
    kind: Kind = "wing"
    tip: Tip = "round"
    between: Between = "linear"
    tip_spacing: float | None = None
    le_spacing: float | None = None
    te_spacing: float | None = None
    name: str = ""

    def __post_init__(self) -> None:
        if len(self.sections) < 2:
            raise InputError(f"{len(self.sections)} sections", "give at least two", place="sections")
        for value, known, key in (
            (self.kind, KINDS, "kind"), (self.tip, TIPS, "tip"), (self.between, BETWEEN, "between"),
        ):  # fmt: skip
            if value not in known:
                raise InputError(f"{key} {value!r} is not known", "use " + "/".join(known), place=key)
        for key in ("tip_spacing", "le_spacing", "te_spacing"):
            value = getattr(self, key)
            if value is not None and not 0.0 < value < 1.0:
                raise InputError(f"{value:g} chords", "use more than 0 and less than 1", place=key)
            if value is not None and (self.kind == "duct" or (key == "tip_spacing" and self.kind != "wing")):
                raise InputError(f"a {self.kind} has no such edge", "leave it out", place=key)
        for k, (before, after) in enumerate(pairwise(self.sections)):
            if not after.z > before.z:
                problem = f"z is {after.z:g} behind {before.z:g}"
                raise InputError(problem, "give sections in order of z", place=f"sections[{k + 1}].z")

    def with_tip(self, tip: Tip | None) -> Stack:
        """Return the same stack with another tip; None keeps its own.

        Raises InputError: the stack is no wing, or the tip is unknown.
        """
        if tip is None:
            return self
        if self.kind != "wing":
            raise InputError(f"a {self.kind} has no tip", "leave {tip} out", parameter="tip")
        return replace(self, tip=tip)

    @property
    def z(self) -> Floats:
        """(n,) z of the sections."""
        return np.array([section.z for section in self.sections])

    @property
    def chords(self) -> Floats:
        """(n,) chords of the sections."""
        return np.array([section.chord for section in self.sections])

    @property
    def chord(self) -> float:
        """The greatest chord."""
        return float(self.chords.max())

    @property
    def end(self) -> tuple[float, float, float]:
        """Position of the last section: x and y of its leading edge before the twist, and z."""
        last = self.sections[-1]
        return last.x, last.y, last.z

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on changes of the points of the sections, and on lines of their files that were left out."""
        return tuple(dict.fromkeys(note for section in self.sections for note in section.shape.notes))

    def lofted(self, unit: Floats, z: Floats, weight: Floats | None = None) -> Floats:
        """Return nodes (m, n, 3) of the sections at the heights `z` (m,).

        `unit` (sections, n, 2) are the nodes of the given sections, scaled to unit chord. Shape, chord, twist
        and position are interpolated separately, so that a section between two sections of different twist
        keeps its length. Nodes with `weight` (n,) 0 are not twisted, and scaled by the longest chord.
        """
        fade = None if weight is None else Fade(weight, self.chord)
        placements = np.stack([section.placement for section in self.sections])
        planes = placed(self.between_sections(unit, z), self.between_sections(placements, z), fade)
        heights = np.broadcast_to(z[:, None, None], (*planes.shape[:2], 1))
        return np.concatenate([planes, heights], axis=-1)

    def between_sections(self, values: Floats, z: Floats) -> Floats:
        """Return `values` (sections, ...) interpolated at the heights `z` (m,)."""
        straight = self.between == "linear" or len(self.sections) == 2
        return monotone_cubic(self.z, values, z, linear=straight)
