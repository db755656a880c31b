"""From every format that is read to every one that is written and read again, nothing is lost."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from format_shapes import VARIANTS, c_grid, channel, ring
from many_blocks import MANY, by_block, sector

from meshonet.formats.registry import format_named, read_grids, read_shapes
from meshonet.formats.table import TABLE
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.find_connections import order
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch

EVERY = (*TABLE.values(), *map(format_named, VARIANTS))
BOTH_WAYS = [row.name for row in EVERY if row.write_grids and row.read_grids]
KEPT = [row.name for row in EVERY if row.blocks == "kept" and row.read_grids]
MERGED = [row.name for row in EVERY if row.blocks == "merged"]
MESHES = [row for row in EVERY if row.write_grids and row.read_shapes and row.name != "svg"]  # a picture
AS_BOUNDARIES = [row.name for row in MESHES if row.read_grids is None]


def through(name: str, grid: Grid, folder: Path) -> Path:
    record = format_named(name)
    folder.mkdir(exist_ok=True)
    path = folder / f"grid{record.suffixes[0]}"
    assert record.write_grids is not None
    record.write_grids(path, [grid])
    return path


@cache
def from_file(name: str, make: Callable[[], Grid]) -> Grid:
    """A grid that a file of a format holds, the same for all tests that write it again."""
    with TemporaryDirectory() as folder:
        (grid,) = read_grids(str(through(name, make(), Path(folder))), name)
    return grid


@pytest.mark.parametrize("make", [channel, ring, c_grid])
@pytest.mark.parametrize("first", BOTH_WAYS)
def test_a_grid_goes_through_two_formats_bit_for_bit(first: str, make: type[Grid], tmp_path: Path) -> None:
    grid, between = make(), from_file(first, make)
    for second in BOTH_WAYS:
        folder = tmp_path / second
        folder.mkdir()
        (back,) = read_grids(str(through(second, between, folder)), second)
        assert np.array_equal(back.nodes.view(np.uint64), grid.nodes.view(np.uint64)), second
        assert back.topology == grid.topology
        if format_named(first).names_patches and format_named(second).names_patches:
            assert (back.patches, back.name) == (grid.patches, grid.name)


def joints(grid: Grid) -> tuple[Connection, ...]:
    """Connections in their order, which files may change."""
    return tuple(sorted(grid.connections, key=order))


@pytest.mark.parametrize("make", MANY)
@pytest.mark.parametrize("first", KEPT)
def test_a_grid_of_many_blocks_goes_through_two_formats(
    first: str, make: Callable[[], Grid], tmp_path: Path
) -> None:
    grid, between = make(), from_file(first, make)
    for second in KEPT:
        folder = tmp_path / second
        folder.mkdir()
        (back,) = read_grids(str(through(second, between, folder)), second)
        for block, old in zip(back.blocks, grid.blocks, strict=True):
            if make is sector:  # the angle of which plot3d does not say
                np.testing.assert_allclose(block.nodes, old.nodes, rtol=0, atol=1e-14)
            else:
                assert np.array_equal(block.nodes.view(np.uint64), old.nodes.view(np.uint64)), second
        assert [replace(c, transform=None) for c in joints(back)] == [
            replace(c, transform=None) for c in joints(grid)
        ]
        assert make is sector or joints(back) == joints(grid)
        assert {(p.block, p.side, p.start, p.stop, p.name, p.kind) for p in grid.patches} <= {
            (p.block, p.side, p.start, p.stop, p.name, p.kind) for p in back.patches
        }
        if format_named(first).names_patches and format_named(second).names_patches:
            assert (by_block(back.patches), back.name) == (by_block(grid.patches), grid.name)


@pytest.mark.parametrize("second", MERGED)
@pytest.mark.parametrize("make", MANY)
def test_many_blocks_of_any_format_become_the_same_mesh(
    second: str, make: Callable[[], Grid], tmp_path: Path
) -> None:
    written = {}
    for first in KEPT:
        path = through(second, from_file(first, make), tmp_path / first)
        whole = path.parent / "constant" / "polyMesh" / "points" if second == "openfoam" else path
        written[first] = whole.read_bytes()
    plain = {name: len(data) for name, data in written.items()}
    assert len(set(plain.values())) == 1 or make is sector, plain


@pytest.mark.parametrize("second", AS_BOUNDARIES)
@pytest.mark.parametrize("make", [channel, ring])
def test_a_mesh_gives_the_boundary_of_its_grid_from_any_format(
    second: str, make: type[Grid], tmp_path: Path
) -> None:
    plain = [Patch(part.name.replace(" ", "-"), part.side, part.start, part.stop) for part in make().patches]
    grid = Grid.from_nodes(make().nodes, make().topology, tuple(plain), "plain")
    for first in BOTH_WAYS:
        folder = tmp_path / first
        (between,) = read_grids(str(through(first, grid, folder)), first)
        (back,) = read_shapes(str(through(second, between, folder)))
        assert isinstance(back, Boundary)
        assert np.array_equal(back.south, grid.nodes[:, 0])
        assert np.array_equal(back.north, grid.nodes[:, -1])
        if format_named(first).names_patches:
            assert {part for part in back.patches if part.name not in ("south", "north")} == set(plain)
