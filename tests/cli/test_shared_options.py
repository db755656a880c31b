"""Options that several commands share do in each what they say."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from command_line import BOUNDARY_COMMANDS, Meshonet, dataset, duct

from meshonet.formats.registry import read_grids

GRID_COMMANDS = ("tfi", "solve-pde", "infer")
SECTION = "naca:2412"


def wall(meshonet: Meshonet, command: str, *words: object) -> np.ndarray:
    """The body's nodes in what `command` makes."""
    assert meshonet(command, *words, "-o", "made.h5", "-q").code == 0
    with h5py.File("made.h5") as file:
        return np.array(file["south"][0])


@pytest.mark.parametrize("command", BOUNDARY_COMMANDS)
def test_spacing_options_place_the_wall_nodes(meshonet: Meshonet, command: str) -> None:
    default = wall(meshonet, command, SECTION, "--res", "120x20")
    for words in (("--spacing", "cosine"), ("--le-spacing", "0.004"), ("--te-spacing", "0.004")):
        assert not np.array_equal(wall(meshonet, command, SECTION, "--res", "120x20", *words), default)
    edge = wall(meshonet, command, SECTION, "--res", "120x20", "--te-spacing", "0.004")
    steps = np.linalg.norm(np.diff(edge, axis=0), axis=1)
    assert np.abs(steps[:16] - 0.004).min() < 0.001  # the first of them are on the blunt base


@pytest.mark.parametrize("command", BOUNDARY_COMMANDS)
def test_far_field_is_in_chords(meshonet: Meshonet, command: str) -> None:
    wall(meshonet, command, SECTION, "--res", "60x20", "--far-field", "7", "--topology", "o")
    with h5py.File("made.h5") as file:
        assert np.ptp(file["north"][0, :, 0]) == pytest.approx(14, rel=1e-2)
        assert file.attrs["topology"] == "o"


@pytest.mark.parametrize("command", BOUNDARY_COMMANDS)
def test_c_boundaries_have_the_wake_asked_for_and_tell_of_the_closed_edge(
    meshonet: Meshonet, command: str
) -> None:
    words = ("--topology", "c", "--res", "120x20", "--wake", "9", "--wake-nodes", "31")
    done = meshonet(command, SECTION, *words, "-o", "made.h5")
    assert done.code == 0
    assert "the outline is changed: its base" in done.err
    with h5py.File("made.h5") as file:
        south = np.array(file["south"][0])
        assert file.attrs["topology"] == "c"
    np.testing.assert_array_equal(south[:31], south[-31:][::-1])
    assert south[0, 0] - south[30, 0] == pytest.approx(9.0, rel=1e-3)
    assert meshonet(command, SECTION, *words, "--te", "exact", "-o", "none.h5").code == 2
    assert not Path("none.h5").exists()


@pytest.mark.parametrize("command", BOUNDARY_COMMANDS)
def test_normalise_puts_the_chord_on_the_axis(meshonet: Meshonet, command: str) -> None:
    section = wall(meshonet, "sample-boundary", "naca:0012", "--res", "81x5") * 40 + [3, 5]
    Path("big.csv").write_text("\n".join(f"{x},{y}" for x, y in section))
    Path("big.dat").write_text("section\n" + "\n".join(f"{x} {y}" for x, y in section) + "\n")
    nodes = wall(meshonet, command, "big.dat", "--res", "81x20", "--normalise")
    np.testing.assert_allclose([nodes[:, 0].min(), nodes[:, 0].max()], [0, 1], atol=1e-2)
    assert np.ptp(wall(meshonet, command, "big.dat", "--res", "81x20")[:, 0]) == pytest.approx(40, rel=1e-2)


@pytest.mark.parametrize("command", BOUNDARY_COMMANDS)
def test_corners_make_an_outline_four_sided(meshonet: Meshonet, command: str) -> None:
    t = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    Path("disc.csv").write_text("\n".join(f"{x},{y}" for x, y in zip(np.cos(t), np.sin(t), strict=True)))
    words = ("--corners", "25,35,5,15", "--topology", "quad", "--res", "21")
    nodes = wall(meshonet, command, "disc.csv", *words)
    np.testing.assert_allclose(nodes[0], [np.cos(t[25]), np.sin(t[25])], atol=1e-12)
    np.testing.assert_allclose(nodes[-1], [np.cos(t[35]), np.sin(t[35])], atol=1e-12)
    with h5py.File("made.h5") as file:
        assert file.attrs["topology"] == "quad"


@pytest.mark.parametrize("command", [*BOUNDARY_COMMANDS, "convert", "plot", "quality"])
def test_from_names_the_format_of_the_input(meshonet: Meshonet, duct_h5: Path, command: str) -> None:
    meshonet("tfi", duct_h5, "-o", "grid.vts")
    Path("grid.vts").rename("odd.name")
    output = [] if command == "quality" else ["-o", "g.png" if command == "plot" else "g.h5"]
    assert meshonet(command, "odd.name", "--from", "vts", *output).code == 0
    assert meshonet(command, "odd.name", "--from", "hdf5", *output).code == 2


@pytest.mark.parametrize("command", [*BOUNDARY_COMMANDS, "convert"])
def test_to_names_the_format_of_the_output(meshonet: Meshonet, duct_h5: Path, command: str) -> None:
    meshonet("tfi", duct_h5, "-o", "grid.vts")
    assert meshonet(command, "grid.vts", "--output", "odd.name", "--to", "hdf5").code == 0
    assert Path("odd.name").read_bytes().startswith(b"\x89HDF")


@pytest.mark.parametrize("command", [*BOUNDARY_COMMANDS, "convert", "plot"])
def test_skip_existing_leaves_what_is_there(meshonet: Meshonet, duct_h5: Path, command: str) -> None:
    meshonet("tfi", duct_h5, "-o", "grid.vts")
    ending = ".png" if command == "plot" else ".h5"
    Path(f"out-grid{ending}").write_text("mine")
    done = meshonet(command, "grid.vts", "-o", "out-{stem}" + ending, "--skip-existing")
    assert done.code == 0
    assert Path(f"out-grid{ending}").read_text() == "mine"


@pytest.mark.parametrize("command", BOUNDARY_COMMANDS)
def test_jobs_give_the_same_results(meshonet: Meshonet, three_h5: Path, command: str) -> None:
    assert meshonet(command, three_h5, "-o", "one/{name}.h5").code == 0
    done = meshonet(command, three_h5, "missing.h5", "-o", "two/{name}.h5", "--jobs", "2")
    assert done.code == 2
    assert "3 done, 1 failed" in done.err
    for name in ("flat", "low", "high"):
        with h5py.File(f"one/{name}.h5") as one, h5py.File(f"two/{name}.h5") as two:
            for key in one:
                if key != "provenance":  # it has the command line, and so the jobs
                    np.testing.assert_array_equal(one[key][:], two[key][:])


def test_jobs_fill_one_dataset_in_order(meshonet: Meshonet, three_h5: Path) -> None:
    assert meshonet("tfi", three_h5, "-o", "all.h5", "--jobs", "2").code == 0
    assert [grid.name for grid in read_grids("all.h5")] == ["flat", "low", "high"]


@pytest.mark.parametrize("command", GRID_COMMANDS)
def test_gates_decide_the_exit_code(meshonet: Meshonet, duct_h5: Path, command: str) -> None:
    assert meshonet(command, duct_h5, "-o", "g.vts", "--fail-on", "folded>0").code == 0
    done = meshonet(command, duct_h5, "-o", "g.vts", "--fail-on", "max_angle>90.5")
    assert done.code == 1
    assert "gate not met" in done.err


@pytest.mark.parametrize("command", GRID_COMMANDS)
def test_no_grid_is_folded_in_silence(meshonet: Meshonet, tmp_path: Path, command: str) -> None:
    edges = duct()
    edges["south"][1] = [-0.05, -0.05]  # the corner opens by 225 degrees: the cell in it has no valid shape
    source = dataset(tmp_path / "open.h5", "quad", edges)
    done = meshonet(command, source, "-o", "g.vts")
    assert done.code == 3
    assert ("cells are folded" if command == "tfi" else "(0, 0) opens by 180 degrees") in done.err
    assert not Path("g.vts").exists()
    allowed = meshonet(command, source, "-o", "g.vts", "--allow-invalid", "-q")
    assert allowed.code == 0
    assert "folded cells are in g.vts" in allowed.err
    assert len(list(read_grids("g.vts"))) == 1


@pytest.mark.parametrize("command", [*BOUNDARY_COMMANDS, "convert", "plot"])
def test_quiet_and_json_keep_standard_error_empty(meshonet: Meshonet, duct_h5: Path, command: str) -> None:
    meshonet("tfi", duct_h5, "-o", "grid.vts")
    output = "g.png" if command == "plot" else "g.h5"
    quiet = meshonet(command, "grid.vts", "-o", output, "--quiet")
    assert (quiet.code, quiet.out, quiet.err) == (0, "", "")
    report = meshonet(command, "grid.vts", "-o", output, "--json")
    assert report.err == ""
    assert report.only["output"] == output
    assert report.only["seconds"]["total"] > 0


@pytest.mark.parametrize("command", [*BOUNDARY_COMMANDS, "convert", "plot", "quality"])
def test_debug_shows_the_traceback(meshonet: Meshonet, command: str) -> None:
    output = [] if command == "quality" else ["-o", "g.png" if command == "plot" else "g.h5"]
    plain = meshonet(command, "missing.vts", *output)
    assert (plain.code, plain.err.count("\n")) == (2, 1)
    assert "Traceback" in meshonet(command, "missing.vts", *output, "--debug").err
