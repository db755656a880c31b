"""Grids of many blocks as one mesh: no seam, no inner face, names kept, periodic sides coupled."""

import re
from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest
from check_mesh import check_mesh
from many_blocks import MANY, butterfly, passage, sector, step

import meshonet
from meshonet.formats.cgns.write import write_grids as write_cgns
from meshonet.formats.gmsh.geo import write_grids as write_geo
from meshonet.formats.gmsh.msh import write_grids as write_msh
from meshonet.formats.mesh.unstructured import unstructured
from meshonet.formats.openfoam.write import write_grids as write_foam
from meshonet.formats.registry import format_named
from meshonet.formats.su2 import write_grids as write_su2
from meshonet.formats.table import TABLE
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area

Make = Callable[[], Grid]
THICK = (0.0, 0.25, 0.5)


def names(grid: Grid) -> set[str]:
    return {patch.name for patch in grid.patches}


@pytest.mark.parametrize("make", MANY)
def test_nodes_stand_once_and_every_cell_is_there_counter_clockwise(make: Make) -> None:
    grid = make()
    mesh = unstructured(grid)
    assert len(np.unique(mesh.points, axis=0)) == len(mesh.points)
    assert len(mesh.cells) == sum((b.counts[0] - 1) * (b.counts[1] - 1) for b in grid.blocks)
    areas = [polygon_area(mesh.points[quad]) for quad in mesh.cells]
    assert min(areas) > 0
    sides = np.concatenate([mesh.cells[:, [k, (k + 1) % 4]] for k in range(4)])
    every, counts = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    outer = {tuple(edge) for edge in every[counts == 1].tolist()}
    named = np.concatenate(list(mesh.faces.values()))
    assert counts.max() == 2
    assert {tuple(sorted(edge)) for edge in named.tolist()} == outer
    assert len(named) == len(outer)
    assert {tuple(edge) for edge in named.tolist()} <= {tuple(edge) for edge in sides.tolist()}
    assert names(grid) <= set(mesh.faces)
    ring = np.concatenate([mesh.points[edge] for edge in named]).reshape(-1, 2, 2)
    enclosed = 0.5 * (ring[:, 0, 0] * ring[:, 1, 1] - ring[:, 1, 0] * ring[:, 0, 1]).sum()
    assert sum(areas) == pytest.approx(enclosed, rel=1e-12)


def test_walls_that_touch_without_being_connected_stay_two() -> None:
    grid = step()
    apart = Grid(grid.blocks, grid.patches)
    assert len(unstructured(apart).points) == len(unstructured(grid).points) + 5


@pytest.mark.parametrize("make", [passage, sector])
def test_periodic_edges_face_each_other_row_by_row(make: Make) -> None:
    mesh = unstructured(make())
    (pair,) = mesh.periodic
    assert (pair.name, pair.partner) == ("periodic low", "periodic high")
    own, partner = mesh.points[mesh.faces[pair.name]], mesh.points[mesh.faces[pair.partner]]
    np.testing.assert_array_equal(pair.motion(own), partner[:, ::-1])
    np.testing.assert_array_equal(pair.motion(mesh.points[pair.nodes[:, 0]]), mesh.points[pair.nodes[:, 1]])
    assert len(pair.nodes) == len(own) + 1


def test_periodic_sides_without_names_or_with_one_name_get_two() -> None:
    grid = passage()
    plain = tuple(patch for patch in grid.patches if "periodic" not in patch.name)
    assert set(unstructured(Grid(grid.blocks, plain, grid.connections)).faces) == {
        "inlet", "outlet", "periodic1", "periodic2"
    }  # fmt: skip
    turned = tuple(
        each.reversed() if each.block == 2 and each.transform else each for each in grid.connections
    )
    assert len(unstructured(Grid(grid.blocks, plain, grid.connections)).periodic) == 1
    (pair,) = unstructured(_unchecked(grid, turned)).periodic
    assert len(pair.faces) == 12


def _unchecked(grid: Grid, connections: tuple[object, ...]) -> Grid:
    """The grid with other connections, which agree to rounding only."""
    made = Grid(grid.blocks, grid.patches)
    object.__setattr__(made, "connections", connections)
    return made


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize("heights", [(0.0, 0.5), THICK])
@pytest.mark.parametrize("make", MANY)
def test_check_mesh_finds_nothing(make: Make, heights: tuple[float, ...], tmp_path: Path) -> None:
    write_foam(tmp_path / "case.foam", [extruded(make(), heights)])
    said = check_mesh(tmp_path)
    assert "Mesh OK." in said
    assert "***" not in said


def test_cyclic_patches_name_each_other_and_how_they_come_together(tmp_path: Path) -> None:
    write_foam(tmp_path / "case.foam", [passage()])
    text = (tmp_path / "constant" / "polyMesh" / "boundary").read_text()
    entries = {
        name: re.sub(r"\s+", " ", body)
        for name, body in re.findall(r"    (\S+)\n    \{\n(.*?)\}", text, re.S)
    }
    assert "type cyclic; neighbourPatch periodic_high; transform translational;" in entries["periodic_low"]
    assert "separationVector (0.1" in entries["periodic_low"]
    assert "neighbourPatch periodic_low;" in entries["periodic_high"]
    assert "separationVector (-0.1" in entries["periodic_high"]
    write_foam(tmp_path / "case.foam", [sector()])
    text = (tmp_path / "constant" / "polyMesh" / "boundary").read_text()
    assert text.count("transform       rotational;\n        rotationAxis    (0 0 1);") == 2


def test_su2_has_a_marker_a_name_and_the_line_that_couples_them(tmp_path: Path) -> None:
    for make, numbers in ((passage, [0, 0, 0, 0, 0, 0, 0.1, 0.7, 0]), (sector, [0, 0, 0, 0, 0, 40, 0, 0, 0])):
        write_su2(tmp_path / "g.su2", [make()])
        text = (tmp_path / "g.su2").read_text()
        (listed,) = re.findall(r"^% MARKER_PERIODIC= \( periodic_low, periodic_high, (.*) \)$", text, re.M)
        np.testing.assert_allclose([float(word) for word in listed.split(",")], numbers, atol=1e-12)
        assert re.findall(r"MARKER_TAG= (\S+)", text) == ["inlet", "outlet", "periodic_low", "periodic_high"]
        mesh = meshio.read(tmp_path / "g.su2")
        assert len(mesh.points) == 78
        assert len(mesh.get_cells_type("quad")) == 60


def test_convert_makes_one_mesh_of_a_file_of_blocks(tmp_path: Path) -> None:
    write_cgns(tmp_path / "blocks.cgns", [step()])
    meshonet.convert(tmp_path / "blocks.cgns", tmp_path / "mesh.su2")
    text = (tmp_path / "mesh.su2").read_text()
    assert text.startswith("NDIME= 2\nNELEM= 80\n")
    assert "NPOIN= 101\n" in text
    assert set(re.findall(r"MARKER_TAG= (\S+)", text)) == {
        "inlet", "lower_wall", "top", "outlet", "south", "east", "north"
    }  # fmt: skip


@pytest.mark.parametrize("words", ["2.2", "2.2,ascii", "4.1", "4.1,ascii"])
@pytest.mark.parametrize("heights", [(), THICK])
@pytest.mark.parametrize("make", [passage, sector, butterfly])
@pytest.mark.usefixtures("silent_gmsh")
def test_gmsh_knows_groups_and_partners(
    make: Make, heights: tuple[float, ...], words: str, tmp_path: Path
) -> None:
    import gmsh

    grid = make()
    write_msh(
        tmp_path / "g.msh",
        [extruded(grid, heights) if heights else grid],
        options=frozenset(words.split(",")),
    )
    gmsh.open(str(tmp_path / "g.msh"))
    dim = 3 if heights else 2
    groups = {
        gmsh.model.getPhysicalName(*group): gmsh.model.getEntitiesForPhysicalGroup(*group)
        for group in gmsh.model.getPhysicalGroups()
    }
    assert set(groups) == names(grid) | {"fluid"} | ({"back", "front"} if heights else set())
    mesh = unstructured(grid)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    assert len(tags) == len(mesh.points) * max(len(heights), 1)
    if not mesh.periodic:
        return
    if words.startswith("2.2"):  # gmsh writes them so and passes over them when it reads
        ((_, (slave, master), affine, rows),) = meshio.read(tmp_path / "g.msh").gmsh_periodic
        assert slave == groups["periodic high"][0]
        own, theirs = rows.T + 1
    else:
        master, own, theirs, affine = gmsh.model.mesh.getPeriodicNodes(dim - 1, groups["periodic high"][0])
    assert master == groups["periodic low"][0]
    assert len(own) == 13 * max(len(heights), 1)
    place = dict(zip(tags.tolist(), coordinates.reshape(-1, 3), strict=True))
    matrix = np.array(affine).reshape(4, 4)
    for tag, other in zip(own.tolist(), theirs.tolist(), strict=True):
        np.testing.assert_allclose(place[tag], (matrix @ [*place[other], 1])[:3], atol=1e-12)


@pytest.mark.parametrize("make", MANY)
@pytest.mark.usefixtures("silent_gmsh")
def test_a_geo_file_is_meshed_with_the_same_nodes_on_all_lines(make: Make, tmp_path: Path) -> None:
    import gmsh

    grid = make()
    write_geo(tmp_path / "g.geo", [grid])
    gmsh.open(str(tmp_path / "g.geo"))
    gmsh.model.mesh.generate(2)
    mesh = unstructured(grid)
    assert len(gmsh.model.mesh.getNodes()[0]) == len(mesh.points)
    kinds, cells, _ = gmsh.model.mesh.getElements(2)
    assert (kinds.tolist(), len(cells[0])) == ([3], len(mesh.cells))


@pytest.mark.parametrize("ending", ["vtu", "stl", "ply", "obj", "off", "inp", "med"])
def test_meshio_reads_one_mesh(ending: str, tmp_path: Path) -> None:
    record = format_named(ending)
    assert record.write_grids is not None
    record.write_grids(tmp_path / f"g.{ending}", [butterfly()])
    mesh = meshio.read(tmp_path / f"g.{ending}")
    assert len(mesh.points) == (
        len(unstructured(butterfly()).points) if ending != "stl" else len(mesh.points)
    )
    area = 0.0
    for block in mesh.cells:
        if block.type in ("quad", "triangle"):
            area += sum(polygon_area(mesh.points[cell, :2]) for cell in block.data)
    outline = unstructured(butterfly())
    wanted = sum(polygon_area(outline.points[quad]) for quad in outline.cells)
    assert area == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("name", [record.name for record in TABLE.values() if record.write_grids])
def test_a_format_of_one_block_names_those_of_many(name: str, tmp_path: Path) -> None:
    record = format_named(name)
    assert record.write_grids is not None
    path = tmp_path / f"grid{record.suffixes[0]}"
    if record.blocks:
        record.write_grids(path, [butterfly()])
        assert path.exists()
    else:
        message = f"{name} files hold one block and the grid has 5; write one of hdf5, .*openfoam.*su2"
        with pytest.raises(InputError, match=message):
            record.write_grids(path, [butterfly()])
    space = Grid((Block(np.random.default_rng(0).random((3, 3, 3, 3))),))
    if "volumes" in record.space:
        record.write_grids(path, [space])
    else:
        message = (
            f"{name} files hold grids in the plane, but this grid has volumes in space; write one of hdf5"
        )
        with pytest.raises(InputError, match=message):
            record.write_grids(path, [space])
