"""Grids of many blocks are measured as the same grid in one block is, and where blocks meet too."""

from dataclasses import replace

import numpy as np
import pytest
from block_grids import butterfly, duct, joined, o_ring, turned
from test_checkmesh import Mesh

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.vertices import irregular_points, vertices
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.blocks import block_figures, deviation
from meshonet.geometry.quality.checkmesh import faces
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.figures import Figures
from meshonet.geometry.quality.gates import parse_gates
from meshonet.geometry.quality.growth import growth
from meshonet.geometry.quality.lines import lines
from meshonet.geometry.quality.measure import measure, per_cell_of_blocks, worst_cells_of
from meshonet.geometry.quality.metrics import NAMES
from meshonet.geometry.quality.report import quality_report


def shaken(ni: int = 13, nj: int = 9) -> Floats:
    x, y = np.meshgrid(np.arange(float(ni)), 0.4 * np.arange(nj), indexing="ij")
    return np.stack([x, y], axis=-1) + np.random.default_rng(4).uniform(-0.12, 0.12, (ni, nj, 2))


def in_four(nodes: Floats, i: int, j: int) -> Grid:
    """The grid cut at column i and row j, each part turned otherwise."""
    parts = [nodes[: i + 1, : j + 1], nodes[i:, : j + 1], nodes[: i + 1, j:], nodes[i:, j:]]
    return joined([turned(part, k) for k, part in enumerate(parts)], lambda _: "wall")


def test_a_grid_cut_into_blocks_has_the_figures_of_the_whole() -> None:
    whole, parts = Grid.from_nodes(shaken()), in_four(shaken(), 5, 3)
    one, four = measure(whole, percentiles=True), measure(parts, percentiles=True)
    assert (four.cells, four.folded) == (one.cells, one.folded)
    for name in NAMES:
        for statistic in ("min", "mean", "max", "p01", "p99"):
            assert getattr(four[name], statistic) == pytest.approx(getattr(one[name], statistic), rel=1e-12)
    own, other = faces(parts), faces(whole)
    for figure in ("non_orthogonality", "face_skewness", "box_ratio"):
        assert getattr(own, figure).max == pytest.approx(getattr(other, figure).max, rel=1e-12)
        assert getattr(own, figure).mean == pytest.approx(getattr(other, figure).mean, rel=1e-12)
    most = Figures(parts, four, ())("growth")
    assert most
    steps = growth(whole)
    assert steps.xi
    assert steps.eta
    assert most.value == pytest.approx(max(steps.xi.max, steps.eta.max), rel=1e-12)


def test_the_worst_cell_is_named_by_its_block() -> None:
    whole, parts = Grid.from_nodes(shaken()), in_four(shaken(), 5, 3)
    for name in NAMES[:-1]:  # the last, area_ratio, is the same for the two cells of a pair
        block, i, j = measure(parts)[name].worst
        a, b = measure(whole)[name].worst
        cell = parts.blocks[block].nodes[i : i + 2, j : j + 2].mean(axis=(0, 1))
        np.testing.assert_allclose(cell, whole.nodes[a : a + 2, b : b + 2].mean(axis=(0, 1)))


@pytest.mark.slow
def test_faces_between_blocks_are_those_of_openfoam() -> None:
    grid = butterfly()
    angles, skews = merged(grid).measures()
    measured = faces(grid)
    assert measured.non_orthogonality
    assert measured.face_skewness
    assert measured.non_orthogonality.max == pytest.approx(max(angles), rel=1e-9)
    assert measured.face_skewness.max == pytest.approx(max(skews), rel=1e-9)
    assert measured.face_skewness.mean == pytest.approx(np.mean(skews), rel=1e-9)


def merged(grid: Grid) -> Mesh:
    """The blocks as one mesh, nodes that coincide being one."""
    mesh = Mesh.__new__(Mesh)
    points = np.concatenate([block.nodes.reshape(-1, 2) for block in grid.blocks])
    where, number = np.unique(points, axis=0, return_inverse=True)
    mesh.where, mesh.cells, mesh.faces = dict(enumerate(where)), [], {}
    first = 0
    for k, block in enumerate(grid.blocks):
        lattice = number.ravel()[first : first + block.nodes[..., 0].size].reshape(block.counts)
        first += lattice.size
        for i, j in np.ndindex(block.counts[0] - 1, block.counts[1] - 1):
            ring = [int(lattice[a]) for a in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
            mesh.cells.append(((k, i), ring))
            for m in range(4):
                mesh.faces.setdefault(frozenset((ring[m], ring[m - 1])), []).append(len(mesh.cells) - 1)
    return mesh


def test_area_ratios_look_across_sides() -> None:
    x, y = np.meshgrid(np.array([0.0, 1.0, 2.0, 5.0, 8.0]), np.arange(3.0), indexing="ij")
    nodes = np.stack([x, y], axis=-1)
    parts = [turned(nodes[:3], 1), nodes[2:]]
    grid = joined(parts, lambda _: "wall")
    assert [cells.max() for cells in per_cell_of_blocks(grid, "area_ratio")] == [3.0, 3.0]
    across = Figures(grid, measure(grid), ())("growth_across")
    assert across
    assert across.value == 3.0


def test_a_kink_at_an_interface_is_a_bend_there_and_nowhere_else() -> None:
    run = block_figures(duct(1, bend=0.2)).lines
    assert run.bend_across
    assert run.bend_inside
    assert run.bend_across.max == pytest.approx(np.degrees(np.arctan(0.2)))
    assert run.bend_across.mean == pytest.approx(np.degrees(np.arctan(0.2)))
    assert run.bend_across.at[:2] == (0, 8)
    assert run.bend_inside.max < 1e-12


def test_no_line_runs_through_an_irregular_vertex() -> None:
    grid = butterfly(n=3, m=3)
    run = block_figures(grid).lines
    assert run.growth_across is not None
    nodes = vertices(grid)
    block, i, j = run.growth_across.at
    assert nodes.numbers[block][i, j] not in nodes.irregular


def test_irregular_vertices_are_counted_and_placed() -> None:
    points, cells = irregular_points(butterfly(core=0.4))
    assert sorted(map(tuple, np.abs(points).tolist())) == [(0.4, 0.4)] * 4
    assert cells.tolist() == [3, 3, 3, 3]
    assert [len(vertices(grid).irregular) for grid in (o_ring(), duct())] == [0, 0]


def test_walls_are_measured_by_name_over_all_blocks() -> None:
    report = quality_report(o_ring(n=9, m=12, growth=1.3), "viscous")
    (row,) = report.figures.wall_rows
    first = 2.0 / (1.3 ** np.arange(11)).sum()
    assert (row.name, row.side) == ("wall", "south")
    assert row.height.min == pytest.approx(first)
    assert row.height.max == pytest.approx(first)
    assert row.off_square.max == pytest.approx(180 / 32)
    assert report.profile
    actual = {result.check.figure: result for result in report.profile.results}
    assert (actual["wall_growth"].value, actual["wall_growth"].verdict) == (pytest.approx(1.3), "fail")
    assert actual["far_field"].value == pytest.approx(1.5)


def test_growth_away_from_walls_goes_on_in_the_next_block() -> None:
    radius = np.concatenate([np.arange(4.0), [5.0, 7.0, 9.0]])
    x, y = np.meshgrid(np.arange(4.0), radius, indexing="ij")
    nodes = np.stack([x, y], axis=-1)
    grid = joined([nodes[:, :4], turned(nodes[:, 3:], 1)], lambda side: "wall" if side[0, 1] == 0 else "top")
    report = quality_report(grid, "viscous")
    assert report.figures.blocks.lines.leaving is not None
    assert report.figures.blocks.lines.leaving.max == 2.0


def test_growth_alone_is_that_which_is_measured_with_bends() -> None:
    grid = in_four(shaken(), 5, 3)
    both, alone = lines(grid, vertices(grid)), lines(grid, vertices(grid), all_measures=False)
    assert alone.bend_inside is None
    assert alone.leaving == replace(both.leaving, p99=None)
    assert alone.by_wall == {name: replace(each, p99=None) for name, each in both.by_wall.items()}


def test_a_report_counts_blocks_and_judges_gates() -> None:
    report = quality_report(butterfly(), "openfoam")
    facts = report.as_dict()
    assert [facts[name] for name in ("blocks", "cells", "irregular", "interfaces")] == [5, 132, 4, 8]
    assert len(facts["quality"]["max_angle"]["worst"]) == 3
    assert facts["deviation"]["max"] == pytest.approx(45, abs=1e-6)
    gates = parse_gates(["irregular>3", "deviation_mean>1", "growth_across>2", "max_angle.p99>134"],
                        ("irregular", "deviation_mean", "growth_across"))  # fmt: skip
    assert [line.split(",")[0].split(" is ")[0] for line in report.broken(gates)] == [
        "irregular", "deviation_mean", "max_angle.p99",
    ]  # fmt: skip


def test_angles_of_a_sheared_grid_are_off_by_the_shear() -> None:
    angles = deviation(duct(2, bend=1.0))
    assert (angles.mean, angles.max) == (pytest.approx(22.5), pytest.approx(45))


def test_folded_cells_are_placed_in_their_block() -> None:
    grid = duct(0)
    nodes = grid.blocks[1].nodes.copy()
    nodes[3, 2] += 0.6
    folded = Grid((grid.blocks[0], Block(nodes)), grid.patches, grid.connections)
    assert measure(folded).folded == len(worst_cells_of(folded)) > 0
    assert {cell.block for cell in worst_cells_of(folded)} == {1}


def test_blocks_are_compared_with_the_same_blocks_only() -> None:
    grid = duct(0)
    nodes = grid.blocks[1].nodes.copy()
    nodes[3, 2] += (0.03, 0.04)
    moved = Grid((grid.blocks[0], Block(nodes)), grid.patches, grid.connections)
    difference = compare(moved, grid)
    assert (difference.max, difference.at) == (pytest.approx(0.05), (1, 3, 2))
    assert difference.boundary == 0
    with pytest.raises(InputError, match="block 1 of 9x5 nodes is not comparable with one of 5x9"):
        compare(grid, duct(1))
    with pytest.raises(InputError, match="2 blocks are not comparable with 5"):
        compare(grid, butterfly())
