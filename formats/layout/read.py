"""Reads layouts from JSON. All values are checked before they are used."""

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from meshonet.formats.layout.values import Values
from meshonet.formats.layout.write import NAME, VERSION
from meshonet.formats.source import Source, open_source, printable, reason_of
from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.domain.places_on_loops import arc_at, cells_at
from meshonet.geometry.errors import InputError, in_place, in_source
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.shapes.domain_shape import DomainShape

MOST_BYTES = 256 << 20  # largest file in bytes; parsing takes many times its size in memory


def read_layout(source: Source) -> Layout:
    """Return the block layout in a JSON file. Raises InputError if it is no consistent layout."""
    try:
        data = json.loads(source.bytes_below(MOST_BYTES, "a layout").decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not JSON ({reason_of(error)})", "write the layout again") from None
    if not isinstance(data, dict) or data.get("format") != NAME:
        raise InputError("is no layout", "write one: meshonet layout DOMAIN -o LAYOUT.json")
    if data.get("version") != VERSION:
        problem = f"is a layout of version {printable(str(data.get('version')))[:20]}"
        raise InputError(problem, f"this program reads version {VERSION}")
    file = Values(data)
    loops = tuple(_loop(values) for values in file.rows("loops"))
    periodic = _periodic(file) if "periodic" in data else ()
    domain = Domain(loops, printable(file.text("name")), periodic=periodic)
    layout = _LayoutNodes(domain, file.rows("vertices"), file.rows("edges"), file.rows("faces")).layout()
    fronts = [k for k, values in enumerate(file.rows("loops")) if values.data.get("front") is True]
    return replace(layout, fronts=tuple(fronts))


def layout_of(text: str) -> Layout:
    """Return the block layout in a file, or in standard input if `text` is ``-``; errors as `read_layout`."""
    source = open_source(text)
    with in_source(source.name):
        return read_layout(source)


def read_shapes(source: Source) -> Iterator[DomainShape]:
    """Yield one shape: the domain of a block layout together with its blocks."""
    layout = read_layout(source)
    yield DomainShape(layout.mesh.domain, layout=layout)


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield a single coarse grid, which consists of the blocks of the block layout in a file."""
    yield to_grid(read_layout(source), source.stem)


def _periodic(file: Values) -> tuple[Periodic, ...]:
    rows = [file.row("periodic")] if isinstance(file.data["periodic"], dict) else file.rows("periodic")
    pairs = []
    for values in rows:
        names = values.texts("names") if "names" in values.data else ["periodic1", "periodic2"]
        if len(names) != 2:
            raise values.error("names no two sides")
        both = printable(names[0]), printable(names[1])
        pairs.append(Periodic(values.pair("first"), values.pair("second"), values.pair("shift"), both))
    return tuple(pairs)


def _loop(values: Values) -> Loop:
    points = values.points("points", least=3)
    polygon = values.data.get("straight") is True
    straight = np.full(len(points), polygon)
    kinks = [] if polygon else values.numbers("kinks", len(points))
    if not polygon:
        straight[values.numbers("straight", len(points))] = True
    corners = values.numbers("corners", len(points))
    if corners != sorted(set(corners)):
        raise values.error("its corners do not ascend")
    with in_place(values.place):
        curve = Curve(points, closed=True, corners=kinks, straight=straight if straight.any() else None)
        loop = Loop(curve, tuple(corners), tuple(printable(name) for name in values.texts("names")))
    if (polygon_area(curve.points) > 0) != (values.place == "loops[0]"):
        raise values.error("has the domain on its right")
    return loop


class _LayoutNodes:
    """Table of all nodes: vertices, inner nodes of edges, inner nodes of faces."""

    def __init__(
        self, domain: Domain, vertices: list[Values], edges: list[Values], faces: list[Values]
    ) -> None:
        self.domain, self.edges, self.faces = domain, edges, faces
        self.nodes: list[Floats] = []
        self.arc: list[Floats] = []
        self.loop: list[Indices] = []
        self.cells: list[Indices] = []
        self.partner: list[Indices] = []
        self.count = 0
        for values in vertices:
            self._vertex(values, len(vertices))
        self.lines = [self._edge(values, len(vertices)) for values in edges]
        self.used = np.zeros(len(edges), dtype=np.intp)
        self.walls = np.array(["loop" in values.data for values in edges], dtype=bool)

    def layout(self) -> Layout:
        """Return the layout."""
        blocks = tuple(self._face(values) for values in self.faces)
        due = np.where(self.walls, 1, 2)
        for k in np.flatnonzero(self.used != due)[:1]:
            kind = "on a loop" if self.walls[k] else "inside"
            raise self.edges[k].error(f"an edge {kind} is a side of {self.used[k]} faces, not {due[k]}")
        layers = {k: n for k, values in enumerate(self.faces) if (n := values.count("layers", default=0))}
        loop, cells, partner = (np.concatenate(each) for each in (self.loop, self.cells, self.partner))
        for values, line in zip(self.edges, self.lines, strict=True):
            if "partner" in values.data:
                other = self._line(values, values.data["partner"])
                if len(other) != len(line):
                    raise values.error("its partner has another number of cells")
                partner[line[1:-1]] = other[1:-1]
        places = Places(loop, np.concatenate(self.arc), cells, partner)
        mesh = QuadMesh(self.domain, np.concatenate(self.nodes), lattice_quads(blocks), places)
        return Layout(mesh, blocks, layers)

    def _add(
        self, nodes: Floats, loop: int = -1, arc: Floats | None = None, cells: Any = 0, partner: int = -1
    ) -> Indices:
        """Add nodes (n, 2), with their arc lengths if they are on a loop, and return their numbers."""
        n = len(nodes)
        self.nodes.append(nodes)
        self.loop.append(np.full(n, loop, dtype=np.intp))
        self.arc.append(np.zeros(n) if arc is None else arc)
        self.cells.append(np.broadcast_to(np.asarray(cells, dtype=np.intp), n))
        self.partner.append(np.full(n, partner, dtype=np.intp))
        self.count += n
        return np.arange(self.count - n, self.count)

    def _vertex(self, values: Values, count: int) -> None:
        partner = values.number("partner", count) if "partner" in values.data else -1
        if "loop" not in values.data:
            self._add(values.points("at", one=True))
            return
        number, loop = self._loop(values)
        arc = arc_at(loop, self._places(values, loop, [values.data.get("place")]))
        self._add(loop.at(arc), number, arc, values.count("cells", default=0), partner)

    def _loop(self, values: Values) -> tuple[int, Loop]:
        number = values.number("loop", len(self.domain.loops))
        return number, self.domain.loops[number]

    def _places(self, values: Values, loop: Loop, places: Any) -> Floats:
        array = values.array(places, "its places")
        if array.ndim != 1 or not ((array >= 0) & (array < max(1, len(loop.corners)))).all():
            raise values.error(f"a place is not on a loop of {len(loop.corners)} corners")
        return array

    def _edge(self, values: Values, count: int) -> Indices:
        """Return the nodes of an edge, after adding those between its ends."""
        ends = [values.entry("vertices", k, 2, count) for k in (0, 1)]
        if "loop" in values.data:
            number, loop = self._loop(values)
            if any(int(self.loop[end][0]) != number for end in ends):
                raise values.error(f"its ends are not on loop {number}")
            places = self._places(values, loop, values.data.get("places"))
            arc = arc_at(loop, places)
            inner = self._add(loop.at(arc), number, arc, cells_at(loop, places))
        else:
            inner = self._add(values.points("points", least=0))
        if values.count("cells") != len(inner) + 1:
            raise values.error(f"has {values.count('cells')} cells and {len(inner)} nodes between its ends")
        return np.concatenate([ends[:1], inner, ends[1:]]).astype(np.intp)

    def _line(self, values: Values, number: Any) -> Indices:
        """Return the nodes of an edge, in reverse order for a number -1 - k."""
        if type(number) is not int or not -len(self.lines) <= number < len(self.lines):
            raise values.error(f"names edge {printable(str(number))[:20]} of {len(self.lines)}")
        return self.lines[number] if number >= 0 else self.lines[-1 - number][::-1]

    def _face(self, values: Values) -> Indices:
        """Return the lattice (ni, nj) of a face, after adding the interior nodes."""
        south, east, north, west = (self._side(values, side) for side in ("south", "east", "north", "west"))
        ni, nj = len(south), len(west)
        if len(north) != ni or len(east) != nj:
            raise values.error("opposite sides have different counts of cells")
        meet = (south[0], west[0]), (south[-1], east[0]), (north[0], west[-1]), (north[-1], east[-1])
        if any(a != b for a, b in meet):
            raise values.error("its sides do not meet in four vertices")
        if [ni - 1, nj - 1] != [values.entry("cells", k, 2, 1 << 31) for k in (0, 1)]:
            raise values.error(f"its sides have {ni - 1} x {nj - 1} cells, and it says otherwise")
        points = values.points("points", least=0)
        if len(points) != (ni - 2) * (nj - 2):
            raise values.error(f"has {len(points)} nodes inside, not {(ni - 2) * (nj - 2)}")
        block = np.empty((ni, nj), dtype=np.intp)
        block[1:-1, 1:-1] = self._add(points).reshape(ni - 2, nj - 2)
        block[:, 0], block[:, -1], block[0], block[-1] = south, north, west, east
        return block

    def _side(self, values: Values, side: str) -> Indices:
        """Return the nodes of a side, which consists of consecutive edges."""
        numbers = values.data.get(side)
        if not isinstance(numbers, list) or not numbers:
            raise values.error(f"has no edges on {side}")
        line = self._line(values, numbers[0])
        for number in numbers[1:]:
            more = self._line(values, number)
            if more[0] != line[-1]:
                raise values.error(f"the edges on {side} do not follow each other")
            line = np.concatenate([line, more[1:]])
        for number in numbers:
            self.used[number if number >= 0 else -1 - number] += 1
        return line
