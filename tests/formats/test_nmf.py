from pathlib import Path

import numpy as np
import pytest
from format_shapes import c_grid, channel, ring

from meshonet.formats.plot3d.nmf import write_grids
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid

Row = tuple[str, list[int]]


def rows(path: Path) -> tuple[list[int], list[Row]]:
    """Return the dimensions and the rows: type and its numbers, without the word for the swap."""
    lines = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
    assert lines[0] == ["1"]
    result = [(line[0], [int(word) for word in line[1:] if word != "FALSE"]) for line in lines[2:]]
    return [int(word) for word in lines[1][1:]], result


def face_nodes(span: list[int], dims: list[int]) -> list[tuple[int, int, int]]:
    """Return the nodes (i, j, k) from 1 of block, face and two ranges, as NASA's page has them."""
    _, face, s1, e1, s2, e2 = span
    first = range(s1, e1 + 1) if e1 >= s1 else range(s1, e1 - 1, -1)
    second = range(s2, e2 + 1) if e2 >= s2 else range(s2, e2 - 1, -1)
    normal = (face - 1) // 2  # 0: k, 1: i, 2: j
    fixed = [2, 0, 1][normal]
    at = dims[fixed] if face % 2 == 0 else 1
    result = []
    for a in first:
        for b in second:
            node = [0, 0, 0]
            node[fixed], node[(fixed + 1) % 3], node[(fixed + 2) % 3] = at, a, b
            result.append((node[0], node[1], node[2]))
    return result


@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_every_outer_node_of_a_layer_is_in_a_row(make: type[Grid], tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.nmf", [extruded(grid, (0.0, 1.0))])
    dims, result = rows(tmp_path / "g.nmf")
    assert dims == [grid.ni, grid.nj, 2]
    covered = set()
    for _, span in result:
        for k in range(0, len(span), 6):
            covered |= set(face_nodes(span[k : k + 6], dims))
    assert len(covered) == grid.ni * grid.nj * 2


@pytest.mark.parametrize("make", [ring, c_grid])
def test_the_cut_joins_equal_nodes(make: type[Grid], tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.nmf", [grid])
    dims, result = rows(tmp_path / "g.nmf")
    (span,) = [numbers for kind, numbers in result if kind == "ONE_TO_ONE"]
    pairs = zip(face_nodes(span[:6], dims), face_nodes(span[6:], dims), strict=True)
    count = 0
    for own, other in pairs:
        assert own != other or grid.topology == "c"
        assert np.array_equal(grid.nodes[own[0] - 1, own[1] - 1], grid.nodes[other[0] - 1, other[1] - 1])
        count += 1
    assert count == (grid.nj if grid.topology == "o" else 4)


def test_types_say_what_the_parts_are(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.nmf", [channel()])
    assert [kind for kind, _ in rows(tmp_path / "g.nmf")[1]] == [
        "VISCOUS", "south", "out_let", "north", "INFLOW",
    ]  # fmt: skip
    write_grids(tmp_path / "g.nmf", [extruded(c_grid(), (0.0, 1.0))])
    assert rows(tmp_path / "g.nmf")[1] == [
        ("VISCOUS", [1, 5, 1, 2, 4, 12]),
        ("FARFIELD", [1, 4, 1, 4, 1, 2]),
        ("FARFIELD", [1, 6, 1, 2, 1, 15]),
        ("FARFIELD", [1, 3, 1, 4, 1, 2]),
        ("SYMMETRY", [1, 1, 1, 15, 1, 4]),
        ("SYMMETRY", [1, 2, 1, 15, 1, 4]),
        ("ONE_TO_ONE", [1, 5, 1, 2, 1, 4, 1, 5, 1, 2, 15, 12]),
    ]
