"""Options of multi-block domains."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from meshonet.geometry.errors import InputError
from meshonet_cli.options.groups import DOMAIN, by_name, numbers, option_of

_option = option_of(DOMAIN)
_COUNTS = "use SIDE=N, e.g. inlet=40,floor=120"

# fmt: off
BlocksName = Annotated[Literal["auto", "single"], _option(
    "--blocks", help="Number of blocks. auto: one for a four-sided domain or a body in a far field, else "
    "several. single: one.",
)]
Walls = Annotated[str | None, _option(
    metavar="NAME,NAME", help="Names of the walls with layers: holes, or named parts of a boundary curve "
    "that end at corners of about 90 degrees. Needs --first-cell or --y-plus. [default: see --first-cell]",
)]


@dataclass(frozen=True, kw_only=True)
class BlockOptions:
    """Options of multi-block grids; giving any of them, except --assemble, asks for such a grid."""

    assemble: bool = _option(
        default=False, help="Combine all inputs into one domain. If one input encloses the others, it is the "
        "outer boundary; otherwise all are bodies in a common far field. Each wall is named after its file.",
    )
    cells: int | None = _option(
        metavar="N", help="Approximate number of cells in all blocks together. [default: 2500; with "
        "layers 20000 around one body, 30000 around two, 40000 around more]",
    )
    cell_size: float | None = _option(
        metavar="H", help="Edge length of cells away from walls, in the unit of the input, instead of "
        "--cells. Cells are smaller at layers and larger near a distant far field.",
    )
    layout: str | None = _option(
        metavar="LAYOUT.json", help="Use the blocks in this file, which meshonet layout wrote for this "
        "domain or a similar one. For a grid with layers, give meshonet layout a first-cell height too. "
        "[default: new blocks]",
    )
    periodic: list[str] | None = _option(
        metavar="SIDE,SIDE", help="Make the nodes of two named sides of the outer boundary match. One side "
        "must be a translation of the other. Repeat the option for a second pair.",
    )

    walls: Walls = None
    count: str | None = _option(
        metavar="SIDE=N,...", help="Number of cells along named sides of the domain, e.g. inlet=40. Opposite "
        "sides of a block have equal numbers, so some combinations are impossible. [default: set by --cells]",
    )

    def parameters(self) -> dict[str, Any]:
        """Return the options as parameters of the library. Raises InputError if a text is invalid."""
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
    """Options for grids of domains: division into blocks, and passage of a cascade."""

    pitch: str | None = _option(
        metavar="DX,DY", help="Vector from one blade of a cascade to the next, in the unit of the input. The "
        "input is one blade. The grid fills the passage around it; the nodes of its two periodic sides "
        "match. Not with --layout.",
    )
    inlet: float | None = _option(
        metavar="L", help="Length of the passage upstream of the blade, in axial chords. Needs --pitch. "
        "[default: 1]",
    )
    outlet: float | None = _option(
        metavar="L", help="Length of the passage downstream of the blade, in axial chords. Needs --pitch. "
        "[default: 1]",
    )

    def parameters(self) -> dict[str, Any]:
        """Return the options as parameters of the library. Raises InputError if a text is invalid."""
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
