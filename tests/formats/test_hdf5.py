import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from format_shapes import c_grid, channel, memory, ring

import meshonet
from meshonet.formats.hdf5.check import Checked, opened
from meshonet.formats.hdf5.read import read_grids, read_shapes
from meshonet.formats.hdf5.write import write_boundaries, write_grids, writing
from meshonet.formats.mesh.recover_topology import boundary_of
from meshonet.formats.source import open_source
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid, Origin
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError


def written(path: Path, grids: list[Grid]) -> h5py.File:
    write_grids(path, grids)
    return h5py.File(path, "r")


def test_a_mistake_of_the_program_is_not_taken_for_damaged_data(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.h5", [channel()])
    source = open_source(str(tmp_path / "g.h5"))
    with pytest.raises(AttributeError), opened(source) as file:
        file.attrs.a_name_that_is_not_there  # noqa: B018
    with pytest.raises(InputError, match="HDF5 data is damaged"), opened(source) as file:
        file["not there"]


def test_grids_whose_edges_are_no_boundary_are_written_all_the_same(tmp_path: Path) -> None:
    """As those of a network that has learnt nothing, written by `infer --answer raw --allow-invalid`."""
    turned = Grid.from_nodes(channel().nodes * [-1.0, 1.0], "quad")
    with pytest.raises(InputError, match="clockwise"):
        boundary_of(turned)
    write_grids(tmp_path / "g.h5", [turned])
    (result,) = read_grids(open_source(str(tmp_path / "g.h5")))
    assert np.array_equal(result.nodes, turned.nodes)


def test_the_layout_is_the_documented_one(tmp_path: Path) -> None:
    grids = [ring(name=f"r{k}") for k in range(3)]
    with written(tmp_path / "g.h5", grids) as file:
        assert dict(file.attrs) == {"format": "meshonet-grid", "version": 1, "topology": "o"}
        shapes = {
            "south": (3, 13, 2),
            "north": (3, 13, 2),
            "west": (3, 5, 2),
            "east": (3, 5, 2),
            "nodes": (3, 13, 5, 2),
        }
        for name, shape in shapes.items():
            assert file[name].shape == shape
            assert file[name].dtype == np.float64
            assert file[name].maxshape == (None, *shape[1:])
            assert file[name].chunks[1:] == shape[1:]
            assert file[name].chunks[0] * 8 * np.prod(shape[1:]) <= 2**14, "small ones share a chunk"
        assert np.array_equal(file["nodes"][2], grids[2].nodes)
        assert np.array_equal(file["south"][1], grids[1].nodes[:, 0])
        assert file["names"].asstr()[:].tolist() == ["r0", "r1", "r2"]


def test_ten_lines_of_h5py_make_a_boundary_dataset(tmp_path: Path) -> None:
    t = np.linspace(0, 1, 5)
    with h5py.File(tmp_path / "b.h5", "w") as f:
        f.attrs.update(format="meshonet-boundary", version=1, topology="quad")
        f["south"] = np.stack([t, 0 * t], -1)[None]
        f["north"] = np.stack([t, 0 * t + 1], -1)[None]
        f["west"] = np.stack([0 * t[:3], t[::2]], -1)[None]
        f["east"] = np.stack([0 * t[:3] + 1, t[::2]], -1)[None]
    (boundary,) = read_shapes(open_source(str(tmp_path / "b.h5")))
    assert (boundary.ni, boundary.nj, boundary.topology) == (5, 3, "quad")


def test_provenance_is_kept_whole_and_can_be_read_by_eye(tmp_path: Path) -> None:
    facts = {
        "method": "winslow",
        "version": "0.1",
        "cycles": np.int64(4),
        "path": ["a", "b"],
        "residual": np.array([1.0]),
    }
    grid = channel().with_provenance(**facts)
    with written(tmp_path / "g.h5", [grid]) as file:
        assert file.attrs["method"] == "winslow"
        assert file.attrs["meshonet_version"] == "0.1"
        assert file.attrs["version"] == 1
    (back,) = read_grids(open_source(str(tmp_path / "g.h5")))
    assert back.provenance["cycles"] == 4
    assert back.provenance["residual"] == [1.0]


def test_samples_are_in_the_file_as_they_are_appended(tmp_path: Path) -> None:
    counts = []

    def grids() -> Iterator[Grid]:
        for k in range(4):
            yield ring(name=f"r{k}")
            counts.append(writer._count)

    with writing(tmp_path / "g.h5", "meshonet-grid") as writer:
        for grid in grids():
            writer.append(grid)
    assert counts == [1, 2, 3, 4]


def test_blocks_hold_each_sample_once_and_in_order(tmp_path: Path) -> None:
    big = np.stack(np.meshgrid(np.arange(300.0), np.arange(200.0), indexing="ij"), axis=-1)
    grids = [Grid.from_nodes(big + k, name=f"g{k}" if k != 2 else "", provenance={"k": k}) for k in range(7)]
    with written(tmp_path / "g.h5", grids) as file:
        assert file["nodes"].chunks[0] == 1, "large ones have a chunk each"
    back = list(read_grids(open_source(str(tmp_path / "g.h5"))))
    assert [grid.name for grid in back] == [grid.name for grid in grids]
    for one, other in zip(back, grids, strict=True):
        np.testing.assert_array_equal(one.nodes, other.nodes)
        assert one.provenance == other.provenance


def test_an_interrupted_dataset_has_what_was_appended(tmp_path: Path) -> None:
    def grids() -> Iterator[Grid]:
        yield ring(name="done")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_grids(tmp_path / "g.h5", grids())
    (back,) = read_grids(open_source(str(tmp_path / "g.h5")))
    assert back.name == "done"


def sampled(*values: float, split: str = "") -> Boundary:
    """Return a boundary made by the numbers height, width ..."""
    names = ("height", "width", "depth")
    return replace(boundary_of(channel()), origin=Origin(tuple(zip(names, values, strict=False)), split))


def test_parameters_and_split_go_with_the_samples(tmp_path: Path) -> None:
    written = [sampled(0.0, 0.0, split="train"), sampled(1.0, 2.5, split="test")]
    write_boundaries(tmp_path / "b.h5", written)
    back = list(read_shapes(open_source(str(tmp_path / "b.h5"))))
    assert [boundary.origin for boundary in back] == [boundary.origin for boundary in written]
    with h5py.File(tmp_path / "b.h5") as file:
        assert list(file["parameters"].attrs["names"]) == ["height", "width"]


def test_samples_of_one_name_are_numbered_once(tmp_path: Path) -> None:
    grid = meshonet.tfi("naca:2412", res=(21, 11))
    meshonet.write([grid, grid, replace(grid, name="NACA 2412-2"), grid], tmp_path / "g.h5")
    again = list(meshonet.read_all(tmp_path / "g.h5"))
    assert [one.name for one in again] == ["NACA 2412", "NACA 2412-2", "NACA 2412-2-2", "NACA 2412-3"]
    meshonet.write(again, tmp_path / "again.h5")
    assert [one.name for one in meshonet.read_all(tmp_path / "again.h5")] == [one.name for one in again]


def test_a_dataset_without_parameters_has_none(tmp_path: Path) -> None:
    write_boundaries(tmp_path / "b.h5", [boundary_of(channel())])
    (back,) = read_shapes(open_source(str(tmp_path / "b.h5")))
    assert back.origin == Origin()


def test_the_same_grids_give_the_same_bytes(tmp_path: Path) -> None:
    write_grids(tmp_path / "a.h5", [channel(), channel()])
    write_grids(tmp_path / "b.h5", [channel(), channel()])
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()


@pytest.mark.parametrize("other", [ring(14), c_grid(), ring(13, 6)])
def test_a_sample_of_another_size_or_topology_is_refused(other: Grid, tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"sample 1 is .* and the first is 13x5 o; one dataset has one size .*res"
    ):
        write_grids(tmp_path / "g.h5", [ring(), other])


def test_parameters_of_another_length_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"parameters of sample 1 has shape \(3,\); the first has \(2,\)"):
        write_boundaries(tmp_path / "b.h5", [sampled(1.0, 2.0), sampled(1.0, 2.0, 3.0)])


def changed(change: str) -> bytes:
    """Return a grid dataset after a line of code that spoils it."""
    raw = io.BytesIO()
    with h5py.File(raw, "w") as f:
        grid = channel()
        f.attrs.update(format="meshonet-grid", version=1, topology="quad")
        edges = boundary_of(grid)
        for side in ("south", "north", "west", "east"):
            f[side] = getattr(edges, side)[None]
        f["nodes"] = np.ascontiguousarray(grid.nodes)[None]
        f["names"] = ["a"]
        exec(change, {"f": f, "np": np, "h5py": h5py})  # noqa: S102
    return raw.getvalue()


SIDES = ("south", "north", "west", "east", "nodes")
EMPTY = f"for k in {SIDES}: s = f[k].shape; del f[k]; f[k] = np.zeros((0, *s[1:]))"
HUGE = "del f['nodes']; f.create_dataset('nodes', (1, 10**6, 10**6, 2), 'f8', chunks=(1, 100, 100, 2))"
ELSEWHERE = "del f['east']; f.create_dataset('east', (1, 5, 2), 'f8', external=[('/etc/passwd', 0, 80)])"
NEEDS_EAST = "has no dataset 'east'; store south, north, west and east"
CASES = {
    "del f.attrs['format']": "is HDF5 but not a dataset of boundaries or grids; set its",
    "f.attrs['version'] = 2": "has no blocks; store their nodes as blocks/0",
    "f.attrs['version'] = 3": "has layout version '3'; this program reads version 1",
    "f.attrs['topology'] = 'x'": "topology 'x' is not known; use quad, o or c",
    "del f['east']": NEEDS_EAST,
    "del f['nodes']": "has no dataset 'nodes'",
    "del f['east']; f.create_group('east')": NEEDS_EAST,
    "del f['east']; f['east'] = h5py.ExternalLink('/etc/passwd', '/')": NEEDS_EAST,
    "del f['east']; f['east'] = h5py.SoftLink('/east')": NEEDS_EAST,
    "del f['east']; f['east'] = np.zeros((1, 4, 2))": r"has shape \(1, 4, 2\); it must be \(1, 5, 2\)",
    "del f['east']; f['east'] = np.zeros((1, 5))": "'east' is float64 with 2 axes; store float64 with 3",
    "del f['east']; f['east'] = ['a']": "dataset 'east' is object with 1 axes",
    "del f['east']; f['east'] = np.full((1, 5, 2), np.nan)": "sample 0: east node 0 is not finite",
    "f['nodes'][0, 2, 3, 1] = np.inf": "sample 0: node i=2, j=3 has y = inf; check the file",
    "del f['names']; f['names'] = np.arange(3)": "dataset 'names' is not a list of texts; store strings",
    "f['parts'] = ['{']": r"sample 0: its parts are not a JSON list of \[name, side, start, stop\]; remove",
    "f['parts'] = ['[[\"a\", \"south\", 0, 99]]']": "sample 0: patch 'a' runs from node 0 to 99 of a side",
    "f['provenance'] = ['[1]']": "sample 0: provenance is not a JSON object; remove",
    "f['provenance'] = ['{']": "sample 0: .*; write the dataset again",
    "f['parameters'] = np.zeros((4, 2))": "'parameters' has another count than 'south'; give one",
    EMPTY: "holds no samples; write at least one",
    HUGE: r"dataset 'nodes' claims shape \(1, 1000000, 1000000, 2\) but holds next to nothing",
    ELSEWHERE: "dataset 'east' lies in another file; store it in this one",
}


@pytest.mark.parametrize("change", CASES)
def test_a_damaged_or_hostile_dataset_is_refused(change: str) -> None:
    def read(data: bytes) -> None:
        list(read_shapes(memory(data)))
        list(read_grids(memory(data)))

    read(changed("pass"))
    data = changed(change)
    with pytest.raises(InputError, match=CASES[change]):
        read(data)


def test_rows_are_read_alone_where_those_after_them_are_broken() -> None:
    class Broken:
        dtype, shape = np.dtype("f8"), (4, 2)

        def __getitem__(self, rows: slice) -> np.ndarray:
            if rows.stop > 2:
                raise OSError("cannot read row 2")
            return np.arange(8.0).reshape(4, 2)[rows]

    np.testing.assert_array_equal(Checked._rows_from(Broken(), 1), [[2.0, 3.0]])
    with pytest.raises(OSError, match="row 2"):
        Checked._rows_from(Broken(), 2)


def test_a_file_that_is_not_hdf5_is_refused() -> None:
    with pytest.raises(InputError, match=r"is not readable as HDF5 .*; check that the file is whole"):
        list(read_grids(memory(b"\x89HDF\r\n\x1a\nnothing")))


def test_names_from_a_file_cannot_act_on_a_terminal() -> None:
    (grid,) = read_grids(memory(changed("f['names'][0] = 'a\\x1b[2J'")))
    assert grid.name == "a\\x1b[2J"


def test_single_precision_and_big_endian_are_read() -> None:
    (grid,) = read_grids(memory(changed("n = f['nodes'][:]; del f['nodes']; f['nodes'] = n.astype('>f4')")))
    assert np.allclose(grid.nodes, channel().nodes, atol=1e-6)


def patched(at: int, new: bytes) -> bytes:
    """Return a good dataset with other bytes at one place."""
    data = bytearray(changed("pass"))
    data[at : at + len(new)] = new
    return bytes(data)


def test_a_heap_that_would_hold_the_library_for_ever_is_refused() -> None:
    heap = changed("pass").index(b"GCOL")
    for size in (0, 1, 2**63, 2**64 - 1):
        data = patched(heap + 16 + 8, size.to_bytes(8, "little"))
        with pytest.raises(InputError, match=f"byte {heap}: HDF5 data is damaged .a heap of texts.; write"):
            list(read_grids(memory(data)))
    free = patched(heap + 16, bytes(16))
    with pytest.raises(InputError, match="a heap of texts"):
        list(read_grids(memory(free)))


@pytest.mark.parametrize(
    "more", ["", "; del f['names']; f.create_dataset('names', (1,), h5py.string_dtype(), maxshape=(None,))"]
)
def test_a_text_that_would_take_all_memory_is_refused(more: str) -> None:
    data = changed(f"pass{more}; f['names'][0] = 'seven..'")
    descriptor = data.rindex((7).to_bytes(4, "little"))
    spoilt = data[:descriptor] + b"\xff" * 4 + data[descriptor + 4 :]
    with pytest.raises(InputError, match="dataset 'names' claims a text longer than the file; write"):
        list(read_grids(memory(spoilt)))


def two_blocks(shift: float = 0.0, name: str = "pair", turned: bool = False) -> Grid:
    """Two blocks whose east and west sides meet, the second one with its eta reversed when `turned`."""
    whole = channel(9, 5).nodes + shift
    first, second = whole[:5], whole[4:][:, ::-1] if turned else whole[4:]
    joint = Connection(0, "east", ((0, 4),), 1, "west", ((0, 4),), (-1 if turned else 1,))
    patches = (Patch("inlet", "west", 0, 4), Patch("slot", "south", 1, 3, block=1, kind="outlet"))
    return Grid(
        (Block(first), Block(second)), patches, (joint,), name, {"seed": 3}, Origin((("a", 1.5),), "train")
    )


def cube() -> Grid:
    """A block of three directions, periodic in the third."""
    nodes = np.stack(np.meshgrid(np.arange(3.0), np.arange(4.0), np.arange(2.0), indexing="ij"), axis=-1)
    motion = Motion((0.0, 0.0, 1.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    sides = ((0, 2), (0, 3))
    joint = Connection(0, "bottom", sides, 0, "top", sides, (1, 2), motion)
    return Grid((Block(nodes),), (Patch("part", "south", 0, 1, (0, 1)),), (joint,), "cube")


@pytest.mark.parametrize("turned", [False, True])
def test_grids_of_several_blocks_come_back_with_connections_and_patches(turned: bool, tmp_path: Path) -> None:
    grids = [two_blocks(k, f"pair {k}", turned) for k in range(3)]
    with written(tmp_path / "g.h5", grids) as file:
        assert (file.attrs["version"], "topology" in file.attrs, "south" in file) == (2, False, False)
        assert file["blocks/0"].shape == file["blocks/1"].shape == (3, 5, 5, 2)
    back = list(read_grids(open_source(str(tmp_path / "g.h5"))))
    for one, other in zip(back, grids, strict=True):
        for result, block in zip(one.blocks, other.blocks, strict=True):
            np.testing.assert_array_equal(result.nodes, block.nodes)
        assert (one.patches, one.connections, one.name) == (other.patches, other.connections, other.name)
        assert (one.provenance, one.origin) == (other.provenance, other.origin)


def test_a_block_in_space_comes_back_with_its_periodic_connection(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.h5", [cube()])
    (back,) = read_grids(open_source(str(tmp_path / "g.h5")))
    np.testing.assert_array_equal(back.blocks[0].nodes, cube().blocks[0].nodes)
    assert (back.connections, back.patches) == (cube().connections, cube().patches)


def test_samples_of_other_blocks_or_connections_are_refused(tmp_path: Path) -> None:
    open_pair = replace(two_blocks(), connections=())
    for other, problem in (
        (cube(), r"sample 1 is blocks of 3x4x2x3 and the first is blocks of 5x5x2, 5x5x2"),
        (open_pair, "the first is connected otherwise"),
        (channel(), "sample 1 is 7x5 quad and the first is blocks of 5x5x2"),
    ):
        with pytest.raises(InputError, match=problem):
            write_grids(tmp_path / "g.h5", [two_blocks(), other])


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ("del f['blocks/0']", "has no dataset 'blocks/0'"),
        ("del f['blocks']; f['blocks'] = h5py.ExternalLink('/etc/passwd', '/')", "has no blocks"),
        ("f.attrs['connections'] = '[[0]]'", "its connections are not those of blocks"),
        ("f.attrs['connections'] = '{'", "its connections are not those of blocks"),
        ("f['blocks/1'][0, 0, 2] += 1", "east of block 0 to west of block 1 is open"),
        ("f['blocks/1'][0, 0, 2] = np.nan", "node i=0, j=2 has x = nan"),
        ("s = f['blocks/1'][:]; del f['blocks/1']; f['blocks/1'] = s[[0, 0]]", "different counts of samples"),
        ("f['parts'][0] = '[[\"a\", \"south\", 0, 1, 7]]'", "patch 'a' is on block 7 of 2"),
        ("f.attrs['format'] = 'meshonet-boundary'", "has layout version '2'"),
    ],
)
def test_damaged_blocks_are_refused(change: str, problem: str, tmp_path: Path) -> None:
    write_grids(tmp_path / "g.h5", [two_blocks()])
    with h5py.File(tmp_path / "g.h5", "r+") as f:
        exec(change, {"f": f, "np": np, "h5py": h5py})  # noqa: S102
    with pytest.raises(InputError, match=problem):
        list(read_grids(memory((tmp_path / "g.h5").read_bytes())))
