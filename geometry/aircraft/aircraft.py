"""A body with a wing: what the grid of an aircraft is made from."""

from __future__ import annotations

from dataclasses import dataclass

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

PATCHES = "wing", "tip", "symmetry", "farfield"
"""Patches of a grid beside that of the body."""

_TAPER = 0.02
"""Least chord over the longest one: around a wing that ends in a point there are no cells of equal counts."""


@dataclass(frozen=True, eq=False)
class Aircraft:
    """A body of revolution and a wing that begins inside of it: the half z >= 0, or both halves.

    Parameters
    ----------
    body : Body
        The fuselage.
    wing : Stack
        Sections from the inside of the body to the tip.
    name : str, optional
        Of the aircraft.
    half : bool, optional
        Whether the grid ends in the plane of symmetry; otherwise it is joined there to its mirror image,
        whose patches have the same names.

    Raises
    ------
    InputError
        A stack that is no wing, has outlines in place of airfoils, or nearly ends in a point; a body with the
        name of another patch.

    Examples
    --------
    >>> import meshonet
    >>> root = meshonet.Section(meshonet.read("naca:2415"), chord=2.0, z=0.0, x=3.5)
    >>> tip = meshonet.Section(meshonet.read("naca:2412"), chord=1.0, z=5.0, x=5.0)
    >>> body = meshonet.Body([[0, 0], [0.1, 0.3], [0.5, 0.55], [2, 0.6], [6, 0.6], [9, 0.2], [10, 0]])
    >>> jet = meshonet.Aircraft(body, meshonet.Stack((root, tip)))
    >>> grid = meshonet.stack(jet, around=49, span=9, first_cell=0.01, growth=1.4, far_field=6)
    >>> sorted({patch.name for patch in grid.patches})
    ['farfield', 'fuselage', 'symmetry', 'tip', 'wing']
    """

    body: Body
    wing: Stack
    name: str = "aircraft"
    half: bool = True

    def __post_init__(self) -> None:
        if self.wing.kind != "wing":
            raise InputError(f"a {self.wing.kind} is no wing", "leave it out", place="wings[0].kind")
        if self.wing.tip == "open":
            raise InputError("a wing of an aircraft has a tip", "make it round or flat", place="wings[0].tip")
        for number, section in enumerate(self.wing.sections):
            if not isinstance(section.shape, Airfoil):
                problem = "a closed curve has no trailing edge"
                at = f"wings[0].sections[{number}].outline"
                raise InputError(problem, "give an airfoil", place=at)
        chords = [section.chord for section in self.wing.sections]
        if min(chords) < _TAPER * max(chords):
            at = f"wings[0].sections[{chords.index(min(chords))}].chord"
            remedy = f"use at least {_TAPER:g} of the longest, {max(chords):g}"
            raise InputError(f"a chord of {min(chords):g}", remedy, place=at)
        if self.body.name in PATCHES:
            remedy = "give the body another name"
            raise InputError(f"{self.body.name} is the name of another patch", remedy, place="bodies[0].name")
