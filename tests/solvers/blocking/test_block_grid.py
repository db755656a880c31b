"""Domains in, valid grids of blocks out."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from known_meshes import circle
from planar_domains import blob, block_grid

from meshonet import infer
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.shapes.airfoil.naca import naca_points
from meshonet.solvers.blocking import block_grid as blocks
from meshonet.solvers.blocking.block_grid import cut_off, fine_layout
from meshonet.solvers.blocking.decomposition import decompose as decomposition
from meshonet.solvers.blocking.decomposition.collapse.collapse import irregular_inside
from meshonet.solvers.blocking.decomposition.collapse.score import largest_turning
from meshonet.solvers.blocking.decomposition.decompose import decompose

STEP = np.array([[0.0, 1], [3, 1], [3, 0], [12, 0], [12, 2], [0, 2]])


def rectangle(width, height):
    return np.array([[0.0, 0], [width, 0], [width, height], [0, height]])


def wing(points=60):
    """Return a symmetric wing section with a sharp edge, its chord from 0 to 1."""
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, points)))
    y = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    return np.concatenate([np.stack([x, y], axis=1)[::-1], np.stack([x, -y], axis=1)[1:-1]])


DOMAINS = {
    "step": ([STEP], 3, 0),
    "corner": ([np.array([[0.0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]])], 3, 0),
    "pipe": ([circle(1.0, 120)], 5, 4),
    "ring": ([circle(2.0, 120), circle(0.8, 60, (0.3, 0.1))], 1, 0),
    "cylinder in a channel": ([rectangle(2.2, 0.41), circle(0.05, 80, (0.2, 0.2))], 12, 4),
    "wing in a tunnel": ([rectangle(6, 3), wing() + np.array([2.0, 1.5])], 6, 0),
    "plate": ([rectangle(4, 2), circle(0.4, 80, (1, 1)), circle(0.4, 80, (3, 1))], 40, 8),
}
"""Loops, and the most blocks and irregular nodes that an engineer would want."""


def cells_of(grid: Grid) -> np.ndarray:
    """Return the signed areas of the corner triangles of all cells."""
    areas = []
    for block in grid.blocks:
        z = block.nodes[..., 0] + 1j * block.nodes[..., 1]
        corners = [z[:-1, :-1], z[1:, :-1], z[1:, 1:], z[:-1, 1:]]
        for k in range(4):
            u, v = corners[(k + 1) % 4] - corners[k], corners[k - 1] - corners[k]
            areas.append(0.5 * (np.conj(u) * v).imag.ravel())
    return np.concatenate(areas)


@pytest.mark.parametrize("name", DOMAINS)
def test_blocks_of_an_engineer(name: str) -> None:
    loops, blocks, irregular = DOMAINS[name]
    domain = Domain.of_polygons(loops)
    grid, layout = block_grid(domain, cells=1200)
    assert len(layout.blocks) <= blocks
    assert irregular_inside(layout.mesh) <= irregular
    assert layout.cells == pytest.approx(1200, rel=0.2)
    areas = cells_of(grid)
    assert areas.min() > 0
    assert 0.5 * areas.sum() == pytest.approx(domain.area, rel=2e-3)
    # every side of a block is either connected, once, or a patch, once
    cells = sum(2 * (block.counts[0] + block.counts[1] - 2) for block in grid.blocks)
    joined = sum(2 * (c.range[0][1] - c.range[0][0]) for c in grid.connections)
    assert joined + sum(patch.stop - patch.start for patch in grid.patches) == cells
    assert {patch.name for patch in grid.patches} == {"outer", "body", "body2"} & {
        name for loop in domain.loops for name in loop.names
    }
    for loop in domain.loops:  # its corners are nodes
        for corner in loop.curve.points[list(loop.corners)]:
            assert (layout.mesh.nodes == corner).all(axis=1).any()


def test_the_same_twice_bitwise() -> None:
    loops = DOMAINS["cylinder in a channel"][0]
    first, second = (block_grid(Domain.of_polygons(loops), cells=600)[0] for _ in range(2))
    for one, other in zip(first.blocks, second.blocks, strict=True):
        np.testing.assert_array_equal(one.nodes, other.nodes)


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_blocks_do_not_depend_on_the_unit(scale: float) -> None:
    domain = Domain.of_polygons([scale * STEP + 3 * scale])
    grid, layout = block_grid(domain, cells=300)
    assert (len(layout.blocks), irregular_inside(layout.mesh)) == (3, 0)
    assert 0.5 * cells_of(grid).sum() == pytest.approx(domain.area, rel=1e-9)


def test_one_layout_at_many_resolutions() -> None:
    layout = decompose(Domain.of_polygons(DOMAINS["pipe"][0]))
    for cells in (150, 1500, 15000):
        fine = fine_layout(layout, cells=cells)
        assert fine.cells == pytest.approx(cells, rel=0.2)
        assert len(fine.blocks) == len(layout.blocks)
    assert fine_layout(layout, cell_size=0.1).cells == pytest.approx(np.pi / 0.01, rel=0.3)


def test_another_attempt_where_one_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds = []
    result = decomposition.seamless_map

    def failing(domain, count, seed, fewer):
        seeds.append(seed)
        if seed < 2:
            raise SolverError("no map")
        return result(domain, count=count, seed=seed, fewer=fewer)

    monkeypatch.setattr(decomposition, "seamless_map", failing)
    assert len(decompose(Domain.of_polygons([STEP])).blocks) == 3
    assert seeds == [0, 1, 2]
    monkeypatch.setattr(decomposition, "ATTEMPTS", 2)
    with pytest.raises(SolverError, match="no blocks found in 2 attempts: no map"):
        decompose(Domain.of_polygons([STEP]))


def test_wall_nodes_come_closer_where_walls_bend_when_more_than_allowed_is_cut_off(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    domain = Domain.of_polygons([blob(2, 2.0), circle(0.4, 60, (-0.3, 0.1))])
    layout = decompose(domain)
    held = fine_layout(layout, cells=500)
    monkeypatch.setattr(blocks, "MOST_CUT_OFF", 1.0)
    free = fine_layout(layout, cells=500)
    assert held.cells == free.cells
    assert largest_turning(held.mesh) < 0.8 * largest_turning(free.mesh)
    assert abs(cut_off(held)) < 1e-3 < abs(cut_off(free))


def test_fine_cells_beside_a_flap_are_not_folded(tmp_path: Path) -> None:
    """Splines through the nodes of coarse cells cross at thin trailing edges."""
    wing, turn = naca_points("2412"), np.radians(-30)
    turned = wing @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    files = [str(tmp_path / name) for name in ("main.dat", "flap.dat")]
    for file, points in zip(files, (wing, 0.3 * turned + [1.0, -0.04]), strict=True):
        np.savetxt(file, points, header="section", comments="")
    grid = infer(files, assemble=True, cells=8000)
    assert grid.cells > blocks.OPTIMISED  # so it is refined from an optimised grid
    assert cells_of(grid).min() > 0


def test_nodes_caught_at_a_corner_of_a_wall_are_held_in_a_second_attempt(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    held, optimise = [], blocks.optimise

    def caught(mesh, **settings):
        held.append(settings.get("held"))
        optimum = optimise(mesh, **settings)
        return replace(optimum, valid=False) if len(held) == 1 else optimum

    monkeypatch.setattr(blocks, "optimise", caught)
    domain = Domain.of_polygons([blob(2, 2.0), circle(0.4, 60, (-0.3, 0.1))])
    fine = fine_layout(decompose(domain), cells=500)
    assert smallest_jacobians(fine.mesh.nodes, fine.mesh.quads).min() > 0
    assert held[0] is None
    assert held[1] is not None
    assert held[2] is None
    assert held[1][fine.mesh.places.loop >= 0].all()
    assert not held[1][fine.mesh.places.loop < 0].any()
