"""Passages of rows whose flow turns outwards or inwards: impellers, radial turbines, vaned diffusers."""

import re
from dataclasses import replace
from functools import cache, partial

import blade_row
import numpy as np
import pytest
import radial_rows

from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.checkmesh import faces
from meshonet.geometry.rows.row import Row
from meshonet.solvers.pipeline.result import Result
from meshonet.solvers.pipeline.rows import make_row
from meshonet.solvers.rows.request import RowRequest

FIRST = 1e-3
ROWS = {
    "impeller": partial(radial_rows.impeller, 4, gap=False),
    "turbine with a gap": partial(radial_rows.turbine, 5, gap=True),
    "impeller with a gap": partial(radial_rows.impeller, 20, gap=True),
    "diffuser": partial(radial_rows.diffuser, 7),
    "diffuser with a corner at its nose": partial(radial_rows.diffuser, 11),
    "turbine with an oblique base": partial(radial_rows.turbine, 13),
    "impeller with a thin flat edge and a gap": radial_rows.eckardt,
}
"""Functions that make a row, so that rows are not made while tests are collected."""
OTHERS = {
    "impeller of a long channel": partial(radial_rows.impeller, 76),
    "five times as wide at the inlet as at the outlet": partial(radial_rows.impeller, 144),
    "with a narrow edge cut at a slant": partial(radial_rows.pump, 26, gap=True),
}


@cache
def row_of(name: str) -> Row:
    return (ROWS | OTHERS)[name]()


@cache
def result_of(name: str) -> Result:
    return make_row(row_of(name), RowRequest(first_cell=FIRST, cells=100_000, threads=1))


def made(name: str) -> Grid:
    return result_of(name).grid


def nodes_of(grid: Grid, patch: str) -> np.ndarray:
    return np.concatenate([grid.at(each).reshape(-1, 3) for each in grid.patches if each.name == patch])


def from_curve(points: np.ndarray, curve: np.ndarray) -> np.ndarray:
    """Distances (n,) of points x, y, z from the surface that a curve of x and r describes."""
    p = np.stack([points[:, 0], np.hypot(points[:, 1], points[:, 2])], axis=1)
    start, way = curve[:-1], np.diff(curve, axis=0)
    part = np.clip(((p[:, None] - start) * way).sum(axis=-1) / (way**2).sum(axis=-1), 0.0, 1.0)
    return np.linalg.norm(start + part[..., None] * way - p[:, None], axis=-1).min(axis=1)


@pytest.mark.parametrize("name", ROWS)
def test_cells_are_valid(name: str) -> None:
    quality = result_of(name).quality
    assert quality.folded == 0
    assert quality["scaled_jacobian"].min > 0.2


@pytest.mark.parametrize("name", ROWS)
def test_hub_and_shroud_are_the_surfaces_of_their_curves(name: str) -> None:
    row = row_of(name)
    for patch, curve in (("hub", row.hub), ("shroud", row.shroud)):
        assert from_curve(nodes_of(made(name), patch), curve).max() < 1e-3 * row.chord


@pytest.mark.parametrize("name", ROWS)
def test_inlet_and_outlet_are_at_the_ends_of_the_curves(name: str) -> None:
    row = row_of(name)
    for patch, end in (("inlet", 0), ("outlet", -1)):
        line = np.stack([row.hub[end], row.shroud[end]])
        assert from_curve(nodes_of(made(name), patch), line).max() < 1e-9 * row.chord


@pytest.mark.parametrize("name", ROWS)
def test_first_cells_have_their_height_in_space_at_the_blade(name: str) -> None:
    assert blade_row.off_walls(made(name), "blade") == pytest.approx(FIRST * row_of(name).chord, rel=1e-9)


def test_first_cells_are_the_smallest_where_the_radius_is_small() -> None:
    grid = made("impeller")
    least = []
    for patch in grid.patches:
        if patch.name == "blade":
            steps = np.linalg.norm(np.diff(grid.blocks[patch.block].nodes, axis=patch.place[0]), axis=-1)
            least.append(float(steps.min()))
    assert min(least) > 0.5 * FIRST * row_of("impeller").chord


def test_cells_grow_by_the_limit_along_the_span_where_the_channel_is_wide() -> None:
    grid = made("five times as wide at the inlet as at the outlet")
    for block in grid.blocks:
        steps = np.linalg.norm(np.diff(block.nodes, axis=2), axis=-1)
        assert np.abs(np.log(steps[..., 1:] / steps[..., :-1])).max() < np.log(1.23)


def test_lines_along_the_span_lean_little_behind_the_blade() -> None:
    grid, row = made("impeller"), row_of("impeller")
    leaning = []
    for block in grid.blocks:
        steps = np.diff(block.nodes, axis=2)
        radius = np.hypot(block.nodes[:, :, :-1, 1], block.nodes[:, :, :-1, 2])
        behind = radius > 1.02 * max(np.hypot(each[:, 1], each[:, 2]).max() for each in row.profiles)
        along_axis = np.abs(steps[..., 0]) / np.linalg.norm(steps, axis=-1)  # the channel is radial there
        leaning.append(np.degrees(np.arccos(np.minimum(along_axis[behind], 1.0))))
    assert np.concatenate(leaning).max() < 60.0


def test_cells_behind_narrow_edges_in_a_gap_grow_little_across_the_outline_of_the_blade() -> None:
    result = result_of("with a narrow edge cut at a slant")
    grid = result.grid
    tips = {patch.block for patch in grid.patches if patch.name == "tip"}
    outline = [
        each for each in grid.connections
        if (each.block in tips) != (each.donor in tips) and each.side not in ("bottom", "top")
    ]  # fmt: skip

    def second(block: int, side: Side) -> np.ndarray:
        nodes = grid.blocks[block].nodes
        return np.moveaxis(nodes, PLACES[side][0], 0)[1 if PLACES[side][1] == 0 else -2]

    growth = []
    for each in outline:
        on = each.nodes(grid.face)
        inside, outside = (
            np.linalg.norm(a - b, axis=-1) for a, b in zip(each.nodes(second), on, strict=True)
        )
        growth.append(np.maximum(inside / outside, outside / inside).ravel())
    assert result.quality.folded == 0
    assert np.concatenate(growth).max() < 2.5


@pytest.mark.parametrize(
    ("name", "least"),
    [("impeller with a thin flat edge and a gap", 0.3), ("impeller of a long channel", 0.5)],
)
def test_lines_across_a_channel_that_is_longer_at_the_hub_lean_little_there(name: str, least: float) -> None:
    assert result_of(name).quality["scaled_jacobian"].min > least


def test_checkmesh_takes_the_faces_at_a_narrow_edge_cut_at_a_slant() -> None:
    grid = make_row(radial_rows.pump(82), RowRequest(first_cell=FIRST, cells=100_000, threads=1)).grid
    skewness = faces(grid).face_skewness
    assert skewness
    assert skewness.max < 4.0


@pytest.mark.parametrize("seed", [64, 72, 100])
def test_checkmesh_takes_first_cells_next_to_a_narrow_gap_off_blades_that_lean_far(seed: int) -> None:
    row = radial_rows.radial_row(seed)
    result = make_row(row, RowRequest(first_cell=FIRST, cells=100_000, threads=1))
    skewness = faces(result.grid).face_skewness
    assert skewness
    assert skewness.max < 4.0
    assert result.quality.folded == 0
    assert blade_row.off_walls(result.grid, "blade") == pytest.approx(FIRST * row.chord, rel=1e-9)


@pytest.mark.parametrize("seed", [2, 410])
def test_layers_that_would_fold_in_some_sections_get_thinner_gradually_along_the_span(seed: int) -> None:
    row = radial_rows.radial_row(seed)
    result = make_row(row, RowRequest(first_cell=FIRST, cells=100_000, threads=1))
    assert result.quality.folded == 0


def test_first_cells_at_the_shroud_are_exact_where_the_channel_narrows() -> None:
    row = radial_rows.radial_row(108)
    grid = make_row(row, RowRequest(first_cell=FIRST, cells=100_000, threads=1)).grid
    assert blade_row.off_walls(grid, "shroud") == pytest.approx(FIRST * row.chord, rel=1e-9)


def test_corners_of_a_flat_edge_are_nodes_at_all_heights() -> None:
    row = radial_rows.turbine(77)  # with a gap: places change along the span
    grid = make_row(row, RowRequest(first_cell=FIRST, cells=100_000, threads=1)).grid
    heights = np.linspace(0.0, row.channel.tip, 400)
    surfaces = [grid.at(each) for each in grid.patches if each.name == "blade"]
    nodes = np.concatenate([each.reshape(-1, 3) for each in surfaces])
    for corner in row.surface.corners:
        s, theta = row.surface.at(np.full((400, 1), corner), heights[:, None])[:, 0].T
        start, way = _pieces(row.channel.in_space(np.stack([s, theta, heights], axis=1)))
        part = np.clip(((nodes[:, None] - start) * way).sum(axis=-1) / (way**2).sum(axis=-1), 0.0, 1.0)
        away = np.linalg.norm(start + part[..., None] * way - nodes[:, None], axis=-1).min(axis=1)
        assert (away < 1e-5 * row.chord).sum() >= surfaces[0].shape[1]  # one at each level


def _pieces(curve: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return curve[:-1], np.diff(curve, axis=0)


@pytest.mark.parametrize("name", ROWS)
def test_layers_around_corners_grow_along_the_blade_as_at_wall_or_front(name: str) -> None:
    grid = made(name)
    ends, all_rows = [], []
    for patch in grid.patches:
        if patch.name == "blade":
            steps = np.linalg.norm(np.diff(grid.blocks[patch.block].nodes, axis=0), axis=-1)
            growth = np.abs(np.log(steps[1:] / steps[:-1]))
            ends.append(growth[:, [0, -1]].max())
            all_rows.append(growth.max())
    assert max(all_rows) < 1.02 * max(ends)


@pytest.mark.parametrize("unit", ["", "mm"])
def test_a_short_inlet_is_refused_with_the_length_that_it_lacks(unit: str) -> None:
    """A row whose hub and shroud are longer by what the message says is made."""
    row, request = replace(radial_rows.turbine(201), unit=unit), RowRequest(cells=20_000)
    words = r"begin so near .* no blocks fit before them; let both begin ([0-9.]+) ?(mm|) ?further upstream"
    with pytest.raises(InputError, match=words) as caught:
        make_row(row, request)
    length, named = re.search(words, str(caught.value)).groups()
    assert named == unit
    more = float(length) * (0.001 if unit else 1.0)
    walls = []
    for line in (row.hub, row.shroud):
        way = line[0] - line[1]
        walls.append(np.concatenate([[line[0] + more * way / np.hypot(*way)], line]))
    longer = make_row(replace(row, hub=walls[0], shroud=walls[1]), request)
    assert longer.quality.folded == 0
