"""Files of many blocks through quality, plot, convert and solve-pde."""

from pathlib import Path

import numpy as np
import pytest
from block_grids import butterfly, duct, o_ring
from command_line import Meshonet

import meshonet as library
from meshonet.geometry.blocks.grid import Grid


@pytest.fixture
def disc(tmp_path: Path) -> Path:
    path = tmp_path / "disc.cgns"
    butterfly(9, 7).write(path)
    return path


def read(path: Path) -> Grid:
    grid = library.read(path)
    assert isinstance(grid, Grid)
    return grid


def test_quality_counts_blocks_and_names_cells_by_their_block(meshonet: Meshonet, disc: Path) -> None:
    facts = meshonet("quality", disc, "--json").only
    assert [facts[key] for key in ("blocks", "cells", "irregular", "interfaces")] == [5, 256, 4, 8]
    assert len(facts["quality"]["skewness"]["worst"]) == 3
    text = meshonet("quality", disc, "--profile", "openfoam").out
    assert "5 blocks, 273 nodes, 8 interfaces, 4 irregular vertices, 256 cells, none folded" in text
    head = next(line for line in text.splitlines() if line.endswith("at x, y"))
    assert "worst at block, i, j" in head
    assert "bend across sides (deg)" in text


def test_a_grid_of_several_blocks_is_called_so(meshonet: Meshonet, disc: Path) -> None:
    done = meshonet("solve-pde", disc, "--method", "variational", "-o", "g.vtm")
    assert done.err.splitlines()[0].endswith("irregular vertices, multi-block grid")


def test_gates_look_at_blocks(meshonet: Meshonet, disc: Path) -> None:
    run = meshonet("quality", disc, "--fail-on", "irregular>3", "--fail-on", "growth_across>9")
    assert (run.code, "irregular is 4" in run.err, "growth_across is" in run.err) == (1, True, False)


def test_metrics_of_every_cell_go_to_a_file_of_blocks(meshonet: Meshonet, disc: Path, tmp_path: Path) -> None:
    meshonet("quality", disc, "--per-cell", tmp_path / "metrics.vtm")
    assert b'Name="skewness"' in (tmp_path / "metrics_blocks" / "block-4.vts").read_bytes()
    report = meshonet("quality", disc, "--per-cell", tmp_path / "metrics.vts").err
    assert "a .vts file holds one block, not 5; name it FILE.vtm" in report


def test_blocks_are_drawn(meshonet: Meshonet, disc: Path, tmp_path: Path) -> None:
    options = "--metric", "skewness", "--zoom", "0,1,0,1"
    meshonet("plot", disc, "-o", tmp_path / "disc.png", *options)
    assert (tmp_path / "disc.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", ["out.cgns", "out.xyz", "out.vtm", "out.h5"])
def test_given_blocks_are_smoothed(meshonet: Meshonet, disc: Path, tmp_path: Path, name: str) -> None:
    facts = meshonet("solve-pde", disc, "-o", tmp_path / name, "--json").only
    assert (facts["blocks"], facts["irregular"], facts["folded"]) == (5, 4, 0)
    made = read(tmp_path / name)
    before, after = (library.quality(grid).figures.faces for grid in (read(disc), made))
    assert before.non_orthogonality
    assert after.non_orthogonality
    assert after.non_orthogonality.max < 0.5 * before.non_orthogonality.max
    again = meshonet("solve-pde", tmp_path / name, "-o", tmp_path / "again.cgns", "--slide")
    assert again.code == 0


def test_smoothed_blocks_are_refined(meshonet: Meshonet, disc: Path, tmp_path: Path) -> None:
    meshonet("solve-pde", disc, "-o", tmp_path / "fine.cgns", "--refine", "1")
    assert library.quality(tmp_path / "fine.cgns").quality.cells == 4 * 256
    meshonet("convert", tmp_path / "fine.cgns", tmp_path / "back.cgns", "--coarsen", "2")
    assert library.quality(tmp_path / "back.cgns").quality.cells == 256


@pytest.mark.parametrize(
    ("command", "options", "message"),
    [
        ("solve-pde", ("--method", "winslow"), "method winslow makes single blocks"),
        ("tfi", (), "method tfi makes single blocks; let infer or solve-pde make the grid"),
        ("solve-pde", ("--initial", "{disc}"), "--initial is of no use"),
        ("sample-boundary", (), "is not one block"),
        ("convert", ("--coarsen", "5"), "block 0: 9x9 nodes are 8x8 cells, which 5 does not divide"),
    ],
)
def test_what_blocks_cannot_be_gets_a_line(
    meshonet: Meshonet, disc: Path, tmp_path: Path, command: str, options: tuple[str, ...], message: str
) -> None:
    words = [word.format(disc=disc) for word in options]
    output = tmp_path / ("b.h5" if command == "sample-boundary" else "x.cgns")
    assert message in meshonet(command, disc, "-o", output, *words).err


def test_unit_size_and_a_turn_keep_connections(meshonet: Meshonet, tmp_path: Path) -> None:
    duct(1).write(tmp_path / "duct.cgns")
    meshonet("convert", tmp_path / "duct.cgns", tmp_path / "unit.cgns", "--normalise", "--swap")
    made = read(tmp_path / "unit.cgns")
    assert len(made.connections) == 1
    nodes = np.concatenate([block.nodes.reshape(-1, 2) for block in made.blocks])
    assert nodes.max(axis=0) == pytest.approx((1.0, 0.25))


def test_blocks_become_one_mesh_one_cell_thick(meshonet: Meshonet, tmp_path: Path) -> None:
    o_ring().write(tmp_path / "ring.cgns")
    meshonet("convert", tmp_path / "ring.cgns", tmp_path / "ring.vtu", "--extrude", "0.1")
    assert (tmp_path / "ring.vtu").stat().st_size > 1000


def test_a_body_that_few_cells_cut_off_has_a_note(meshonet: Meshonet) -> None:
    coarse, fine = (
        meshonet("infer", "naca:0012-sharp", "--cells", cells, "-o", "a.cgns") for cells in (2500, 10000)
    )
    assert "cells along body change its area by " in coarse.err
    assert "change its area" not in fine.err
