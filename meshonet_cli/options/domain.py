"""Options of multi-block domains."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from meshonet.geometry.errors import InputError
from meshonet_cli.options.groups import DOMAIN, by_name, numbers, option_of

_option = option_of(DOMAIN)
_COUNTS = "use SIDE=N, e.g. inlet=40,floor=120"

# fmt: off
BlocksName = Annotated[Literal["auto", "single"], _option(
    "--blocks", metavar="auto|single", show_default=True,
    help="Number of blocks. auto splits every domain that is neither four-sided nor a body in its far field "
    "into blocks; single makes one block.",
)]
Walls = Annotated[str | None, _option(
    "--walls", metavar="NAME,NAME",
    help="Names of the walls that get the layers of --first-cell or --y-plus: holes, or named parts of a "
    "boundary curve. At a corner of about 90 degrees, layers end or meet those of the next wall. [default: "
    "as described at --first-cell]",
)]


@dataclass(frozen=True, kw_only=True)
class DomainOptions:
    """How a domain is split into blocks. Each of these options except --assemble makes a multi-block grid."""

    assemble: Annotated[bool, _option(
        "--assemble",
        help="Combine all inputs into one domain: bodies in a common far field, or in the input that "
        "encloses the others. Each body is named after its file.",
    )] = False
    cells: Annotated[int | None, _option(
        "--cells", metavar="N",
        help="Approximate number of cells in all blocks together. [default: 2500, or 20000 with layers]",
    )] = None
    cell_size: Annotated[float | None, _option(
        "--cell-size", metavar="H",
        help="Edge length of cells away from walls, in the unit of the domain. Edges are shorter next to "
        "layers and longer towards a distant far field.",
    )] = None
    layout: Annotated[str | None, _option(
        "--layout", metavar="LAYOUT.json",
        help="Use the blocks of this layout, which meshonet layout has written for the same or a similar "
        "domain. For a grid with layers, the layout must have been made with a first cell too.",
    )] = None
    pitch: Annotated[str | None, _option(
        "--pitch", metavar="DX,DY",
        help="Displacement from one blade of a cascade to the next. The input is one blade; the grid fills "
        "the passage around it, and its periodic sides match node by node.",
    )] = None
    inlet: Annotated[float | None, _option(
        "--inlet", metavar="L",
        help="Length of the passage upstream of the blade, in axial chords; needs --pitch. [default: 1]",
    )] = None
    outlet: Annotated[float | None, _option(
        "--outlet", metavar="L",
        help="Length of the passage downstream of the blade, in axial chords; needs --pitch. [default: "
        "1]",
    )] = None

    periodic: Annotated[list[str] | None, _option(
        "--periodic", metavar="SIDE,SIDE",
        help="Two sides of the outer boundary, by name, that are periodic: translated copies of each other. "
        "Their nodes match, and formats that know periodic sides have them as such. Repeat it for a second "
        "pair. GeoJSON has the property periodic for the same.",
    )] = None

    walls: Walls = None
    count: Annotated[str | None, _option(
        "--count", metavar="SIDE=N,...",
        help="Number of cells along each named side of the domain, e.g. inlet=40. Blocks have as many cells "
        "on opposite sides, so that counts can exclude each other.",
    )] = None

    def parameters(self) -> dict[str, Any]:
        """Return them for the library; raise InputError for what cannot be read."""
        values = dict(vars(self), walls=(), periodic=tuple(map(_pair, self.periodic or ())))
        del values["assemble"]
        if self.layout is not None:
            from meshonet.formats.layout.read import layout_of

            values["layout"] = layout_of(self.layout)
        if self.pitch is not None:
            values["pitch"] = numbers(self.pitch, (2,), "a vector", "use DX,DY, e.g. 0,0.8", "pitch")
        values["count"] = {} if self.count is None else by_name(self.count, int, _COUNTS, "count")
        if self.walls is not None:
            values["walls"] = tuple(map(str.strip, self.walls.split(",")))
        return values
# fmt: on


def _pair(text: str) -> tuple[str, str]:
    """Return the two names of a pair of periodic sides."""
    names = [name.strip() for name in text.split(",")]
    if len(names) != 2 or not all(names):
        problem = f"{text!r} is not two names"
        raise InputError(problem, "use SIDE,SIDE, e.g. left,right", parameter="periodic")
    return names[0], names[1]
