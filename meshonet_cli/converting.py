"""What `convert` does with each grid or boundary."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from meshonet.formats.format import Heights
from meshonet.formats.mesh.recover_topology import LARGEST
from meshonet.formats.registry import format_for_output, format_of, formats, read_grids, read_shapes
from meshonet.formats.source import open_source
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.coarsen import coarser_grid
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.normalise import normalised
from meshonet.geometry.blocks.rotate import turned
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling
from meshonet_cli.batch import Destination, items
from meshonet_cli.delivery import deliver, prepare
from meshonet_cli.member import Item
from meshonet_cli.report import Timed
from meshonet_cli.session import Session


@dataclass
class Converted(Timed):
    """What there is to tell of a file that was converted."""

    what: Grid | Boundary

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        what = self.what
        facts = {
            "ni": what.ni,
            "nj": what.nj,
            "topology": what.topology,
            "parts": [p.name for p in what.patches],
        }
        return {**self.member_json(), **facts, "seconds": self.times_json()}

    def line(self) -> str:
        """Return it for people."""
        size = f"{self.what.ni} x {self.what.nj} nodes, {self.what.topology}"
        return f"{self.item.label} -> {self.output}: {size}, {self.times()}"

    lines = line


@dataclass(frozen=True)
class Change:
    """What happens to a grid or boundary on its way.

    Parameters
    ----------
    extrude : height in z that a 3D grid gets; None leaves grids flat.
    planes : planes of nodes in z; None stands for two.
    swap : have xi run along the sides that eta ran along.
    normalise : scale to unit chord or unit length.
    coarsen : keep every so many-th node.
    """

    extrude: float | None = None
    planes: int | None = None
    swap: bool = False
    normalise: bool = False
    coarsen: int = 1

    def heights(self) -> Heights:
        """Return z of each plane, none for a flat grid.

        Raises
        ------
        InputError
            a height that is not positive, planes without a height.
        """
        if self.extrude is None:
            if self.planes is not None:
                raise InputError("there is no height", "add --extrude H", source="--planes")
            return ()
        if not 0 < self.extrude < LARGEST:
            raise InputError(f"height {self.extrude:g} is not positive", "use e.g. 1", source="--extrude")
        planes = self.planes or 2
        return tuple(self.extrude * k / (planes - 1) for k in range(planes))

    def __call__(self, grid: Grid) -> Grid:
        """Return `grid` coarsened, swapped and normalised as asked."""
        grid = coarser_grid(grid, self.coarsen) if self.coarsen > 1 else grid
        grid = turned(grid) if self.swap else grid
        return normalised(grid) if self.normalise else grid


NOTHING = Change()


def convert_files(
    sources: Sequence[str],
    output: str,
    session: Session,
    *,
    from_format: str | None = None,
    to_format: str | None = None,
    change: Change = NOTHING,
    skip_existing: bool = False,
) -> int:
    """Write what `sources` hold to `output` and return the exit code.

    Grids stay grids; what holds boundaries only becomes boundaries.

    Parameters
    ----------
    change : what happens to each on its way.
    skip_existing : pass over members whose own file is there.

    Raises
    ------
    InputError
        a format that cannot be written, or not in 3D; a height that is not positive.
    """
    heights = change.heights()
    flat = not heights and not change.swap and change.coarsen == 1
    boundaries = flat and _writes_boundaries(sources[0], output, from_format, to_format)
    if boundaries:
        destination = Destination(output, to_format, "boundaries")
    else:
        destination = Destination(output, to_format, put=_extruder(output, to_format, heights))
    prepare(sources, destination, session)

    def read(source: str) -> Iterator[Grid | Boundary]:
        if not boundaries:
            return read_grids(source, from_format)
        sampling = Sampling(normalise=change.normalise)
        return (shape.boundary(sampling) for shape in read_shapes(source, from_format))

    def make(item: Item[Grid | Boundary]) -> tuple[Grid | Boundary, Converted]:
        what = change(item.what) if isinstance(item.what, Grid) else item.what
        _tell_of_iblank(item, session)
        return what, Converted(item, what)

    def tell(report: Converted, path: str) -> None:
        report.finished(path)
        session.tell(report)

    deliver(items(sources, read, session), make, destination, session, tell, skip_existing=skip_existing)
    return session.finish()


def in_plot3d(
    words: str | None, output: str, from_format: str | None, to_format: str | None
) -> tuple[str | None, str | None]:
    """Return the formats to read and write, the Plot3D file among them in the variant of `words`.

    Raises
    ------
    InputError
        words that are not known, or no file in Plot3D.
    """
    if words is None:
        return from_format, to_format
    written = format_for_output(output, to_format).name if to_format or Path(output).suffix else ""
    if written.startswith("plot3d"):
        return from_format, f"{written}:{words}"
    return f"{from_format or 'plot3d'}:{words}", to_format


def print_formats(session: Session, *, as_json: bool) -> int:
    """Print what every format can do, one JSON object each when asked, and return the exit code."""
    from meshonet.formats.catalogue import plain, rows

    if as_json:
        for row in rows():
            session.result(row)
    else:
        session.print(plain())
    return session.finish()


def _tell_of_iblank(item: Item[Grid | Boundary], session: Session) -> None:
    """Warn of nodes that an iblank array takes out of use or gives a meaning: no grid has room for it."""
    counts = item.what.provenance.get("iblank") if isinstance(item.what, Grid) else None
    told = [f"{count} with {value}" for value, count in (counts or {}).items() if value != "1"]
    if told:
        session.warn(
            f"{item.label}: iblank marks nodes ({', '.join(told[:5])}); they are kept as ordinary ones"
        )


def _writes_boundaries(source: str, output: str, from_format: str | None, to_format: str | None) -> bool:
    """Say whether boundaries are written: the output holds nothing else, or the input does."""
    try:
        written = format_for_output(output, to_format, "boundaries")
    except InputError:
        return False
    if written.write_grids is None:
        return True
    return source != "-" and format_of(open_source(source), from_format).read_grids is None


def _extruder(
    output: str, to_format: str | None, heights: Heights
) -> Callable[[Path, Iterable[Grid]], None] | None:
    if not heights:
        return None
    found = format_for_output(output, to_format)
    write = found.write_extruded
    if write is None:
        able = ", ".join(other.name for other in formats() if other.write_extruded is not None)
        raise InputError(f"{found.name} holds flat grids only", f"write one of {able}", source=output)
    return lambda path, grids: write(path, grids, heights)
