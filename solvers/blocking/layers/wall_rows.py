"""Rows of quads along walls of a finished layout, which become the blocks of the layers there.

::

    a corner between two walls        a row that ends alone        around a sharp edge and its wake
        |   |   |                            |   |   |                ---------- front --------.
        |---+---+--- front        front -----+---+---|                 wake  ----------- edge wall |
        |   |   |                            |   |   | another wall   ---------- front --------'
        +---+---+--- wall          wall -----+---+---+
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, complex_of, distinct
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.decomposition.quads.inner_rows import half_edges, with_row
from meshonet.solvers.blocking.decomposition.quads.padding import along_wall, pad_span
from meshonet.solvers.blocking.decomposition.symmetry.images import images_of
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror
from meshonet.solvers.blocking.decomposition.symmetry.symmetric import cut_on_mirrors
from meshonet.solvers.blocking.layers.growth_lines import GrowthLines
from meshonet.solvers.blocking.layers.stretches import Stretch
from meshonet.solvers.refinement.chords import Chords

Edge = tuple[int, int]


@dataclass(frozen=True, eq=False)
class WallRows:
    """Rows of blocks along the walls of a layout; each block belongs to one or two rows, or to none.

    Parameters
    ----------
    loops : for each row, the index of the loop along which it goes.
    across : (b, 2) indices of two rows for each block, -1 for none. Grid lines of the block from south to
        north lead across the first row, those from west to east across the second. Refinement does not
        change these indices.
    back : (b, 2) whether the block's north side is on the wall (or wake) of the first row, and its east side
        on that of the second.
    """

    loops: tuple[int, ...]
    across: Indices
    back: Bools

    def of_chords(self, chords: Chords) -> Indices:
        """Return, for each chord (set of opposite block edges), the row that its edges cross, -1 for none."""
        row = np.full(chords.count, -1, dtype=np.intp)
        row[chords.chord[chords.sides[:, 2]]] = self.across[:, 0]
        row[chords.chord[chords.sides[:, 0]]] = self.across[:, 1]
        return row

    def columns(self, layout: Layout, row: int) -> list[Indices]:
        """Return, for each block of a row, the nodes (k, n) of k lines across the row, from wall or wake."""
        tables = []
        for block, direction in zip(*np.nonzero(self.across == row), strict=True):
            table = layout.blocks[block].T if direction else layout.blocks[block]
            tables.append(table[:, ::-1] if self.back[block, direction] else table)
        return tables

    def growth(self, layout: Layout, loop: int) -> float:
        """Return the largest |log(length ratio)| of neighbouring edges along a loop's wall and its wake."""
        base = np.zeros(len(layout.mesh.nodes), dtype=bool)
        for table in self.columns(layout, self.loops.index(loop)):
            base[table[:, 0]] = True
        lines = GrowthLines.of(layout.mesh, 0.0)
        along = lines.some(np.asarray(base[lines.nodes].all(axis=1)))
        return float(np.abs(along.growth(complex_of(layout.mesh.nodes))).max())

    def wakes(self, layout: Layout) -> dict[int, Floats]:
        """Return the nodes (k, 2) of wakes behind sharp edges, along which layers continue, by loop index."""
        mesh, lines = layout.mesh, {}
        for row, loop in enumerate(self.loops):
            base = distinct(np.concatenate([table[:, 0] for table in self.columns(layout, row)]))
            edge = (mesh.places.loop[base] == loop) & (mesh.places.cells[base] == 4)
            if (mesh.places.loop[base] != loop).any():
                wake = mesh.nodes[base[edge | (mesh.places.loop[base] != loop)]]
                away = np.hypot(*(wake - mesh.nodes[base[edge][0]]).T)
                lines[loop] = wake[np.argsort(away, kind="stable")]
        return lines


def has_sharp_edge(loop: Loop) -> bool:
    """Return whether a loop has exactly one corner, so sharp that four cells meet there."""
    return len(loop.corners) == 1 and int(loop.corner_cells[0]) == 4


def wake_of(mesh: QuadMesh, number: int) -> list[int]:
    """Return the nodes of the grid line from the sharp edge of loop `number` to a boundary."""
    half, places = half_edges(mesh), mesh.places
    edge = int(np.argmax((places.loop == number) & (places.cells == 4)))

    def turned(node: int, beside: int, quads: int) -> int:
        """Return the neighbour of `node` that is `quads` quads counter-clockwise from neighbour `beside`."""
        for _ in range(quads):
            k, i = half[node, beside]
            beside = int(mesh.quads[k, (i + 3) % 4])
        return beside

    wake = [edge, turned(edge, along_wall(mesh, edge, edge)[1], 2)]
    while not mesh.wall_nodes[wake[-1]]:
        wake.append(turned(wake[-1], wake[-2], int(mesh.valence[wake[-1]]) // 2))
    return wake


def with_wall_rows(
    layout: Layout, stretches: Sequence[Stretch], sharp: Sequence[int] = (), mirrors: Sequence[Mirror] = ()
) -> tuple[Layout, WallRows]:
    """Return the layout with rows of quads added along walls, and these rows.

    One row goes along each of the `stretches` (parts of loops). One goes around each loop in `sharp`
    (indices) and around the wake behind its sharp edge. `mirrors` are mirror lines of the domain. Raises
    SolverError if the new mesh cannot be divided into blocks.
    """
    mesh = layout.mesh
    rungs: list[Edge] = []  # an edge across each row, from wall to front
    fronts: list[list[Edge]] = []
    for number in sharp:
        before, wake = len(mesh.quads), wake_of(mesh, number)
        mesh = with_row(mesh, [*wake[:0:-1], *along_wall(mesh, wake[0], wake[0])[:-1], *wake])
        row = mesh.quads[before:].tolist()
        fronts.append([(quad[3], quad[2]) for quad in row])
        rungs.append((row[len(row) // 2][0], row[len(row) // 2][3]))
    for stretch in stretches:
        before = len(mesh.quads)
        mesh = pad_span(mesh, (stretch.loop, *stretch.span(mesh.domain.loops[stretch.loop])))
        row = mesh.quads[before:].tolist()
        whole = len(row) > 1 and row[0][3] == row[-1][2]
        row = row[:-1] if whole else row  # the last one is at the corner
        across = [(quad[0], quad[3]) for quad in row] + [(row[-1][1], row[-1][2])]
        ends = {node for front in fronts for node in (front[0][0], front[-1][1])}
        ends |= {across[0][1]} if whole else set()
        fronts += [[edge] for edge in across if edge[1] in ends]  # fronts continue to the wall beyond
        fronts.append([(quad[3], quad[2]) for quad in row])
        rungs.append(across[len(row) // 2])
    lines = np.zeros(len(mesh.edges), dtype=bool)
    lines[_edges(mesh, [edge for front in fronts for edge in front])] = True
    parts = cut_on_mirrors(mesh, images_of(mesh, mirrors), lines & ~mesh.on_wall)
    row_of = np.full(parts.chords, -1, dtype=np.intp)
    row_of[parts.chord[_edges(mesh, rungs)]] = np.arange(len(rungs))
    rows_across = row_of[parts.sides[2].reshape(-1, 4)][:, [2, 0]]
    on_front = np.zeros(len(mesh.nodes), dtype=bool)
    on_front[[node for front in fronts for edge in front for node in edge]] = True
    back = np.array([[on_front[block[:, 0]].all(), on_front[block[0]].all()] for block in parts.blocks])
    loops = (*sharp, *(stretch.loop for stretch in stretches))
    return replace(layout, mesh=mesh, blocks=parts.blocks), WallRows(loops, rows_across, back)


def _edges(mesh: QuadMesh, pairs: Sequence[Edge]) -> Indices:
    return mesh.edges_between(*np.array(pairs, dtype=np.intp).reshape(-1, 2).T)
