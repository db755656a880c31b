"""Messages about bad shapes name the file, whatever its format, before a grid is made."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from command_line import Meshonet, dataset, duct, ellipse

MODELS = ("base", "airfoil-o", "hole-o", "hole-winslow")


def crossed() -> dict[str, np.ndarray]:
    edges = duct(bump=0.0)
    edges["south"][10, 1] = 1.5
    return edges


@pytest.mark.parametrize("ending", ["vts", "xyz", "h5", "vtk"])
def test_outer_edges_of_grids_that_cross_are_refused(meshonet: Meshonet, tmp_path: Path, ending: str) -> None:
    source = dataset(tmp_path / "nodes.h5", "quad", crossed())
    nodes = np.stack(np.meshgrid(np.linspace(0, 2, 21), np.linspace(0, 1, 11), indexing="ij"), axis=-1)
    nodes[:, 0] = crossed()["south"]
    with h5py.File(source, "a") as file:
        file.attrs["format"] = "meshonet-grid"
        file["nodes"] = nodes[None]
    assert meshonet("convert", source, f"grid.{ending}").code == 0
    for words in (("solve-pde",), ("infer", "--model", "quad-general")):
        done = meshonet(*words, f"grid.{ending}", "--res", "41x31", "-o", "made.h5")
        assert done.code == 2
        assert done.err.startswith(f"error: grid.{ending}: south and north cross at (0.96")
        assert not Path("made.h5").exists()


@pytest.mark.parametrize("model", MODELS)
def test_a_body_that_crosses_its_far_field_is_refused_by_every_model(
    meshonet: Meshonet, tmp_path: Path, model: str
) -> None:
    edges = ellipse()
    edges["south"] += [5.0, 0.0]
    edges["west"] = edges["east"] = np.linspace(edges["south"][0], edges["north"][0], 15)
    dataset(tmp_path / "bodies.h5", "o", edges, ellipse(), names=("out", "in"))
    done = meshonet("infer", "bodies.h5", "--model", model, "--polish", "1", "-o", "made.h5", "--json")
    assert done.code == 2
    assert "bodies.h5[out]: south and north cross at (4.988" in done.err
    assert [one.get("name") for one in done.objects] == [None, "in"]


def test_a_body_of_too_few_nodes_is_refused(meshonet: Meshonet, body_h5: Path) -> None:
    done = meshonet("infer", body_h5.name, "--res", "3", "-o", "made.vts")
    assert (done.code, done.err) == (2, "error: body.h5: 3 nodes around a body; use at least 4\n")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--spacing", "tanh"), "--spacing says how a shape becomes edges"),
        (("--model", "hole-o"), "model hole-o makes o grids, and this boundary is quad"),
    ],
)
def test_what_the_library_knows_by_its_name_is_told_by_its_file(
    meshonet: Meshonet, tmp_path: Path, words: tuple[str, ...], message: str
) -> None:
    dataset(tmp_path / "set.h5", "quad", duct(), names=("channel",))
    done = meshonet("infer", "set.h5", *words, "-o", "made.vts")
    assert done.code == 2
    assert done.err.startswith(f"error: set.h5: {message}")


@pytest.mark.parametrize("command", ["tfi", "solve-pde", "infer"])
def test_a_growth_without_first_cell_names_what_there_is(meshonet: Meshonet, command: str) -> None:
    done = meshonet(command, "naca:2412", "--growth", "1.2", "-o", "a.h5")
    assert done.err == "error: --growth without a first cell; give --first-cell or --y-plus as well\n"
