"""Reports of volumes and surfaces: walls, growth across faces, comparison, coarser grids."""

import json
from dataclasses import replace

import numpy as np
import pytest
from space_grids import lattice, pipe, sphere_patches, turned

from meshonet.geometry import threads
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes
from meshonet.geometry.blocks.transform import coarser_grid, normalised
from meshonet.geometry.blocks.transform import turned as quarter_turn
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.blocks import block_figures
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.gates import parse_gates
from meshonet.geometry.quality.growth import ratios
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.quality.report import quality_report
from meshonet.geometry.threads import limited_to

GROWTH = 1.2


def joined(nodes: list[Floats], patches: tuple[Patch, ...] = ()) -> Grid:
    blocks = [Block(each) for each in nodes]
    connections = find_connections(blocks)
    return Grid(with_equal_nodes(blocks, connections), patches, connections)


def shell(n: int = 9, layers: int = 8, first: float = 0.01, split: int = 0) -> Grid:
    """A cubed sphere of radius 1 and its layers, two rings of six blocks where it is `split` at a layer."""
    radius = 1 + first * np.concatenate([[0], np.cumsum(GROWTH ** np.arange(layers))])
    cuts = [(0, layers)] if not split else [(0, split), (split, layers)]
    nodes = [patch[:, :, None] * radius[a : b + 1, None] for a, b in cuts for patch in sphere_patches(n)]
    walls = [Patch("wall", "bottom", 0, n - 1, block=k) for k in range(6)]
    far = [Patch("farfield", "top", 0, n - 1, block=len(nodes) - 6 + k) for k in range(6)]
    return joined(nodes, (*walls, *far))


@pytest.mark.parametrize("split", [0, 3])
def test_a_shell_has_its_first_cell_growth_and_angle(split: int) -> None:
    report = quality_report(shell(split=split), profile="viscous")
    (row,) = report.figures.wall_rows
    assert (row.name, row.side) == ("wall", "bottom")
    assert [row.height.min, row.height.mean, row.height.max] == pytest.approx([0.01] * 3)
    assert row.growth.max == pytest.approx(GROWTH)
    assert row.growth.at[0] in range(12)
    assert row.equal_cells == 1
    half = np.pi / 4 / 8  # a chord is off the tangent by half of the angle between its ends
    assert half < np.radians(row.off_square.min) < np.radians(row.off_square.max) < 2 * half
    assert [result.verdict for result in report.profile.results if result.check.figure == "wall_growth"] == [
        "pass"
    ]


@pytest.mark.parametrize("nodes_each", [16, 400])  # blocks with threads of their own, and several at once
def test_threads_change_nothing_in_the_figures_of_blocks(
    monkeypatch: pytest.MonkeyPatch, nodes_each: int
) -> None:
    grid = shell(split=3)
    monkeypatch.setattr(threads, "NODES_EACH", nodes_each)
    single, *several = [], [], []
    for count, figures in zip((1, 2, 3), (single, *several), strict=True):
        with limited_to(count):
            quality = measure(grid, percentiles=True)
            figures += [quality, block_figures(grid, quality)]
    assert several == [single, single]


def test_growth_of_volumes_has_its_percentile() -> None:
    nodes = lattice((0, 5, 9), (0, 4, 8), (0, 6, 7))
    nodes = nodes + np.random.default_rng(0).uniform(-0.2, 0.2, nodes.shape)
    every = np.concatenate([ratios(np.moveaxis(nodes, axis, 0)).ravel() for axis in range(3)])
    lines = block_figures(Grid.from_nodes(nodes)).lines
    assert lines.growth_inside.p99 == pytest.approx(np.percentile(every, 99), rel=1e-6)
    assert lines.growth_inside.mean < lines.growth_inside.p99 < lines.growth_inside.max
    assert lines.bend_inside.p99 > lines.bend_inside.mean


def test_growth_across_faces_is_found_where_blocks_meet() -> None:
    blocks = [lattice((0, 1, 3), (0, 1, 4), (0, 1, 4)), turned(lattice((1, 4, 3), (0, 1, 4), (0, 1, 4)), 9)]
    grid = joined(blocks, (Patch("wall", "west", 0, 3),))
    lines = block_figures(grid).lines
    assert lines.growth_inside.max == pytest.approx(1)
    assert lines.growth_across.max == pytest.approx(3)
    assert lines.growth_across.at == (0, 2, 1, 1)
    assert lines.by_wall["wall"].max == pytest.approx(3)
    assert lines.bend_across.max == pytest.approx(0, abs=1e-6)


def test_growth_and_bend_are_those_of_numpy() -> None:
    nodes = lattice((0, 5, 6), (0, 4, 5), (0, 6, 7))
    nodes = nodes + np.random.default_rng(0).uniform(-0.3, 0.3, nodes.shape)
    lines = block_figures(Grid.from_nodes(nodes)).lines
    every = []
    for axis, actual in enumerate((lines.growth.xi, lines.growth.eta, lines.growth.zeta)):
        step = np.diff(np.moveaxis(nodes, axis, 0), axis=0)
        length = np.linalg.norm(step, axis=-1)
        ratio = np.maximum(length[1:] / length[:-1], length[:-1] / length[1:])
        assert (actual.max, actual.mean) == (pytest.approx(ratio.max()), pytest.approx(ratio.mean()))
        at = [1, 1, 1]
        place = (
            list(np.moveaxis(ratio, 0, axis).shape)
            and np.argwhere(np.moveaxis(ratio, 0, axis) == ratio.max())[0]
        )
        place[axis] += at[axis]
        assert actual.at == (0, *place)
        cosine = (step[1:] * step[:-1]).sum(axis=-1) / (length[1:] * length[:-1])
        every.append(np.degrees(np.arccos(cosine)).ravel())
    assert lines.bend_inside.max == pytest.approx(np.concatenate(every).max())
    assert lines.bend_inside.mean == pytest.approx(np.concatenate(every).mean())


def test_nodes_are_counted_once() -> None:
    for grid in (shell(split=3), joined([pipe(inner=0.2)]), joined(sphere_patches())):
        points = np.concatenate([block.nodes.reshape(-1, 3) for block in grid.blocks])
        assert block_figures(grid).nodes == len(np.unique(points, axis=0))


def test_the_report_of_a_volume_is_json_with_both_tests_and_places_in_space() -> None:
    nodes = lattice((0, 4, 5), (0, 4, 5), (0, 4, 5))
    nodes[2, 2, 2] += [0, 0, 1.5]
    facts = json.loads(json.dumps(quality_report(Grid.from_nodes(nodes), "openfoam").as_dict()))
    assert (facts["form"], facts["folded"], facts["cells"], facts["sizes"]) == ("volume", 4, 64, [[5, 5, 5]])
    assert facts["bezier_folded"] >= facts["folded"]
    assert facts["worst_cells"][0] == {"i": 1, "j": 1, "k": 2, "x": 1.5, "y": 1.5, "z": 2.6875, "block": 0}
    assert "irregular" not in facts
    assert set(facts["growth"]) == {"xi", "eta", "zeta"}
    assert facts["quality"]["volume_ratio"]["p99"] > 1


def test_gates_name_what_volumes_have() -> None:
    report = quality_report(shell())
    broken = report.broken(
        parse_gates(["bezier_folded>=0", "volume_ratio>1", "deviation.mean<90", "folded>0"])
    )
    assert [line.split(" is")[0] for line in broken] == [
        "bezier_folded",
        "volume_ratio.max",
        "deviation.mean",
    ]
    with pytest.raises(InputError, match="this grid has no area_ratio; use folded, bezier_folded, max_angle"):
        report.broken(parse_gates(["area_ratio>2"]))
    with pytest.raises(InputError, match="this grid has no bezier_folded; use folded, max_angle"):
        quality_report(joined(sphere_patches())).broken(parse_gates(["bezier_folded>0"]))


def test_a_surface_is_reported_as_blocks_of_the_plane_are() -> None:
    report = quality_report(joined(sphere_patches(9)))
    figures = report.figures.blocks
    assert len(figures.irregular) == 8
    assert {cells for _, cells in figures.irregular} == {3}
    assert report.quality.folded == 0
    assert report.quality.bezier_folded is None
    assert figures.lines.growth_across.max == pytest.approx(1, abs=1e-12)


def test_volumes_are_compared_node_by_node() -> None:
    grid = shell()
    away = replace(grid, blocks=tuple(Block(block.nodes * [1, 1, 1.01]) for block in grid.blocks))
    difference = compare(away, grid)
    outer = max(float(np.abs(block.nodes[..., 2]).max()) for block in grid.blocks)
    assert difference.max == pytest.approx(0.01 * outer)
    assert len(difference.at) == 4
    every = np.concatenate([block.nodes.reshape(-1, 3) for block in grid.blocks])
    spread = np.sqrt((np.linalg.norm(every - every.mean(axis=0), axis=-1) ** 2).mean())
    assert difference.relative_l2 == pytest.approx(0.01 * np.sqrt((every[:, 2] ** 2).mean()) / spread)
    wall = np.concatenate([block.nodes[:, :, :1].reshape(-1, 3) for block in grid.blocks])
    assert difference.near_wall == pytest.approx(0.01 * np.sqrt((wall[:, 2] ** 2).mean()) / spread)
    assert difference.boundary == pytest.approx(difference.max)
    with pytest.raises(InputError, match="block 0 of 9x9x9 nodes is not comparable with one of 9x9x5"):
        compare(grid, shell(layers=4))


@pytest.mark.parametrize("k", [2, 4])
def test_a_coarser_volume_keeps_every_kth_node_patches_and_connections(k: int) -> None:
    grid = shell()
    coarse = coarser_grid(grid, k)
    assert [block.counts for block in coarse.blocks] == [(8 // k + 1,) * 3] * 6
    np.testing.assert_array_equal(coarse.blocks[2].nodes, grid.blocks[2].nodes[::k, ::k, ::k])
    assert len(coarse.connections) == 12
    assert [(p.name, p.start, p.stop, p.across) for p in coarse.outer_patches()][:1] == [
        ("wall", 0, 8 // k, (0, 8 // k))
    ]
    with pytest.raises(InputError, match="block 0: 9x9x9 nodes are 8x8x8 cells, which 3 does not divide"):
        coarser_grid(grid, 3)


def test_a_volume_at_unit_size_keeps_its_shape_and_connections() -> None:
    grid = shell()
    unit = normalised(grid)
    every = np.concatenate([block.nodes.reshape(-1, 3) for block in unit.blocks])
    assert every.min() == 0
    assert every.max() == pytest.approx(1)
    assert unit.connections == grid.connections
    assert block_figures(unit).deviation.max == pytest.approx(block_figures(grid).deviation.max)
    with pytest.raises(InputError, match="a volume has three directions to swap"):
        quarter_turn(grid)


def test_sides_without_names_are_called_by_them() -> None:
    assert [patch.name for patch in Grid.from_nodes(lattice(*[(0, 1, 3)] * 3)).patches] == [
        "south", "east", "north", "west", "bottom", "top",
    ]  # fmt: skip
