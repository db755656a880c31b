"""A fin: a wing in the plane of symmetry of an aircraft."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

_CAMBER = 1e-5  # largest difference of the two sides, in chords: rounding of coordinates in files
_POINTS = 65  # points of a side that are compared


@dataclass(frozen=True, eq=False)
class Fin(Stack):
    """A wing of symmetric sections in the plane of symmetry; its first section is inside the body.

    It has the parameters of `Stack`. The z of a section is its height: the coordinate y of the aircraft.

    Raises
    ------
    InputError
        The errors of `Stack`; a section with camber or twist, or outside the plane of symmetry.

    Examples
    --------
    >>> import meshonet
    >>> root = meshonet.Section(meshonet.read("naca:0010"), chord=1.4, z=0.0, x=8.0)
    >>> tip = meshonet.Section(meshonet.read("naca:0010"), chord=0.7, z=2.4, x=9.4)
    >>> meshonet.Fin((root, tip), name="fin").end
    (9.4, 2.4, 0.0)
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        for number, section in enumerate(self.sections):
            _refuse_half(section, f"sections[{number}]")

    @property
    def end(self) -> tuple[float, float, float]:
        """Leading edge of the last section in the axes of the aircraft."""
        last = self.sections[-1]
        return last.x, last.z, 0.0


def _refuse_half(section: Section, at: str) -> None:
    """Raise InputError for a section that is not symmetric about the plane z = 0."""
    for key, value in (("y", section.y), ("twist", section.twist), ("cant", section.cant)):
        if value != 0.0:
            text = value if isinstance(value, str) else f"{value:g}"
            raise InputError(f"{text} in a fin", "leave it out", place=f"{at}.{key}")
    if not isinstance(section.shape, Airfoil):
        return
    curve, (origin, length) = section.shape.curve, section.frame
    arcs = curve.length * np.linspace(0.0, 0.5, _POINTS)
    lower, upper = ((curve.at(each) - origin) / length for each in (arcs, curve.length - arcs))
    off = float(np.abs(upper - lower * [1.0, -1.0]).max())
    if off > _CAMBER:
        name = section.shape.name or "a section"
        problem = f"{name} is not symmetric: its sides differ by {off:.2g} chords"
        raise InputError(problem, "give a fin symmetric sections, such as naca:0010", place=f"{at}.airfoil")
