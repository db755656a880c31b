import itertools
import struct
from pathlib import Path

import numpy as np
import pytest
import vtk
from format_shapes import c_grid, channel, memory, ring
from vtk.util.numpy_support import vtk_to_numpy

from meshonet.formats.plot3d import sniff
from meshonet.formats.plot3d.read import read_grids
from meshonet.formats.registry import format_named
from meshonet.formats.source import Source, open_source
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid

RING, CHANNEL = ring(13, 7), channel(9, 6)


class File:
    """A Plot3D file as the format's page describes it, made independently of the reader.

    Parameters
    ----------
    blocks : coordinates (axes, ni, nj[, nk]) of each.
    counted : write the count of blocks.
    iblank : append an integer a node.
    """

    def __init__(self, *blocks: Floats, counted: bool = True, iblank: bool = False) -> None:
        self.blocks, self.counted, self.iblank = blocks, counted, iblank
        self.dims = [n for block in blocks for n in block.shape[1:]]

    def flags(self, block: Floats) -> list[int]:
        nodes = block[0].size
        return [k % 3 - 1 for k in range(nodes)] if self.iblank else []

    def text(self, *, per_line: int = 5, spelled: str = "{!r}", between: str = " ") -> bytes:
        lines = [str(len(self.blocks))] if self.counted else []
        lines.append(between.join(map(str, self.dims)))
        for block in self.blocks:
            words = [spelled.format(v) for a in block for v in a.ravel(order="F").tolist()]
            words += [str(flag) for flag in self.flags(block)]
            lines += [between.join(words[k : k + per_line]) for k in range(0, len(words), per_line)]
        return "\n".join(lines).encode() + b"\n"

    def binary(self, order: str = "<", size: int = 8, *, records: bool = False, split: bool = False) -> bytes:
        """Return C binary, or Fortran records: one a block, or with `split` one an array."""
        parts = [[struct.pack(f"{order}i", len(self.blocks))]] if self.counted else []
        parts.append([struct.pack(f"{order}{len(self.dims)}i", *self.dims)])
        for block in self.blocks:
            arrays = [a.ravel(order="F").astype(f"{order}f{size}").tobytes() for a in block]
            if self.iblank:
                arrays.append(np.array(self.flags(block), f"{order}i4").tobytes())
            parts += [[a] for a in arrays] if split else [arrays]
        joined = [b"".join(part) for part in parts]
        if not records:
            return b"".join(joined)
        return b"".join(
            struct.pack(f"{order}i", len(p)) + p + struct.pack(f"{order}i", len(p)) for p in joined
        )


def flat(grid: Grid) -> Floats:
    """(2, ni, nj) coordinates of a plane grid."""
    return np.stack([grid.x, grid.y])


def solid(grid: Grid, planes: int = 1, axis: int = 2, coordinate: int = 2) -> Floats:
    """(3, n1, n2, n3) with the planes along index `axis`, the span in `coordinate`."""
    arrays = [np.stack([c] * planes, axis) for c in (grid.x, grid.y)]
    arrays.insert(coordinate, np.stack([np.full(grid.x.shape, 0.5 * k) for k in range(planes)], axis))
    return np.stack(arrays)


def only(data: bytes) -> Grid:
    (grid,) = read_grids(memory(data, "g"))
    return grid


LAYOUTS = list(itertools.product((True, False), (False, True)))


@pytest.mark.parametrize(("counted", "iblank"), LAYOUTS)
@pytest.mark.parametrize("axes", [2, 3])
def test_text_with_and_without_count_and_iblank(axes: int, counted: bool, iblank: bool) -> None:
    for grid in (RING, CHANNEL):
        block = flat(grid) if axes == 2 else solid(grid)
        assert np.array_equal(only(File(block, counted=counted, iblank=iblank).text()).nodes, grid.nodes)


@pytest.mark.parametrize(("counted", "iblank"), LAYOUTS)
@pytest.mark.parametrize(("records", "split"), [(False, False), (True, False), (True, True)])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("size", [4, 8])
@pytest.mark.parametrize("axes", [2, 3])
def test_binary_of_every_kind(
    axes: int, size: int, order: str, records: bool, split: bool, counted: bool, iblank: bool
) -> None:
    for grid in (RING, CHANNEL):
        file = File(flat(grid) if axes == 2 else solid(grid), counted=counted, iblank=iblank)
        data = file.binary(order, size, records=records, split=split)
        back = only(data)
        assert np.array_equal(back.nodes, grid.nodes.astype(f"f{size}"))
        assert back.topology == grid.topology
        assert sniff(data)


@pytest.mark.parametrize("coordinate", range(3))
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("planes", [1, 2])
def test_planes_in_any_direction(planes: int, axis: int, coordinate: int) -> None:
    file = File(solid(RING, planes, axis, coordinate))
    for data in (file.text(), file.binary(), file.binary(">", records=True)):
        back = only(data)
        assert np.array_equal(np.sort(back.nodes.reshape(-1)), np.sort(RING.nodes.reshape(-1)))
        assert (back.nodes.shape, back.topology) == (RING.nodes.shape, "o")


def test_records_of_one_plane_each() -> None:
    block = solid(RING, 2)
    planes = [b"".join(a[..., k].ravel(order="F").tobytes() for a in block) for k in range(2)]
    parts = [struct.pack("<3i", *block.shape[1:]), *planes]
    data = b"".join(struct.pack("<i", len(p)) + p + struct.pack("<i", len(p)) for p in parts)
    assert np.array_equal(only(data).nodes, RING.nodes)


@pytest.mark.parametrize("iblank", [False, True])
def test_several_blocks_are_several_grids(iblank: bool) -> None:
    file = File(flat(RING), flat(CHANNEL), flat(RING), iblank=iblank)
    for data in (file.text(), file.binary(), file.binary(size=4), file.binary(">", records=True, split=True)):
        grids = list(read_grids(Source("wing.xyz", data=data)))
        assert [grid.name for grid in grids] == ["wing-1", "wing-2", "wing-3"]
        assert [grid.topology for grid in grids] == ["o", "quad", "o"]
        assert np.allclose(grids[1].nodes, CHANNEL.nodes, atol=1e-6)


def test_a_left_handed_block_becomes_right_handed() -> None:
    back = only(File(flat(CHANNEL)[:, ::-1]).text())
    assert np.array_equal(back.nodes, CHANNEL.nodes)


def test_commas_exponents_with_d_and_one_number_a_line() -> None:
    file = File(flat(CHANNEL))
    assert np.array_equal(only(file.text(between=" , ")).nodes, CHANNEL.nodes)
    assert np.array_equal(only(file.text(per_line=1)).nodes, CHANNEL.nodes)
    assert np.array_equal(only(file.text(per_line=10**6)).nodes, CHANNEL.nodes)
    with_d = file.text(spelled="{:.16e}").replace(b"e", b"D")
    assert b"D-01" in with_d
    assert np.array_equal(only(with_d).nodes, CHANNEL.nodes)
    assert np.array_equal(only(with_d.replace(b"\n", b"\r\n")).nodes, CHANNEL.nodes)


def test_repeats_even_in_the_dims_and_exponents_of_three_digits() -> None:
    s = " ".join(["0", "1", "2"] * 3)
    data = f"2*1 2*3 {s.replace(' ', ',')}\n3*0.0d0 3*1. 3*0.2+001, 9*1.5-103\n".encode()
    assert np.array_equal(only(data).nodes[:, :, 0], np.repeat([[0.0], [1.0], [2.0]], 3, axis=1))
    assert only(data).nodes[0, :, 1].tolist() == [0.0, 1.0, 2.0]


def test_dims_may_be_spread_over_lines() -> None:
    data = File(flat(CHANNEL)).text().replace(b"9 6\n", b"9\n\n 6\n")
    assert np.array_equal(only(data).nodes, CHANNEL.nodes)


def vtk_blocks(path: Path, **settings: int) -> list[Floats]:
    """Return points (n, 3) of each block as VTK's reader sees them."""
    reader = vtk.vtkMultiBlockPLOT3DReader()
    reader.SetXYZFileName(str(path))
    reader.SetAutoDetectFormat("BinaryFile" not in settings)
    for name, value in settings.items():
        getattr(reader, f"Set{name}")(value)
    reader.Update()
    blocks = reader.GetOutput()
    return [vtk_to_numpy(blocks.GetBlock(k).GetPoints().GetData()) for k in range(blocks.GetNumberOfBlocks())]


@pytest.mark.parametrize("several", [False, True])
@pytest.mark.parametrize("name", ["plot3d:binary", "plot3d:fortran"])
def test_vtk_reads_what_we_write_without_being_told(name: str, several: bool, tmp_path: Path) -> None:
    grids = [RING, CHANNEL, c_grid()] if several else [CHANNEL]
    writer = format_named(name).write_grids
    assert writer is not None
    writer(tmp_path / "g", grids)
    seen = vtk_blocks(tmp_path / "g")
    assert len(seen) == len(grids)
    for points, grid in zip(seen, grids, strict=True):
        assert points.dtype == np.float64
        assert np.array_equal(points[:, 0], grid.x.ravel(order="F"))
        assert np.array_equal(points[:, 1], grid.y.ravel(order="F"))


def test_vtk_reads_our_text_when_told_its_layout(tmp_path: Path) -> None:
    writer = format_named("plot3d").write_grids
    assert writer is not None
    writer(tmp_path / "g", [RING, CHANNEL])
    seen = vtk_blocks(tmp_path / "g", BinaryFile=0, TwoDimensionalGeometry=1, MultiGrid=1)
    assert np.allclose(seen[1][:, 0], CHANNEL.x.ravel(order="F"), atol=1e-6)


@pytest.mark.parametrize("name", ["plot3d:binary", "plot3d:fortran"])
def test_vtk_reads_a_layer(name: str, tmp_path: Path) -> None:
    writer = format_named(name).write_grids
    assert writer is not None
    writer(tmp_path / "g", [extruded(RING, (0.0, 0.5))])
    (points,) = vtk_blocks(tmp_path / "g")
    assert len(points) == 2 * RING.ni * RING.nj
    assert sorted(set(points[:, 2].tolist())) == [0.0, 0.5]


def test_text_keeps_every_bit_of_a_thin_cell(tmp_path: Path) -> None:
    nodes = CHANNEL.nodes.copy()
    nodes[:, 1, 1] = nodes[:, 0, 1] + 2.0**-50
    writer = format_named("plot3d").write_grids
    assert writer is not None
    writer(tmp_path / "g.p3d", [Grid.from_nodes(nodes)])
    (back,) = read_grids(open_source(str(tmp_path / "g.p3d")))
    assert np.array_equal(back.nodes, nodes)
