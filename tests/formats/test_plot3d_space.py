"""Volumes and surfaces in Plot3D, with their maps and without, in every variant."""

import itertools
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from format_shapes import channel, memory
from surface_grids import SURFACES, leaf, shell, sphere
from test_nmf import face_nodes
from test_plot3d import File, vtk_blocks
from volume_grids import VOLUMES, box, c_volume, pipe, shifted, turned_sector

from meshonet.formats.output import whole_file
from meshonet.formats.plot3d import CHOICES
from meshonet.formats.plot3d.nmf import write_grids as write_nmf
from meshonet.formats.plot3d.read import read_grids
from meshonet.formats.plot3d.write import write_grids
from meshonet.formats.registry import format_named
from meshonet.formats.source import open_source
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.find_connections import order
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

Make = Callable[[], Grid]
SPACE = [*VOLUMES, *SURFACES]
PERIODIC = (shifted, turned_sector)


def written(path: Path, grid: Grid, words: str = "") -> Path:
    with whole_file(str(path)) as part:
        write_grids(part, [grid], options=frozenset(filter(None, words.split(","))))
    return path


def only(path: Path) -> Grid:
    (grid,) = read_grids(open_source(str(path)))
    return grid


def coordinates(grid: Grid) -> list[Floats]:
    """(3, ni, nj, nk) of every block."""
    solid = [block.nodes if block.nodes.ndim == 4 else block.nodes[:, :, None] for block in grid.blocks]
    return [np.moveaxis(nodes, -1, 0) for nodes in solid]


@pytest.mark.parametrize("words", ["", "span-i", "span-j", "binary,iblank", "fortran,big", "ascii,iblank"])
@pytest.mark.parametrize("make", SPACE)
def test_a_grid_comes_back_with_its_map(make: Make, words: str, tmp_path: Path) -> None:
    grid = make()
    back = only(written(tmp_path / "g.xyz", grid, words))
    for block, old in zip(back.blocks, grid.blocks, strict=True):
        if words == "span-j" and make in VOLUMES:  # left-handed in the file
            assert sorted(block.counts) == sorted(old.counts)
            continue
        nodes = np.moveaxis(block.nodes, 0, 2) if words == "span-i" and make in VOLUMES else block.nodes
        if make in PERIODIC:  # whose motion is what the nodes say, to rounding
            np.testing.assert_allclose(nodes, old.nodes, rtol=0, atol=1e-13)
        else:
            assert np.array_equal(nodes, old.nodes)
    assert len(back.connections) == len(grid.connections)
    outer = [patch for patch in grid.patches if patch.kind != "interface"]
    assert {(p.name, p.kind) for p in outer} <= {(p.name, p.kind) for p in back.patches}
    if not words.startswith("span"):
        without = [(c.block, c.side, c.range, c.donor, c.donor_side, c.donor_range) for c in grid.connections]
        again = [(c.block, c.side, c.range, c.donor, c.donor_side, c.donor_range) for c in back.connections]
        assert sorted(again) == sorted(without)
        for patch in outer:
            assert patch in back.patches or patch.across is None
    assert ("iblank" in words) == ("iblank" in back.provenance)


@pytest.mark.parametrize("make", [make for make in SPACE if make not in PERIODIC])
def test_without_a_map_connections_are_found(make: Make, tmp_path: Path) -> None:
    grid = make()
    path = written(tmp_path / "g.xyz", grid, "binary")
    path.with_suffix(".nmf").unlink()
    back = only(path)
    assert sorted(back.connections, key=order) == sorted(grid.connections, key=order)


@pytest.mark.parametrize("make", SPACE)
def test_the_map_joins_equal_nodes_in_the_order_that_it_says(make: Make, tmp_path: Path) -> None:
    grid = make()
    write_nmf(tmp_path / "g.nmf", [grid])
    lines = [line.split() for line in (tmp_path / "g.nmf").read_text().splitlines() if line[0] != "#"]
    count = int(lines[0][0])
    dims = [[int(word) for word in line[1:]] for line in lines[1 : count + 1]]
    blocks = coordinates(grid)
    assert dims == [list(block.shape[1:]) for block in blocks]
    faces = 0
    for kind, *words in lines[count + 1 :]:
        numbers = [int(word) for word in words if word not in ("TRUE", "FALSE")]
        ends = [numbers[k : k + 6] for k in range(0, len(numbers), 6)]
        own, *donor = (face_nodes(end, dims[end[0] - 1]) for end in ends)
        faces += len(ends)
        if not donor:
            continue
        (there,) = donor
        if words[-1] == "TRUE":  # the donor's second range runs as the first one of the own face
            width = abs(ends[1][5] - ends[1][4]) + 1
            there = [there[k] for n in range(width) for k in range(n, len(there), width)]
        assert len(own) == len(there)
        if kind == "ONE_TO_ONE":
            for here, place in zip(own, there, strict=True):
                first = blocks[ends[0][0] - 1][(slice(None), *(n - 1 for n in here))]
                second = blocks[ends[1][0] - 1][(slice(None), *(n - 1 for n in place))]
                assert np.array_equal(first, second)
    assert faces == len(grid.outer_patches()) + 2 * len(grid.connections)


VARIANTS = [",".join(row) for row in itertools.product(*(CHOICES[k] for k in (0, 1, 3)))]


@pytest.mark.parametrize("make", [box, leaf])
@pytest.mark.parametrize("words", VARIANTS)
def test_every_variant_is_as_the_page_of_the_format_has_it(words: str, make: Make, tmp_path: Path) -> None:
    grid = make()
    (block,) = coordinates(grid)
    file = File(block, counted="single" not in words, iblank="no-iblank" not in words)
    for order_, size in itertools.product("<>", (4, 8)):
        if words.startswith("ascii"):
            data = file.text()
        else:
            data = file.binary(order_, size, records=words.startswith("fortran"))
        (back,) = read_grids(memory(data, "g"))
        kind = np.float64 if words.startswith("ascii") else f"f{size}"
        assert np.array_equal(back.blocks[0].nodes, grid.blocks[0].nodes.astype(kind))
        kinds = f"{'big' if order_ == '>' else 'little'},float{8 * size}"
        path = written(tmp_path / "g.bin", grid, words if words.startswith("ascii") else f"{words},{kinds}")
        if file.iblank:
            again = only(path)
            assert again.provenance["iblank"] == {"1": grid.blocks[0].nodes.size // 3}
        elif not words.startswith("ascii"):
            assert path.read_bytes() == data


@pytest.mark.parametrize("split", ["planes", "arrays"])
@pytest.mark.parametrize("nk", [3, 6])
def test_records_of_a_plane_or_of_a_coordinate(split: str, nk: int) -> None:
    (block,) = coordinates(box())
    block = block[..., :nk]
    planes = [block[..., k] for k in range(nk)] if split == "planes" else [block[n : n + 1] for n in range(3)]
    records = [b"".join(a.ravel(order="F").tobytes() for a in arrays) for arrays in planes]
    head = struct.pack("<3i", *block.shape[1:])
    data = b"".join(struct.pack("<i", len(p)) + p + struct.pack("<i", len(p)) for p in (head, *records))
    (back,) = read_grids(memory(data, "g"))
    assert np.array_equal(back.blocks[0].nodes, np.moveaxis(block, 0, -1))


def test_planes_in_text_and_c_binary_are_read_when_they_are_told() -> None:
    (block,) = coordinates(box())
    planes = np.moveaxis(block, -1, 0)  # k, axis, i, j
    numbers = np.concatenate([a.ravel(order="F") for plane in planes for a in plane])
    record = format_named("plot3d:planes")
    assert record.read_grids is not None
    head = struct.pack("<3i", *block.shape[1:])
    text = " ".join(map(str, block.shape[1:])) + "\n" + " ".join(map(repr, numbers.tolist()))
    for data in (head + numbers.tobytes(), text.encode()):
        (back,) = record.read_grids(memory(data, "g"))
        assert np.array_equal(back.blocks[0].nodes, np.moveaxis(block, 0, -1))


@pytest.mark.parametrize("axis", range(3))
def test_a_surface_may_lie_along_any_index(axis: int) -> None:
    (block,) = coordinates(leaf())
    moved = np.moveaxis(block, 3, axis + 1)
    (back,) = read_grids(memory(File(moved).binary(), "g"))
    assert np.array_equal(back.blocks[0].nodes, leaf().blocks[0].nodes)


def test_left_handed_volumes_get_i_reversed_and_their_maps_too(tmp_path: Path) -> None:
    grid = pipe()
    mirrored = [block.nodes * (1.0, -1.0, 1.0) for block in grid.blocks]
    with whole_file(str(tmp_path / "g.bin")) as part:
        write_grids(part, [Grid((Block(nodes),)) for nodes in mirrored], options=frozenset({"binary"}))
    write_nmf(tmp_path / "g.nmf", [grid])
    back = only(tmp_path / "g.bin")
    for block, nodes in zip(back.blocks, mirrored, strict=True):
        assert np.array_equal(block.nodes, nodes[::-1])
    assert len(back.connections) == len(grid.connections)
    assert {p.name for p in back.patches} == {"inlet", "outlet", "wall"}


def test_volumes_that_do_not_touch_are_grids_and_patches_one_surface(tmp_path: Path) -> None:
    far = Grid((Block(box().blocks[0].nodes + 10.0),))
    surface = Grid((Block(leaf().blocks[0].nodes + 20.0), Block(leaf().blocks[0].nodes + 30.0)))
    with whole_file(str(tmp_path / "g.bin")) as part:
        write_grids(part, [pipe(), far, surface], options=frozenset({"binary"}))
    result = list(read_grids(open_source(str(tmp_path / "g.bin"))))
    assert [len(grid.blocks) for grid in result] == [5, 1, 2]


def test_a_plane_grid_beside_volumes_is_a_surface(tmp_path: Path) -> None:
    with whole_file(str(tmp_path / "g.bin")) as part:
        write_grids(part, [box(), channel()], options=frozenset({"binary"}))
    volume, surface = read_grids(open_source(str(tmp_path / "g.bin")))
    assert volume.blocks[0].nodes.shape == (5, 4, 6, 3)
    assert surface.blocks[0].nodes.shape == (7, 5, 3)


@pytest.mark.parametrize("make", [pipe, c_volume, sphere, shell])
@pytest.mark.parametrize("name", ["plot3d:binary", "plot3d:fortran"])
def test_vtk_reads_what_we_write_without_being_told(name: str, make: Make, tmp_path: Path) -> None:
    writer = format_named(name).write_grids
    assert writer is not None
    writer(tmp_path / "g", [make()])
    seen = vtk_blocks(tmp_path / "g")
    for points, block in zip(seen, coordinates(make()), strict=True):
        assert np.array_equal(points, np.stack([a.ravel(order="F") for a in block], axis=-1))


def test_vtk_reads_our_text(tmp_path: Path) -> None:
    write_grids(tmp_path / "g", [pipe()])
    seen = vtk_blocks(tmp_path / "g", BinaryFile=0, MultiGrid=1)
    for points, block in zip(seen, coordinates(pipe()), strict=True):
        assert np.allclose(points, np.stack([a.ravel(order="F") for a in block], axis=-1), atol=1e-6)


def test_z_needs_three_coordinates(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nodes of a grid in space have z; leave the word 2d out"):
        write_grids(tmp_path / "g", [box()], options=frozenset({"2d"}))
