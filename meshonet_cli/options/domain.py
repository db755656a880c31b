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
    help="Number of blocks. auto makes one block for a four-sided domain or a body in a far field, and "
    "several blocks for all other domains. single makes one block.",
)]
Walls = Annotated[str | None, _option(
    "--walls", metavar="NAME,NAME",
    help="Names of the walls that get the layers of --first-cell or --y-plus: holes, or named parts of a "
    "boundary curve. Layers end only at corners of about 90 degrees. If both sides of such a corner are "
    "walls, their layers meet. [default: the walls that --first-cell lists]",
)]


@dataclass(frozen=True, kw_only=True)
class BlockOptions:
    """Division of a domain into blocks. Each of these options except --assemble makes a multi-block grid."""

    assemble: Annotated[bool, _option(
        "--assemble",
        help="Combine all inputs into one domain: bodies in a common far field or, if one input encloses the "
        "others, inside this input. Each body is named after its file.",
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
        help="Use the blocks of this layout, written by meshonet layout for the same or a similar domain. "
        "For a grid with layers, make the layout with a first cell too. The command layout itself fits the "
        "blocks to its domain and writes them, with the number of cells that --cells gives.",
    )] = None
    periodic: Annotated[list[str] | None, _option(
        "--periodic", metavar="SIDE,SIDE",
        help="Names of two sides of the outer boundary that are periodic: a translation moves one onto the "
        "other. The nodes of the two sides match. Output formats that know periodic sides mark them. Repeat "
        "the option for a second pair. In GeoJSON files the property periodic has the same meaning.",
    )] = None

    walls: Walls = None
    count: Annotated[str | None, _option(
        "--count", metavar="SIDE=N,...",
        help="Number of cells along each named side of the domain, e.g. inlet=40. Opposite sides of a block "
        "have equal numbers of cells, so some combinations are impossible.",
    )] = None

    def parameters(self) -> dict[str, Any]:
        """Return the options as parameters of the library. Raises InputError: unreadable text."""
        values = dict(vars(self), walls=(), periodic=tuple(map(_pair, self.periodic or ())))
        del values["assemble"]
        if self.layout is not None:
            from meshonet.formats.layout.read import layout_of

            values["layout"] = layout_of(self.layout)
        values["count"] = {} if self.count is None else by_name(self.count, int, _COUNTS, "count")
        if self.walls is not None:
            values["walls"] = tuple(map(str.strip, self.walls.split(",")))
        return values


@dataclass(frozen=True, kw_only=True)
class DomainOptions(BlockOptions):
    """Options of grids of domains: division into blocks, passage of a cascade."""

    pitch: Annotated[str | None, _option(
        "--pitch", metavar="DX,DY",
        help="Displacement from one blade of a cascade to the next. The input is one blade; the grid fills "
        "the passage around this blade, and the nodes of the two periodic sides match. An error with "
        "--layout: the blocks of a passage are always the same.",
    )] = None
    inlet: Annotated[float | None, _option(
        "--inlet", metavar="L",
        help="Length of the passage upstream of the blade, in axial chords; needs --pitch. [default: 1]",
    )] = None
    outlet: Annotated[float | None, _option(
        "--outlet", metavar="L",
        help="Length of the passage downstream of the blade, in axial chords; needs --pitch. [default: 1]",
    )] = None

    def parameters(self) -> dict[str, Any]:
        """Return the options as parameters of the library. Raises InputError: unreadable text."""
        values = super().parameters()
        if self.pitch is not None:
            values["pitch"] = numbers(self.pitch, (2,), "a vector", "use DX,DY, e.g. 0,0.8", "pitch")
        return values
# fmt: on


def _pair(text: str) -> tuple[str, str]:
    names = [name.strip() for name in text.split(",")]
    if len(names) != 2 or not all(names):
        problem = f"{text!r} is not two names"
        raise InputError(problem, "use SIDE,SIDE, e.g. left,right", parameter="periodic")
    return names[0], names[1]
