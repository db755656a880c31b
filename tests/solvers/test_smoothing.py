"""Given grids of blocks are smoothed across their interfaces, keep their spacing, and never become worse."""

from dataclasses import replace

import numpy as np
import pytest
from block_grids import between, butterfly, duct, joined, o_ring, turned

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.from_grid import layout_of
from meshonet.geometry.quality.blocks import block_figures
from meshonet.geometry.quality.checkmesh import faces
from meshonet.geometry.quality.measure import measure
from meshonet.solvers.refinement.refine import refined
from meshonet.solvers.smoothing.smooth import smooth
from meshonet.solvers.smoothing.wanted_lengths import thin_heights, wanted_lengths
from meshonet.solvers.solution import Outcome


def worst(grid: Grid) -> tuple[float, float, float]:
    result = faces(grid)
    assert result.non_orthogonality
    assert result.face_skewness
    return result.non_orthogonality.max, result.face_skewness.max, block_figures(grid).deviation.mean


def nozzle(first: float = 0.01) -> Grid:
    """Two blocks along a bent duct, the second one turned, with layers at the floor."""
    steps = 1.3 ** np.arange(14)
    t = np.concatenate([[0.0], np.cumsum(first * steps)])
    t = t / t[-1]
    x = np.linspace(0.0, 4.0, 33)
    floor = np.stack([x, 0.2 * np.maximum(0.0, x - 2.0)], axis=-1)
    roof = np.stack([x, np.full_like(x, 2.5)], axis=-1)
    nodes = floor[:, None] + t[None, :, None] * (roof - floor)[:, None]
    nodes[:, 0], nodes[:, -1] = floor, roof
    names = {0.0: "inlet", 4.0: "outlet"}
    return joined(
        [nodes[:17], turned(nodes[16:], 1)],
        lambda side: names.get(float(np.ptp(side[:, 0]) or side[0, 0]), "wall"),
    )


def heights(grid: Grid, like: Grid) -> Floats:
    """Heights of the first cells that are thin, and thinner than 0.05, in a grid of the same blocks."""
    mesh = layout_of(like).mesh
    of = thin_heights(mesh) & (mesh.edge_lengths < 0.05)
    return layout_of(grid).mesh.edge_lengths[of]


@pytest.mark.parametrize("slide", [False, True])
@pytest.mark.parametrize("make", [butterfly, nozzle, lambda: duct(1, bend=0.3), o_ring])
def test_no_face_and_no_mean_angle_becomes_worse(make: type[Grid], slide: bool) -> None:
    grid = make()
    made = smooth(grid, slide=slide).grid
    assert measure(made).folded == 0
    for after, before in zip(worst(made), worst(grid), strict=True):
        assert after <= max(before, 0.05) + 1e-6
    assert [p.name for p in made.patches] == [p.name for p in grid.patches]
    assert made.connections == grid.connections


def test_a_butterfly_loses_the_kinks_of_its_core() -> None:
    before, after = worst(butterfly(13, 9)), worst(smooth(butterfly(13, 9)).grid)
    assert after[0] < 0.4 * before[0]
    assert after[1] < 0.7 * before[1]
    assert after[2] < 0.6 * before[2]


def test_nodes_of_the_boundary_stay_bitwise_unless_they_slide() -> None:
    grid = nozzle()
    kept, slid = smooth(grid).grid, smooth(grid, slide=True).grid
    for patch in grid.outer_patches():
        np.testing.assert_array_equal(kept.face(patch.block, patch.side), grid.face(patch.block, patch.side))
    floor = next(p for p in grid.outer_patches() if p.name == "wall" and p.block == 0)
    moved = slid.face(0, floor.side)
    assert not np.array_equal(moved, grid.face(0, floor.side))
    assert np.ptp(moved[:, 1]) < 1e-12


def test_first_cells_of_layers_keep_their_heights() -> None:
    grid = nozzle()
    np.testing.assert_allclose(heights(smooth(grid).grid, grid), heights(grid, grid), rtol=1e-7)
    assert len(heights(grid, grid)) > 30
    growth = block_figures(smooth(grid).grid).lines.leaving
    assert growth is not None
    assert growth.p99 is not None
    assert growth.p99 < 1.45  # of 1.3


def test_a_ring_with_layers_is_its_own_optimum() -> None:
    solution = smooth(o_ring(n=13, m=16))
    for block, before in zip(solution.grid.blocks, o_ring(n=13, m=16).blocks, strict=True):
        np.testing.assert_allclose(block.nodes, before.nodes, atol=1e-3)
    assert solution.outcome is Outcome.DONE


def test_jumps_between_blocks_are_evened_out_where_the_boundary_may_slide() -> None:
    x = np.concatenate([np.linspace(0.0, 2.0, 9), np.linspace(2.0, 3.0, 17)[1:]])
    side = np.stack([x, np.zeros_like(x)], axis=-1)
    nodes = between(side, side + np.array([0.0, 1.0]), 9)
    grid = joined([nodes[:9], turned(nodes[8:], 3)], lambda _: "wall")
    before, after = (
        block_figures(each).lines.growth_across for each in (grid, smooth(grid, slide=True).grid)
    )
    assert before is not None
    assert after is not None
    assert before.max == pytest.approx(4.0)
    assert after.max < 1.6


def test_lengths_change_only_where_neighbours_differ_by_more_than_asked() -> None:
    mesh = layout_of(o_ring(m=9, growth=1.25)).mesh
    np.testing.assert_allclose(wanted_lengths(mesh, 1.3, slide=True), mesh.edge_lengths)
    evened = wanted_lengths(mesh, 1.1, slide=True)
    assert np.abs(np.log(evened / mesh.edge_lengths)).max() > 0.05


def test_folded_blocks_are_unfolded() -> None:
    grid = duct(0, ni=9, nj=7)
    nodes = grid.blocks[0].nodes.copy()
    nodes[4, 3] += (0.7, 0.3)
    folded = Grid((Block(nodes), grid.blocks[1]), grid.patches, grid.connections)
    assert measure(folded).folded > 0
    assert measure(smooth(folded).grid).folded == 0


def test_refined_blocks_have_the_old_nodes_among_the_new() -> None:
    grid = butterfly()
    fine = refined(grid, 2)
    for block, before in zip(fine.blocks, grid.blocks, strict=True):
        np.testing.assert_array_equal(block.nodes[::2, ::2], before.nodes)
    assert measure(fine).cells == 4 * measure(grid).cells
    assert measure(fine).folded == 0
    ends = [sum(p.stop - p.start for p in each.outer_patches()) for each in (fine, grid)]
    assert ends[0] == 2 * ends[1]


def test_a_connection_of_a_part_of_a_side_cannot_be_refined() -> None:
    x, y = np.meshgrid(np.arange(9.0), np.arange(5.0), indexing="ij")
    low, high = np.stack([x, y], axis=-1), np.stack([x + 3, y + 4], axis=-1)
    joint = Connection(0, "north", ((3, 8),), 1, "south", ((0, 5),), (1,))
    grid = Grid((Block(low), Block(high)), (), (joint,))
    with pytest.raises(InputError, match="joins parts of sides, and blocks are refined side by side"):
        refined(grid, 2)
    bent = replace(grid, blocks=tuple(Block(b.nodes + 0.1 * np.sin(b.nodes[..., ::-1])) for b in grid.blocks))
    assert measure(smooth(bent).grid).folded == 0
