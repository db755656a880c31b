"""Sections stacked along z, and the interpolation between them."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal, Self, TypeAlias, get_args

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.elementary import arctan2
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Change
from meshonet.geometry.sections.section import Fade, Section, placed, turned

Kind: TypeAlias = Literal["wing", "blade", "duct"]
Tip: TypeAlias = Literal["round", "flat", "open"]
Between: TypeAlias = Literal["linear", "smooth"]
KINDS: tuple[Kind, ...] = get_args(Kind)
TIPS: tuple[Tip, ...] = get_args(Tip)
BETWEEN: tuple[Between, ...] = get_args(Between)
STEEP = 20.0
"""Angle in degrees between a panel and its sections' normals above which a note gives the thickness."""


@dataclass(frozen=True, eq=False)
class Stack:
    """A wing, blade or duct: at least two sections with increasing z.

    Parameters
    ----------
    sections : tuple of Section
        Sections in the order of z; the first one is the root of a wing.
    kind : {'wing', 'blade', 'duct'}, optional
        A wing ends with a tip, a blade stands between two walls, and a duct has internal flow.
    tip : {'round', 'flat', 'open'}, optional
        Shape of the tip of a wing; ``open`` leaves it open.
    between : {'linear', 'smooth'}, optional
        Interpolation between sections: linear, or by cubics in z without overshoot.
    tip_spacing : float, optional
        Length of the last cells along the span of a wing, in chords of the last section.
    le_spacing, te_spacing : float, optional
        Length of the cells at leading and trailing edges, in chords of each section.
    name : str, optional
        Name of the stack in the input.

    Raises
    ------
    InputError
        Fewer than two sections; z that does not increase; lengths that are not positive or do not apply.
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
        if self.sections[0].nodes is not None:
            problem, place = "there is no panel before the first section", "sections[0].nodes"
            raise InputError(problem, "leave nodes out", place=place)
        self._check_cants()

    def _check_cants(self) -> None:
        """Raise InputError for a canted section in a wall or in a plane of symmetry."""
        flat = {0, len(self.sections) - 1} if self.tip == "open" else {0}
        for k, section in enumerate(self.sections):
            place = f"sections[{k}].cant"
            if self.kind != "wing" and section.cant != 0.0:
                problem = f"the sections of a {self.kind} are in planes of constant z"
                raise InputError(problem, "leave cant out", place=place)
            if k in flat and section.cant not in (0.0, "panel"):
                problem = f"{section.cant:g} degrees, and the section lies in a plane of symmetry"
                raise InputError(problem, "leave it out", place=place)

    @property
    def panel_cells(self) -> tuple[int | None, ...]:
        """Number of cells along the span of each panel (the part between two sections), None if not given."""
        return tuple(None if each.nodes is None else each.nodes - 1 for each in self.sections[1:])

    @property
    def span(self) -> int | None:
        """Number of nodes along the span; None if a section after the first has no `nodes`."""
        cells = [each for each in self.panel_cells if each is not None]
        return sum(cells) + 1 if len(cells) == len(self.panel_cells) else None

    def with_tip(self, tip: Tip | None) -> Self:
        """Return the stack with another tip; None keeps the tip as it is.

        Raises InputError: the stack is no wing, or the tip is unknown.
        """
        if tip is None:
            return self
        if self.kind != "wing":
            raise InputError(f"a {self.kind} has no tip", "leave {tip} out", parameter="tip")
        return replace(self, tip=tip)

    @property
    def z(self) -> Floats:
        """Values (n,) of z of the sections."""
        return np.array([section.z for section in self.sections])

    @property
    def chords(self) -> Floats:
        """Chords (n,) of the sections."""
        return np.array([section.chord for section in self.sections])

    @property
    def chord(self) -> float:
        """Longest chord of the sections."""
        return float(self.chords.max())

    @property
    def end(self) -> tuple[float, float, float]:
        """Leading edge, before the twist, of the last section."""
        last = self.sections[-1]
        return last.x, last.y, last.z

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the points and files of the sections, and the note `steep` if it is not empty."""
        notes = [note for section in self.sections for note in section.shape.notes]
        return tuple(dict.fromkeys([*notes, *filter(None, [self.steep])]))

    @property
    def dihedrals(self) -> Floats:
        """Dihedral angles (n - 1,) in radians of the panels between neighbouring sections."""
        return arctan2(np.diff([section.y for section in self.sections]), np.diff(self.z))

    @property
    def cants(self) -> Floats:
        """Angles (n,) in radians by which the sections are rotated about x.

        With ``cant="panel"``, the angle is the mean dihedral of the wing on both sides of the section, and 0
        in a plane of symmetry.
        """
        panels = self.dihedrals
        own = np.concatenate([[0.0], 0.5 * (panels[1:] + panels[:-1]), panels[-1:]])
        if self.tip == "open":
            own[-1] = 0.0
        angles = [0.0 if section.cant == "panel" else math.radians(section.cant) for section in self.sections]
        return np.where([section.cant == "panel" for section in self.sections], own, angles)

    @property
    def steep(self) -> str:
        """Note on a wing whose span is more than 20 degrees off the normals of its sections; else empty."""
        if self.kind != "wing":
            return ""
        inclined = np.abs(self.dihedrals - np.stack([self.cants[:-1], self.cants[1:]])).min(axis=0)
        worst = int(inclined.argmax())
        if inclined[worst] <= math.radians(STEEP):
            return ""
        low, high = self.z[worst : worst + 2]
        part, off = 100.0 * math.cos(inclined[worst]), math.degrees(inclined[worst])
        return Change(
            f"between z={low:g} and {high:g} the wing is {part:.0f} % as thick as its sections, because "
            f'their planes are {off:.0f} degrees off the normal of the panel; cant = "panel" turns them'
        )

    def lofted(self, unit: Floats, z: Floats, weight: Floats | None = None) -> Floats:
        """Return nodes (m, n, 3) of interpolated sections, with leading edges at `z` (m,) along the span.

        `unit` (sections, n, 2) are nodes of the given sections at unit chord. Shape, chord, twist and
        position are interpolated separately. Nodes whose `weight` (n,) is 1 have the twist and chord of the
        section. Nodes with weight 0 are not twisted, and are scaled by the longest chord.
        """
        fade = None if weight is None else Fade(weight, self.chord)
        placements = np.stack([section.placement for section in self.sections])
        planes = placed(self.between_sections(unit, z), self.between_sections(placements, z), fade)
        heights = np.broadcast_to(z[:, None, None], (*planes.shape[:2], 1))
        nodes = np.concatenate([planes, heights], axis=-1)
        return self.canted(nodes, z) if self.cants.any() else nodes

    def canted(self, nodes: Floats, z: Floats) -> Floats:
        """Return `nodes` (m, ..., 3) of sections at `z` (m,), tilted by cant angles (see `Section`) there."""
        values = np.stack([np.array([section.y for section in self.sections]), self.cants], axis=1)
        y, cant = self.between_sections(values, z).reshape(len(z), *[1] * (nodes.ndim - 2), 2).T
        place = np.stack([y.T, z.reshape(y.T.shape)], axis=-1)
        return turned(nodes, place, cant.T)

    def between_sections(self, values: Floats, z: Floats) -> Floats:
        """Return `values` (sections, ...) interpolated to positions `z` (m,)."""
        straight = self.between == "linear" or len(self.sections) == 2
        return monotone_cubic(self.z, values, z, linear=straight)
