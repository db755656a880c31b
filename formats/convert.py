"""Conversion between formats: changes of grids, and the choice between boundaries and grids."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from meshonet.formats.registry import format_for_output, format_of, is_designation, read_grids, read_shapes
from meshonet.formats.source import LARGEST, open_source
from meshonet.formats.table import TABLE
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.copies import copied
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.revolve import AxisLine, Revolution, revolution, revolved
from meshonet.geometry.blocks.transform import coarser_grid, normalised, scaled, turned
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import UNJUDGED
from meshonet.geometry.spacing.sampling import Sampling


@dataclass(frozen=True)
class Conversion:
    """Changes that a conversion makes to grids and boundaries.

    Parameters
    ----------
    extrude : height in z to which planar grids are extruded; None: they are not extruded.
    planes : number of planes of nodes along z (default 2) or around the axis (default of `Revolution`).
    swap : exchange the directions xi and eta.
    normalise : scale to unit chord or unit length.
    coarsen : k keeps every k-th node.
    revolve : angle in degrees by which planar grids are revolved about `axis`; None: they are not revolved.
    axis : axis of the revolution, a line in the plane of the grid; None is the x axis.
    copies : number of copies of a periodic grid along each of its periods.
    scale : factor by which all coordinates are multiplied.
    """

    extrude: float | None = None
    planes: int | None = None
    swap: bool = False
    normalise: bool = False
    coarsen: int = 1
    revolve: float | None = None
    axis: AxisLine | None = None
    copies: int | tuple[int, ...] = 1
    scale: float = 1.0

    def turn(self) -> Revolution | None:
        """Return the revolution of planar grids about the axis; None if grids are not revolved."""
        turn = revolution(self.revolve, self.planes, self.axis)
        if turn is not None and self.extrude is not None:
            raise InputError("{extrude} and {revolve} both make grids 3D", "give one of them")
        return turn

    def heights(self) -> tuple[float, ...]:
        """Return z of each plane of nodes, () without extrusion. Raises InputError: height not above 0."""
        if self.extrude is None:
            if self.planes is not None and self.revolve is None:
                remedy = "give {extrude} or {revolve} as well"
                raise InputError("there is no height", remedy, parameter="planes")
            return ()
        if not 0 < self.extrude < LARGEST:
            raise InputError(f"height {self.extrude:g} is not positive", "use e.g. 1", parameter="extrude")
        planes = self.planes or 2
        return tuple(self.extrude * k / (planes - 1) for k in range(planes))

    def __call__(self, grid: Grid | Boundary) -> Grid | Boundary:
        """Return a grid with the changes that keep its dimension; boundaries stay unchanged."""
        if isinstance(grid, Boundary):
            return grid
        if replace(self, planes=None, axis=None) != Conversion():
            grid = grid.with_provenance(**UNJUDGED)
        grid = coarser_grid(grid, self.coarsen) if self.coarsen > 1 else grid
        grid = turned(grid) if self.swap else grid
        grid = normalised(grid) if self.normalise else grid
        return copied(scaled(grid, self.scale) if self.scale != 1.0 else grid, self.copies)

    def read(self, source: str, fmt: str | None, *, boundaries: bool) -> Iterator[Grid | Boundary]:
        """Yield the converted grids of `source`, or with `boundaries` the converted boundaries."""
        if not boundaries:
            return read_grids(source, fmt)
        sampling = Sampling(normalise=self.normalise)
        return (shape.boundary(sampling) for shape in read_shapes(source, fmt))

    def of_boundaries(self, source: str, output: str, from_format: str | None, to_format: str | None) -> bool:
        """Return whether the conversion writes boundaries instead of grids.

        It does so if the input or the output format has no grids, and no requested change needs grids.
        """
        changed = self.swap or self.coarsen > 1 or self.copies != 1 or self.scale != 1.0
        if changed or self.heights() or self.turn():
            return False
        try:
            written = format_for_output(output, to_format, "boundaries")
        except InputError:
            return False
        if written.write_grids is None:
            return True
        return source != "-" and format_of(open_source(source), from_format).read_grids is None

    def extruder(self, output: str, to_format: str | None) -> Callable[[Path, Iterable[Grid]], None] | None:
        """Return a function that extrudes or revolves grids and writes them; None if grids stay planar.

        Raises InputError if the output format cannot store three-dimensional grids.
        """
        heights, turn = self.heights(), self.turn()
        if not heights and turn is None:
            return None
        solid = partial(extruded, heights=heights) if turn is None else partial(revolved, turn=turn)
        record = format_for_output(output, to_format)
        write = record.write_grids
        if write is None or "volumes" not in record.space:
            able = ", ".join(each.name for each in TABLE.values() if "volumes" in each.space)
            raise InputError(f"{record.name} holds flat grids only", f"write one of {able}", source=output)
        return lambda path, grids: write(path, map(solid, grids))


def plot3d_variant(
    words: str | None, source: str, output: str, from_format: str | None, to_format: str | None
) -> tuple[str | None, str | None]:
    """Return the formats of input and output, where one is Plot3D with the options `words`.

    The options apply to the output if its format is Plot3D, else to the input. Raises InputError if an option
    is unknown, or if neither format is Plot3D.
    """
    if words is None:
        return from_format, to_format
    written = format_for_output(output, to_format).name if to_format or Path(output).suffix else ""
    if written.startswith("plot3d"):
        return from_format, f"{written}:{words}"
    if from_format is None and source != "-" and not is_designation(source):
        record = format_of(open_source(source))
        if record.read_grids is not None and record.name != "plot3d":
            problem = f"neither the input ({record.name}) nor the output ({written or to_format}) is Plot3D"
            raise InputError(problem, "leave {plot3d} out", source=source, parameter="plot3d")
    return f"{from_format or 'plot3d'}:{words}", to_format


def unused_iblank(grid: Grid | Boundary) -> str | None:
    """Return a note on nodes that have an iblank value other than 1; None without such nodes."""
    counts = grid.provenance.get("iblank") if isinstance(grid, Grid) else None
    marked = [f"{count} with {value}" for value, count in (counts or {}).items() if value != "1"]
    if not marked:
        return None
    return f"iblank marks nodes ({', '.join(marked[:5])}); they are kept as ordinary ones"
