"""Options of domains that are made as many blocks."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from meshonet.geometry.errors import InputError
from meshonet_cli.options.groups import DOMAIN, numbers, option_of

_option = option_of(DOMAIN)

# fmt: off
BlocksName = Annotated[Literal["auto", "single"], _option(
    "--blocks", metavar="auto|single", show_default=True,
    help="auto splits domains into blocks that are not four-sided, nor a body in its far field; single asks "
    "for one block.",
)]
Walls = Annotated[str | None, _option(
    "--walls", metavar="NAME,NAME",
    help="Walls that --first-cell or --y-plus make layers along: names of holes, and of parts of loops. "
    "Layers end at corners of about 90 degrees, or meet there. [default: every hole]",
)]


@dataclass(frozen=True, kw_only=True)
class DomainOptions:
    """How a domain is split into blocks. Each of these but --assemble asks for blocks."""

    assemble: Annotated[bool, _option(
        "--assemble",
        help="All inputs are one domain: bodies in one far field, or in the one that encloses the others; "
        "parts are called by their files.",
    )] = False
    cells: Annotated[int | None, _option(
        "--cells", metavar="N", help="About so many cells in all blocks. [default: 2500, with layers 20000]",
    )] = None
    cell_size: Annotated[float | None, _option(
        "--cell-size", metavar="H",
        help="Length of edges away from walls, in the domain's unit; they are shorter near layers, and "
        "longer on the way to a distant far field.",
    )] = None
    layout: Annotated[str | None, _option(
        "--layout", metavar="LAYOUT.json",
        help="Take the blocks of a layout (see meshonet layout), of this domain or of one like it; for "
        "layers, of a layout with a first cell.",
    )] = None
    pitch: Annotated[str | None, _option(
        "--pitch", metavar="DX,DY",
        help="The input is a blade; make the passage of a cascade of blades so far apart, its periodic sides "
        "matched node by node.",
    )] = None
    inlet: Annotated[float | None, _option(
        "--inlet", metavar="L", help="With --pitch: length before the blade, in axial chords. [default: 1]",
    )] = None
    outlet: Annotated[float | None, _option(
        "--outlet", metavar="L", help="With --pitch: length behind the blade, in axial chords. [default: 1]",
    )] = None

    periodic: Annotated[list[str] | None, _option(
        "--periodic", metavar="SIDE,SIDE",
        help="Two sides of the outer boundary, by name, that are periodic: translated copies of each other. "
        "Their nodes match, and formats that know periodic sides have them as such. Repeat it for a second "
        "pair. GeoJSON has the property periodic for the same.",
    )] = None

    walls: Walls = None

    def parameters(self) -> dict[str, Any]:
        """Return them for the library; raise InputError for what cannot be read."""
        values = dict(vars(self), walls=(), periodic=tuple(map(_pair, self.periodic or ())))
        del values["assemble"]
        if self.layout is not None:
            from meshonet.formats.layout.read import layout_of

            values["layout"] = layout_of(self.layout)
        if self.pitch is not None:
            values["pitch"] = numbers(self.pitch, (2,), "a vector", "use DX,DY, e.g. 0,0.8", "pitch")
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
