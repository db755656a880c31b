"""Options of grids in space."""

from dataclasses import dataclass
from typing import Annotated, Literal

from meshonet_cli.options.groups import VOLUME, option_of

_option = option_of(VOLUME)

# fmt: off
Layers = Annotated[int | None, _option(
    "--layers", metavar="N", min=3,
    help="Nodes along the lines of a volume marched from a surface, the wall's included. [default: what "
    "a growth of 1.2 needs]",
)]


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
