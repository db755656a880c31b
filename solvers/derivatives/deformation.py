"""The exact derivative of the nodes of a grid, deformed in one step, by the nodes of its moved walls."""

from collections.abc import Mapping, Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.quality.measure import count_folded_in
from meshonet.solvers.deformation.follow import Field, Follow
from meshonet.solvers.deformation.motions import Turning, turns_in_plane
from meshonet.solvers.deformation.outer import NodeTable, lines_of
from meshonet.solvers.deformation.targets import NewWall, targets_of

Lines = dict[str, Floats]
"""Values (n, 2) at the nodes of each moved wall, in order; polylines with the same name are concatenated."""


class DeformationDerivative:
    """A planar grid deformed in one step, and the derivative of its nodes with respect to its wall nodes.

    Raises InputError in the cases of `meshonet.deform`, and for volumes. Raises NoValidGridError if cells
    fold.
    """

    grid: Grid  # the deformed grid
    walls: Mapping[str, Indices]
    """Node indices of each moved wall, in order; a closed wall repeats its first node."""

    def __init__(self, grid: Grid, walls: Mapping[str, NewWall] | NewWall) -> None:
        if grid.form != "plane":
            raise InputError("the derivative of a volume is not known", "give a planar grid")
        table = NodeTable.of(grid)
        targets = targets_of(table, walls)
        self._table, self._to = table, targets.nodes
        self._follow = Follow.of(table, targets.moved)
        self._turning = Turning.of(table.nodes, self._follow.sources.elements)
        nodes = self._follow.nodes_to(targets.nodes)
        self.grid = Grid(table.with_nodes(nodes), grid.patches, grid.connections, grid.name, grid.provenance)
        folded = count_folded_in(self.grid)
        if folded:
            raise NoValidGridError(f"{folded} cells fold in one step; go part of the way first")
        self.walls = {name: self._line(name) for name in targets.names}
        self._there = self._follow.boundary_to(targets.nodes)

    def along(self, moves: Mapping[str, Floats]) -> list[Floats]:
        """Return for each block the linear response (ni, nj, 2) of its nodes to wall displacements (n, 2)."""
        move = np.zeros_like(self._to)
        for name, values in moves.items():
            move[self.walls[name]] = self._checked(name, values)
        follow = self._follow
        if follow.slide is not None:
            slid = np.zeros_like(move)
            slid[follow.sources.slides] = self._field_along(follow.slide, self._to, move)
            move += follow.along_sides(slid, self._to)
        move[follow.inner] = self._field_along(follow.field, self._there, move)
        return [np.ascontiguousarray(move[number]) for number in self._table.numbers]

    def transposed(self, pulls: Floats | Sequence[Floats]) -> Lines:
        """Return the derivative (n, 2) of a functional with respect to the nodes of each moved wall.

        `pulls` has an array (ni, nj, 2) for each block: the derivative of the functional with respect to the
        nodes, as if all moved independently. The result is 0 where the last node of a wall repeats the first.
        """
        arrays = [pulls] if isinstance(pulls, np.ndarray) else list(pulls)
        if [a.shape[:2] for a in arrays] != [block.counts for block in self.grid.blocks]:
            raise InputError("derivatives of other sizes than the grid's blocks", "give (ni, nj, 2) of each")
        pull = np.zeros_like(self._to)
        for number, array in zip(self._table.numbers, arrays, strict=True):
            np.add.at(pull, number, array)
        follow = self._follow
        pull += self._field_transposed(follow.field, self._there, pull[follow.inner])
        if follow.slide is not None:
            slides = follow.sources.slides
            slid = np.where(slides[:, None], pull, 0.0)
            slid = follow.along_sides(slid, self._to)  # a projection is its own transpose
            pull += self._field_transposed(follow.slide, self._to, slid[slides])
        result = {}
        for name, line in self.walls.items():
            result[name] = pull[line]
            _, first = np.unique(line, return_index=True)
            again = np.setdiff1d(np.arange(len(line)), first)
            result[name][again] = 0.0
        return result

    def _line(self, name: str) -> Indices:
        lines = lines_of([piece for piece in self._table.pieces if piece.patch.name == name])
        return np.concatenate(lines)

    def _checked(self, name: str, values: Floats) -> Floats:
        if np.shape(values) != (len(self.walls[name]), 2):
            count = f"{len(self.walls[name])} nodes"
            raise InputError(f"moves of shape {np.shape(values)} of {name!r}", f"it has {count}: give (n, 2)")
        return values

    def _field_along(self, field: Field, there: Floats, move: Floats) -> Floats:
        turning, at = self._turning, field.sources
        old = self._table.nodes[at]
        angles = turning.angles(self._table.nodes, there)[at]
        change = turning.angles_along(there, move)[at][:, None, None] * _slope(angles)
        shift = move[at] - product(change, old[:, :, None])[:, :, 0]
        return field.blended(np.ascontiguousarray(np.concatenate([shift.T, change.reshape(-1, 4).T])))

    def _field_transposed(self, field: Field, there: Floats, pull: Floats) -> Floats:
        turning, at = self._turning, field.sources
        old = self._table.nodes[at]
        gathered = field.transposed(pull)
        shift, turn = gathered[:2].T, gathered[2:].T.reshape(-1, 2, 2)
        turn = turn - shift[:, :, None] * old[:, None, :]
        angles = turning.angles(self._table.nodes, there)[at]
        by_angle = np.zeros(len(there))
        by_angle[at] = (_slope(angles) * turn).sum(axis=(1, 2))
        result = turning.angles_transposed(there, by_angle)
        result[at] += shift
        return result


def _slope(angles: Floats) -> Floats:
    """Return the derivative (n, 2, 2) of rotation matrices with respect to their angles (n,)."""
    return turns_in_plane(angles + 0.5 * np.pi) + np.eye(2)
