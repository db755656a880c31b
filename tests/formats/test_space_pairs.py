"""Volumes and surfaces from any format that keeps blocks through any other, and by ten lines of h5py."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from surface_grids import SURFACES, sheet
from volume_grids import VOLUMES, box, pipe, shifted, turned_sector

from meshonet.formats.registry import format_named, read_grids
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.find_connections import order
from meshonet.geometry.blocks.grid import Grid

Make = Callable[[], Grid]
KEPT = ["hdf5", "vtm", "cgns", "plot3d:binary", "plot3d"]
EXACT = [make for make in (*VOLUMES, *SURFACES) if make not in (shifted, turned_sector)]


def through(name: str, grid: Grid, folder: Path) -> Grid:
    record = format_named(name)
    folder.mkdir(parents=True)
    path = folder / f"grid{record.suffixes[0]}"
    assert record.write_grids is not None
    record.write_grids(path, [grid])
    (back,) = read_grids(str(path), name)
    return back


def message(grid: Grid) -> set[tuple[object, ...]]:
    """What patches are, those inside left out, which Plot3D's maps do not name."""
    outer = [patch for patch in grid.patches if patch.kind != "interface"]
    sides = [grid.blocks[patch.block].face(patch.side).shape[:-1] for patch in outer]
    return {
        (p.name, p.kind, p.block, p.side, p.range(counts)) for p, counts in zip(outer, sides, strict=True)
    }


def sorted_connections(grid: Grid) -> list[Connection]:
    return sorted((replace(each, transform=None) for each in grid.connections), key=order)


@pytest.mark.parametrize("first", KEPT)
@pytest.mark.parametrize("make", EXACT)
def test_a_grid_goes_through_two_formats(make: Make, first: str, tmp_path: Path) -> None:
    grid = make()
    between = through(first, grid, tmp_path / "one")
    for second in KEPT:
        back = through(second, between, tmp_path / "two" / second.replace(":", "-"))
        for block, old in zip(back.blocks, grid.blocks, strict=True):
            assert np.array_equal(block.nodes.view(np.uint64), old.nodes.view(np.uint64)), second
        assert sorted_connections(back) == sorted_connections(grid), second
        assert message(grid) <= message(back), second
        if format_named(first).names_patches and format_named(second).names_patches:
            assert (message(back), back.name) == (message(grid), grid.name)


@pytest.mark.parametrize("make", [shifted, turned_sector])
@pytest.mark.parametrize("name", KEPT)
def test_periodic_sides_stay_periodic(name: str, make: Make, tmp_path: Path) -> None:
    grid = make()
    back = through(name, grid, tmp_path / "one")
    assert sorted_connections(back) == sorted_connections(grid)
    motions = {each.transform for each in back.connections if each.transform}
    assert len(motions) == 1
    for block, old in zip(back.blocks, grid.blocks, strict=True):
        np.testing.assert_allclose(block.nodes, old.nodes, rtol=0, atol=1e-13)


@pytest.mark.parametrize("make", [*EXACT, shifted, sheet])
def test_hdf5_keeps_everything_to_the_last_bit(make: Make, tmp_path: Path) -> None:
    grid = make()
    back = through("hdf5", grid, tmp_path / "one")
    assert (back.name, back.patches, back.connections) == (grid.name, grid.patches, grid.connections)
    assert dict(back.provenance) == dict(grid.provenance)
    for block, old in zip(back.blocks, grid.blocks, strict=True):
        assert np.array_equal(block.nodes, old.nodes)


def test_ten_lines_of_h5py_read_a_volume_and_its_connections(tmp_path: Path) -> None:
    through("hdf5", pipe(), tmp_path / "one")
    with h5py.File(tmp_path / "one" / "grid.h5") as file:
        blocks = [file[f"blocks/{k}"][0] for k in range(len(file["blocks"]))]  # (ni, nj, nk, 3)
        joined = json.loads(file.attrs["connections"])
        parts = json.loads(file["parts"][0])  # [name, side, start, stop, block, across, kind]
    place = {
        "west": (0, 0),
        "east": (0, -1),
        "south": (1, 0),
        "north": (1, -1),
        "bottom": (2, 0),
        "top": (2, -1),
    }
    for block, side, span, donor, face, donor_span, ways, _ in joined:
        own, other = (np.take(blocks[b], e, a) for b, (a, e) in ((block, place[side]), (donor, place[face])))
        own, other = (n[a : b + 1, c : d + 1] for n, ((a, b), (c, d)) in ((own, span), (other, donor_span)))
        other = other.transpose(abs(ways[0]) - 1, abs(ways[1]) - 1, 2)[
            :: np.sign(ways[0]), :: np.sign(ways[1])
        ]
        assert np.array_equal(own, other)
    assert len(joined) == len(pipe().connections)
    assert {row[0] for row in parts} == {"inlet", "outlet", "wall"}


def test_ten_lines_of_h5py_make_volumes(tmp_path: Path) -> None:
    grid = box()
    with h5py.File(tmp_path / "g.h5", "w") as file:
        file.attrs.update(format="meshonet-grid", version=2, connections="[]")
        file["blocks/0"] = np.stack([grid.nodes, grid.nodes + 1.0])
        file["parts"] = ['[["wall", "top", 0, 2, 0, [1, 3], "wall"]]', "[]"]
    first, second = read_grids(str(tmp_path / "g.h5"))
    assert np.array_equal(first.nodes, grid.nodes)
    assert np.array_equal(second.nodes, grid.nodes + 1.0)
    (patch,) = first.patches
    assert (patch.name, patch.side, patch.start, patch.stop, patch.across) == ("wall", "top", 0, 2, (1, 3))
