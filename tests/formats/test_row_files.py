"""Files of a blade row, one passage and copies of it: what the programs that read them say, and periods."""

import re
import subprocess
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from blade_row import BLADES, blade_row
from check_mesh import check_mesh

import meshonet
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.copies import copied
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.revolve import Revolution, revolved

NAMES = {"blade", "tip", "hub", "shroud", "inlet", "outlet"}
SIDES = {"periodic1", "periodic2"}


@pytest.fixture(scope="module")
def passage() -> Grid:
    return meshonet.stack(blade_row(tip_gap=0.05), cells=20_000, first_cell=0.01, growth=1.5)


def turned(points: np.ndarray, degrees: float) -> np.ndarray:
    """Points rotated about the x axis, right-handed."""
    other = (points[:, 1] + 1j * points[:, 2]) * np.exp(1j * np.radians(degrees))
    return np.stack([points[:, 0], other.real, other.imag], axis=1)


class Su2:
    """A mesh as SU2 reads it: NAME= VALUE, then as many lines as it says."""

    def __init__(self, path: Path) -> None:
        lines = iter(path.read_text().splitlines())
        self.markers: dict[str, np.ndarray] = {}
        self.comments: list[str] = []
        for line in lines:
            if line.startswith("%"):
                self.comments.append(line)
                continue
            name, value = (word.strip() for word in line.split("="))
            if name == "NELEM":
                self.cells = self._rows(lines, int(value), np.int64)
            elif name == "NPOIN":
                self.points = self._rows(lines, int(value), float)
            elif name == "MARKER_TAG":
                tag = value
            elif name == "MARKER_ELEMS":
                self.markers[tag] = self._rows(lines, int(value), np.int64)
            else:
                assert (name, value) in {("NDIME", "3"), ("NMARK", str(len(NAMES | SIDES)))}

    @staticmethod
    def _rows(lines: Iterator[str], count: int, kind: type) -> np.ndarray:
        return np.array(" ".join(islice(lines, count)).split(), dtype=kind).reshape(count, -1)

    def on(self, marker: str) -> np.ndarray:
        """Points on a marker."""
        return self.points[np.unique(self.markers[marker][:, 1:])]


@pytest.mark.parametrize("copies", [1, 3])
def test_su2_turns_one_periodic_marker_to_the_other(passage: Grid, copies: int, tmp_path: Path) -> None:
    copied(passage, copies).write(tmp_path / "row.su2")
    mesh = Su2(tmp_path / "row.su2")
    assert set(mesh.markers) == NAMES | SIDES
    assert set(mesh.cells[:, 0]) == {12}
    assert {kind for rows in mesh.markers.values() for kind in rows[:, 0]} == {9}
    (line,) = re.findall(r"MARKER_PERIODIC= \( (\S+), (\S+), (.*) \)", "\n".join(mesh.comments))
    numbers = [float(word) for word in line[2].split(",")]
    assert numbers == pytest.approx([0, 0, 0, numbers[3], 0, 0, 0, 0, 0], abs=1e-300)
    assert abs(numbers[3]) == pytest.approx(copies * 360.0 / BLADES, rel=1e-14)
    assert copies > 1 or abs(numbers[3]) == 360.0 / BLADES
    there, partner = turned(mesh.on(line[0]), numbers[3]), mesh.on(line[1])
    near = np.sqrt(((there[:, None] - partner) ** 2).sum(axis=-1)).min(axis=1)
    assert near.max() < 1e-13


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize(
    ("copies", "words", "kind"),
    [(1, "", "cyclic"), (1, ":cyclicami", "cyclicAMI"), (2, "", "cyclic")],
)
def test_check_mesh_finds_no_fault(passage: Grid, copies: int, words: str, kind: str, tmp_path: Path) -> None:
    copied(passage, copies).write(tmp_path / "case.foam", to_format=f"openfoam{words}")
    said = check_mesh(tmp_path)
    assert "Mesh OK." in said
    assert "Number of regions: 1 (OK)" in said
    text = (tmp_path / "constant/polyMesh/boundary").read_text()
    patches = dict(re.findall(r"^    (\w+)\n    \{\n\s+type\s+(\w+);", text, re.M))
    assert set(patches) == NAMES | SIDES
    assert {patches[name] for name in SIDES} == {kind}
    assert {name for name, own in patches.items() if own == "wall"} == NAMES - {"inlet", "outlet"}


@pytest.mark.client("cgnscheck")
@pytest.mark.parametrize("copies", [1, 2])
def test_cgnscheck_finds_periodic_interfaces_without_a_fault(
    passage: Grid, copies: int, tmp_path: Path
) -> None:
    grid = copied(passage, copies)
    grid.write(tmp_path / "row.cgns")
    done = subprocess.run(
        ["cgnscheck", str(tmp_path / "row.cgns")], capture_output=True, text=True, timeout=60
    )
    message = done.stdout + done.stderr
    assert done.returncode == 0
    assert "ERROR" not in message
    assert "WARNING" not in message
    across = sum(each.transform is not None for each in grid.connections)
    assert message.count("checking periodic property") == 2 * across > 0


@pytest.mark.usefixtures("silent_gmsh")
def test_gmsh_has_the_rotation_and_the_pairs_of_nodes(passage: Grid, tmp_path: Path) -> None:
    import gmsh

    passage.write(tmp_path / "row.msh", to_format="gmsh:4.1")
    gmsh.open(str(tmp_path / "row.msh"))
    groups = {gmsh.model.getPhysicalName(*group): group for group in gmsh.model.getPhysicalGroups(2)}
    assert set(groups) == NAMES | SIDES
    result = 0
    for name in SIDES:
        (entity,) = gmsh.model.getEntitiesForPhysicalGroup(*groups[name])
        partner, own, other, affine = gmsh.model.mesh.getPeriodicNodes(2, int(entity))
        if partner == entity:
            continue
        result += 1
        matrix = np.array(affine).reshape(4, 4)
        here, there = (np.array([gmsh.model.mesh.getNode(int(n))[0] for n in part]) for part in (own, other))
        assert there @ matrix[:3, :3].T + matrix[:3, 3] == pytest.approx(here, abs=1e-12)
        assert len(own) == len(np.unique(own)) > 100
    assert result == 1


@pytest.mark.parametrize("ending", ["cgns", "vtm"])
def test_copies_come_back_from_a_file(passage: Grid, ending: str, tmp_path: Path) -> None:
    grid = copied(passage, 2)
    grid.write(tmp_path / f"row.{ending}")
    back = meshonet.read(tmp_path / f"row.{ending}")
    assert isinstance(back, Grid)
    assert all(np.array_equal(a.nodes, b.nodes) for a, b in zip(back.blocks, grid.blocks, strict=True))
    assert {patch.name for patch in back.outer_patches()} >= NAMES
    joined = sum(each.transform is None for each in back.connections)
    assert joined == sum(each.transform is None for each in grid.connections)


@pytest.mark.client("checkMesh")
def test_check_mesh_takes_a_ring_for_one_region(tmp_path: Path) -> None:
    x, r = np.meshgrid(np.linspace(0.0, 2.0, 4), [1.0, 1.4, 2.0], indexing="ij")
    sector = revolved(Grid((Block(np.stack([x + 0.2 * r, r], axis=-1)),)), Revolution(360.0 / 7, 5))
    copied(sector, 7).write(tmp_path / "ring.foam")
    said = check_mesh(tmp_path)
    assert "Mesh OK." in said
    assert "Number of regions: 1 (OK)" in said
    assert "cyclic" not in (tmp_path / "constant/polyMesh/boundary").read_text()
