"""Grids of many blocks in Plot3D: with their neutral map beside, and without."""

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from block_grids import turned
from format_shapes import Pipe, c_grid, channel, memory, ring
from many_blocks import MANY, butterfly, by_block, duct, passage, sector, sorted_joints, step
from test_nmf import face_nodes

from meshonet.formats.mesh.unstructured import unstructured
from meshonet.formats.output import whole_file
from meshonet.formats.plot3d.nmf import write_grids as write_nmf
from meshonet.formats.plot3d.read import read_grids
from meshonet.formats.plot3d.write import write_grids
from meshonet.formats.source import open_source
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

Make = Callable[[], Grid]
VARIANTS = [((), ""), ((0.0, 0.5), ""), ((0.0, 0.5), "span-i"), ((0.0, 0.5), "span-j"), ((), "binary,iblank")]


def back(path: Path) -> list[Grid]:
    return list(read_grids(open_source(str(path))))


@pytest.mark.parametrize(("heights", "words"), VARIANTS)
@pytest.mark.parametrize("make", MANY)
def test_a_grid_comes_back_with_its_map(
    make: Make, heights: tuple[float, ...], words: str, tmp_path: Path
) -> None:
    grid = make()
    options = frozenset(filter(None, words.split(",")))
    with whole_file(str(tmp_path / "g.xyz")) as part:
        write_grids(part, [extruded(grid, heights) if heights else grid], options=options)
    (result,) = back(tmp_path / "g.xyz")
    assert sorted_joints(result.connections) == sorted_joints(grid.connections) or make is sector
    for block, old in zip(result.blocks, grid.blocks, strict=True):
        if make is sector:  # whose angle is what its nodes say
            np.testing.assert_allclose(block.nodes, old.nodes, atol=1e-14)
        else:
            assert np.array_equal(block.nodes, old.nodes)
    named = [(p.block, p.side, p.start, p.stop, p.name, p.kind) for p in by_block(grid.patches)]
    message = [(p.block, p.side, p.start, p.stop, p.name, p.kind) for p in result.patches]
    assert set(named) <= set(message)
    mesh, wanted = unstructured(result), unstructured(grid)
    assert {n: len(e) for n, e in mesh.faces.items()} == {n: len(e) for n, e in wanted.faces.items()}
    assert "iblank" not in words or result.provenance == {
        "iblank": {"1": sum(b.nodes.size // 2 for b in grid.blocks)}
    }


@pytest.mark.parametrize("make", MANY)
def test_the_map_joins_equal_nodes_in_the_order_that_it_says(make: Make, tmp_path: Path) -> None:
    grid = make()
    write_nmf(tmp_path / "g.nmf", [extruded(grid, (0.0, 1.0))])
    lines = [line.split() for line in (tmp_path / "g.nmf").read_text().splitlines() if line[0] != "#"]
    count = int(lines[0][0])
    dims = [[int(word) for word in line[1:]] for line in lines[1 : count + 1]]
    covered = {(block, *node) for block, size in enumerate(dims) for node in np.ndindex(*size)}
    joints = 0
    for kind, *words in lines[count + 1 :]:
        numbers = [int(word) for word in words if word not in ("TRUE", "FALSE")]
        ends = [numbers[k : k + 6] for k in range(0, len(numbers), 6)]
        rows = [face_nodes(end, dims[end[0] - 1]) for end in ends]
        for end, nodes in zip(ends, rows, strict=True):
            covered -= {(end[0] - 1, i - 1, j - 1, k - 1) for i, j, k in nodes}
        if len(ends) == 2:
            joints += 1
            own, donor = rows
            if words[-1] == "TRUE":  # the donor's second range runs as the first one of the own face
                width = abs(ends[1][5] - ends[1][4]) + 1
                donor = [donor[k] for n in range(width) for k in range(n, len(donor), width)]
            for (i, j, k), (u, v, w) in zip(own, donor, strict=True):
                here = grid.blocks[ends[0][0] - 1].nodes[i - 1, j - 1]
                there = grid.blocks[ends[1][0] - 1].nodes[u - 1, v - 1]
                assert k == w
                assert np.array_equal(here, there) or kind == "PERIODIC"
    assert joints == len(grid.connections)
    assert covered == set()  # every node of a layer is at its back, its front or both


@pytest.mark.parametrize("make", [butterfly, duct, step])
def test_without_a_map_interfaces_are_found_and_lines_named(make: Make, tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.p3d", [grid])
    (tmp_path / "g.nmf").unlink()
    (result,) = back(tmp_path / "g.p3d")
    assert sorted_joints(result.connections) == sorted_joints(grid.connections)
    assert set(unstructured(result).faces) == {"outer"}


@pytest.mark.parametrize("make", [channel, ring, c_grid])
@pytest.mark.parametrize("words", ["", "binary", "3d"])
def test_a_grid_of_one_block_has_a_map_too_and_keeps_its_names(
    make: Make, words: str, tmp_path: Path
) -> None:
    grid = make()
    write_grids(tmp_path / "g.xyz", [grid], options=frozenset(filter(None, [words])))
    (result,) = back(tmp_path / "g.xyz")
    assert np.array_equal(result.nodes, grid.nodes)
    assert (result.topology, result.connections) == (grid.topology, grid.connections)
    assert unstructured(result).faces.keys() == unstructured(grid).faces.keys()


def test_a_hole_is_called_body(tmp_path: Path) -> None:
    half = ring().nodes
    write_grids(tmp_path / "g.p3d", [Grid.from_nodes(half[:7]), Grid.from_nodes(half[6:])])
    (result,) = back(tmp_path / "g.p3d")
    mesh = unstructured(result)
    assert {name: len(edges) for name, edges in mesh.faces.items()} == {"body": 12, "outer": 12}
    assert len(mesh.points) == len(unstructured(ring()).points)


def test_blocks_of_any_hand_in_single_precision_are_joined(tmp_path: Path) -> None:
    grid = butterfly()
    lattices = [block.nodes for block in grid.blocks]
    lattices[1], lattices[3] = lattices[1][::-1], turned(lattices[3], 2)[:, ::-1]
    write_grids(
        tmp_path / "g.bin",
        [Grid.from_nodes(nodes) for nodes in lattices],
        options=frozenset(["binary", "float32"]),
    )
    (result,) = back(tmp_path / "g.bin")
    assert len(result.connections) == 8
    assert len(unstructured(result).points) == len(unstructured(grid).points)


def test_a_batch_of_grids_stays_one_and_has_no_map(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.p3d", [channel(), ring(), c_grid(), ring(), c_grid(), channel()])
    assert not (tmp_path / "g.nmf").exists()
    result = back(tmp_path / "g.p3d")
    assert [grid.topology for grid in result] == ["quad", "o", "c", "o", "c", "quad"]
    assert [grid.name for grid in result] == [f"g-{k}" for k in range(1, 7)]
    write_grids(tmp_path / "g.p3d", [channel(), duct(), passage()])
    assert [len(grid.blocks) for grid in back(tmp_path / "g.p3d")] == [1, 2, 3]
    assert back(tmp_path / "g.p3d")[0].patches[0].name == "no-slip wall"


def test_a_stream_has_no_map_beside_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pipe = Pipe()
    monkeypatch.setattr("sys.stdout", pipe)
    with whole_file("-") as part:
        write_grids(part, [duct()])
        assert list(part.parent.glob(f"{part.stem}*.nmf")) == []
    assert isinstance(pipe.buffer, io.BytesIO)
    (result,) = read_grids(memory(pipe.buffer.getvalue()))
    assert len(result.connections) == 1


ROWS = """\
# a map of another hand, in words of its own
2
1  9 5 1
2  5 9 1
'one-to-one'  1 4  5 1  1 1   2 6  1 1  1 5  TRUE
TANGENCY      1 5  1 1  1 9
viscous_solid 1 6  1 1  9 1
farfield_riem 2 5  1 1  1 5
"""


def test_maps_of_others_are_read_as_they_are_spelled(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.p3d", [duct()])
    (tmp_path / "g.nmf").write_text(ROWS)
    (result,) = back(tmp_path / "g.p3d")
    assert len(result.connections) == 1
    assert {(p.name, p.block, p.side, p.kind) for p in result.patches if p.name != "outer"} == {
        ("tangency", 0, "south", "wall"), ("viscous_solid", 0, "north", "wall"),
        ("farfield_riem", 1, "south", "farfield"),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "g.nmf: its map is of 0 blocks"),
        ("1\n1 9 5 1\n", "g.nmf: its map is of 1 blocks: 9x5x1; write the map again, or take it away"),
        (ROWS.replace("2  5 9", "2  5 8"), "its map is of 2 blocks: 9x5x1, 5x8x1"),
        (
            ROWS.replace("viscous_solid 1 6", "viscous_solid 3 6"),
            "row 'viscous_solid 3 6 .* is not understood",
        ),
        (ROWS.replace("viscous_solid 1 6", "viscous_solid 1 9"), "is not understood"),
        (ROWS.replace("2 6  1 1  1 5", "2 6  1 1  1 4"), "joins 4 cells to 3; join equal counts"),
        ("x\n", "its map cannot be read"),
    ],
)
def test_a_map_that_does_not_fit_is_refused(text: str, message: str, tmp_path: Path) -> None:
    write_grids(tmp_path / "g.p3d", [duct()])
    (tmp_path / "g.nmf").write_text(text)
    with pytest.raises(InputError, match=message):
        back(tmp_path / "g.p3d")
