"""`meshonet sample-boundary`."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from conftest import Meshonet, duct


def test_a_shape_becomes_a_boundary_dataset(meshonet: Meshonet) -> None:
    done = meshonet("sample-boundary", "naca:0012", "-o", "b.h5", "--res", "81x31")
    assert (done.code, done.out) == (0, "")
    assert "81 x 31 nodes, o" in done.err
    with h5py.File("b.h5") as file:
        assert (file.attrs["format"], file.attrs["version"], file.attrs["topology"]) == (
            "meshonet-boundary",
            1,
            "o",
        )
        assert file["south"].shape == (1, 81, 2)
        assert file["west"].shape == (1, 31, 2)
        np.testing.assert_array_equal(file["west"][0], file["east"][0])
        np.testing.assert_array_equal(file["south"][0, 0], file["south"][0, -1])
        np.testing.assert_array_equal(file["south"][0, 0], file["west"][0, 0])
        radius = np.linalg.norm(file["north"][0] - [0.5, 0], axis=1)
        np.testing.assert_allclose(radius, 15, rtol=1e-6)


def test_far_field_is_in_chords(meshonet: Meshonet) -> None:
    meshonet("sample-boundary", "naca:0012", "-o", "b.h5", "--far-field", "30")
    with h5py.File("b.h5") as file:
        radius = np.linalg.norm(file["north"][0] - [0.5, 0], axis=1)
        np.testing.assert_allclose(radius, 30, rtol=1e-6)


@pytest.mark.parametrize("law", ["conformal", "uniform", "cosine", "tanh", "curvature"])
def test_spacing_moves_the_wall_nodes(meshonet: Meshonet, law: str) -> None:
    assert meshonet("sample-boundary", "naca:2412", "-o", "b.h5", "--spacing", law).code == 0
    assert meshonet("sample-boundary", "naca:2412", "-o", "auto.h5").code == 0
    with h5py.File("b.h5") as file, h5py.File("auto.h5") as auto:
        assert np.isfinite(file["south"][:]).all()
        assert law == "conformal" or not np.array_equal(file["south"][:], auto["south"][:])


def test_edge_spacings_are_kept(meshonet: Meshonet) -> None:
    words = ("--le-spacing", "0.002", "--te-spacing", "0.001", "--res", "201")
    meshonet("sample-boundary", "naca:2412", "-o", "b.h5", *words)
    with h5py.File("b.h5") as file:
        wall = file["south"][0]
    steps = np.linalg.norm(np.diff(wall, axis=0), axis=1)
    leading = np.argmin(wall[:, 0])
    assert steps[leading] == pytest.approx(0.002, rel=0.2)
    assert steps[leading - 1] == pytest.approx(0.002, rel=0.2)


def test_given_nodes_are_used_as_they_are(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("sample-boundary", duct_h5, "-o", "b.h5")
    with h5py.File("b.h5") as file:
        for side, nodes in duct().items():
            np.testing.assert_array_equal(file[side][0], nodes)


def test_several_shapes_become_one_dataset(meshonet: Meshonet) -> None:
    done = meshonet(
        "sample-boundary", "naca:0012", "naca:4412", "naca:9999x", "-o", "b.h5", "--res", "60", "--json"
    )
    assert done.code == 2
    assert [item.get("ni") for item in done.objects] == [60, 60, None]
    with h5py.File("b.h5") as file:
        assert file["south"].shape == (2, 60, 2)


def test_a_format_without_boundaries_is_refused(meshonet: Meshonet) -> None:
    done = meshonet("sample-boundary", "naca:0012", "-o", "b.vts")
    assert done.code == 2
    assert "vts cannot hold boundaries; write one of hdf5" in done.err
