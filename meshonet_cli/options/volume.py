"""Options of grids in space."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from meshonet_cli.options.groups import VOLUME, numbers, option_of

if TYPE_CHECKING:
    from meshonet.geometry.blocks.revolve import AxisLine

_option = option_of(VOLUME)

# fmt: off
Layers = Annotated[int | None, _option(
    "--layers", metavar="N", min=3,
    help="Nodes along the lines of a volume marched from a surface, the wall's included. [default: what "
    "a growth of 1.2 needs]",
)]

Revolve = Annotated[float | None, _option(
    "--revolve", metavar="DEG",
    help="Turn the plane about an axis by this: up to 10 degrees a wedge of one cell, below 360 a sector, "
    "360 a whole turn.",
)]
Axis = Annotated[str | None, _option(
    "--axis", metavar="x|y|X,Y,DX,DY",
    help="With --revolve: the axis, or a point on a line in the plane and its direction. [default: x]",
)]


def axis_of(text: str | None) -> "AxisLine | None":
    """Return the line that the words of an option mean, None for none.

    Raises InputError: other words than an axis or four numbers.
    """
    from meshonet.geometry.blocks.revolve import AxisLine

    named = {"x": "0,0,1,0", "y": "0,0,0,1"}
    words, remedy = named.get(text or "", text), "use x, y or X,Y,DX,DY, e.g. 0,-2,1,0"
    line = numbers(words, (4,), "an axis", remedy, "axis")
    return None if line is None else AxisLine(*line)


@dataclass(frozen=True, kw_only=True)
class VolumeOptions:
    """How a volume is marched from a surface, or filled inside six faces."""

    layers: Layers = None
    symmetry: Annotated[Literal["x", "y", "z", "none"] | None, _option(
        "--symmetry", metavar="x|y|z|none",
        help="Open edges of the surface lie in a plane of symmetry across this axis. [default: edges in one "
        "plane across an axis are in a plane of symmetry, others, and all with none, are free]",
    )] = None
    energy: Annotated[Literal["angles", "shape"] | None, _option(
        "--energy", metavar="angles|shape",
        help="What is minimised inside six faces. angles: right angles, and lengths that change gradually, "
        "whatever the aspect of cells. shape: cells like cubes, the inverse mean ratio |T|²/(3 det(T)^⅔) "
        "of their Jacobian matrices T (metric 303 of TMOP). [default: angles]",
    )] = None
# fmt: on
