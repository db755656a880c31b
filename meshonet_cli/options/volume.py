"""Options of three-dimensional grids."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from meshonet_cli.options.groups import VOLUME, bad_value, numbers, option_of

if TYPE_CHECKING:
    from meshonet.geometry.blocks.revolve import AxisLine

_option = option_of(VOLUME)

# fmt: off
Layers = Annotated[int | None, _option(
    metavar="N", min=3, help="Number of nodes of a marched volume on each grid line from the surface to the "
    "far field, including both ends. [default: as many as --growth needs]",
)]

Revolve = Annotated[float | None, _option(
    metavar="DEGREES", help="Turn the planar grid about --axis by this angle. Up to 10 degrees give a wedge "
    "of one cell, less than 360 a sector, 360 a full ring.",
)]
Axis = Annotated[str | None, _option(
    metavar="x|y|X,Y,DX,DY", help="Axis of --revolve: x, y, or the line through (X, Y) in the direction "
    "(DX, DY). [default: x]",
)]


def axis_of(text: str | None) -> "AxisLine | None":
    """Return the axis in the text of an option, None for None. Raises InputError if the text has no axis."""
    from meshonet.geometry.blocks.revolve import AxisLine

    named = {"x": "0,0,1,0", "y": "0,0,0,1"}
    words, remedy = named.get(text or "", text), "use x, y or X,Y,DX,DY, e.g. 0,-2,1,0"
    line = numbers(words, (4,), "an axis", remedy, "axis")
    return None if line is None else AxisLine(*line)


def copies_of(text: str | None) -> int | tuple[int, ...]:
    """Return the numbers of copies along a grid's periods; 1 for None. Raises InputError: other text.

    >>> copies_of("3x2"), copies_of("23")
    ((3, 2), 23)
    """
    words = (text or "1").lower().split("x")
    if not all(word.isascii() and word.isdigit() and len(word) < 10 for word in words):
        remedy = "use a number, or one for each of two periods, e.g. 3x2"
        raise bad_value(text or "", "numbers of copies", remedy, "copies")
    counts = tuple(map(int, words))
    return counts if len(counts) > 1 else counts[0]


@dataclass(frozen=True, kw_only=True)
class VolumeOptions:
    """Options for volumes that are marched from a surface or made inside six faces."""

    layers: Layers = None
    symmetry: Literal["x", "y", "z", "none"] | None = _option(
        help="Axis normal to the plane of symmetry that contains open edges of the surface. none: all open "
        "edges are free, and grid lines leave them along the surface normal. [default: open edges in a "
        "plane normal to an axis are in a plane of symmetry, others are free]",
    )
    poles: Literal["replace", "refuse"] = _option(
        default="replace", help="Treatment of sides of surface patches that are a single point, as at the "
        "nose of a fuselage. replace: a four-sided core patch and a few rows around it. refuse: an error.",
    )
    energy: Literal["angles", "shape"] | None = _option(
        help="Functional that is minimised inside six faces. angles: favours right angles and gradual "
        "changes of length. shape: favours cells like cubes (metric 303 of TMOP). [default: angles]",
    )
# fmt: on
