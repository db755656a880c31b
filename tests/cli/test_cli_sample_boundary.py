"""`meshonet sample-boundary`."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from command_line import Meshonet, duct

from meshonet.geometry.families.family import FAMILIES
from meshonet.geometry.spacing.laws import LAWS


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


@pytest.mark.parametrize("law", [law for law in LAWS if law != "auto"])
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


@pytest.mark.parametrize("name", [*FAMILIES, "procedural"])
def test_a_family_becomes_a_dataset(meshonet: Meshonet, name: str) -> None:
    done = meshonet("sample-boundary", "--family", name, "--count", "3", "--res", "41x21", "-o", "b.h5")
    assert done.code == 0
    assert "3 done" in done.err
    with h5py.File("b.h5") as file:
        assert file["south"].shape == (3, 41, 2)
        assert file["west"].shape == (3, 21, 2)
        edges = [np.concatenate([file[side][k] for side in ("south", "north", "west")]) for k in (0, 1)]
        assert not np.array_equal(*edges)
        if name != "procedural":
            assert len(np.unique(file["parameters"][:, 0])) == 3


def test_the_range_holds_the_parameters(meshonet: Meshonet) -> None:
    words = ("--family", "arch", "--count", "20", "--range", "0.1:0.2", "--res", "21")
    meshonet("sample-boundary", *words, "-o", "b.h5")
    with h5py.File("b.h5") as file:
        heights = file["parameters"][:, 0]
        assert (heights >= 0.1).all()
        assert (heights <= 0.2).all()
        assert np.ptp(heights) > 0.05
        np.testing.assert_allclose(file["north"][:, 10, 1], 1 + heights, atol=1e-12)


def test_the_seed_decides_the_members(meshonet: Meshonet) -> None:
    def made(seed: int, count: int) -> np.ndarray:
        words = ("--family", "hole", "--count", count, "--seed", seed, "--res", "21", "-o", "b.h5")
        assert meshonet("sample-boundary", *words).code == 0
        with h5py.File("b.h5") as file:
            return np.array(file["parameters"])

    np.testing.assert_array_equal(made(1, 4), made(1, 4))
    np.testing.assert_array_equal(made(1, 4), made(1, 6)[:4])  # whichever others are drawn
    assert not np.array_equal(made(1, 4), made(2, 4))


def test_a_family_gives_101_nodes_and_names(meshonet: Meshonet) -> None:
    report = meshonet(
        "sample-boundary", "--family", "hole", "--count", "2", "-o", "{name}.h5", "--json"
    ).objects
    assert [(item["ni"], item["nj"], item["output"]) for item in report] == [
        (101, 101, "hole-0.h5"),
        (101, 101, "hole-1.h5"),
    ]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--family", "tree"), "--family: family 'tree' is not known; use one of arch, hexagon"),
        (("--family", "arch", "--range", "2:1"), "--range: '2:1' is not a range; use A:B with A <= B"),
        (("--family", "arch", "--range", "a:b"), "--range: 'a:b' is not a range"),
        (("--family", "arch", "--range", "5:90"), "--range: 5:90 leaves what height"),
        (("--family", "procedural", "--range", "0:1"), "--range: random shapes have no parameter"),
        (("naca:0012", "--family", "arch"), "both a source and --family; give one of them"),
        (("naca:0012", "--range", "0:1"), "--range without --family; give --family as well, or drop --range"),
        (("naca:0012", "--split", "random"), "--split without --family; give --family as well"),
        (("naca:0012", "--count", "3"), "--count without --family; give --family as well"),
        (("naca:0012", "--seed", "3"), "--seed without --family; give --family as well"),
        (("naca:0012", "--from", "paper"), "'paper'"),
        ((), "neither a source nor --family; give one of them"),
        (("--family", "arch", "--count", "0"), "count"),
    ],
)
def test_mistakes_get_a_line(meshonet: Meshonet, words: tuple[str, ...], message: str) -> None:
    done = meshonet("sample-boundary", *words, "-o", "b.h5")
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1
    assert not Path("b.h5").exists()


def test_sensors_are_kept_beside_the_edges_and_the_file_still_reads(meshonet: Meshonet) -> None:
    words = ("sample-boundary", "--family", "hexagon", "--count", "2", "--sensors", "50")
    assert meshonet(*words, "-o", "b.h5").code == 0
    with h5py.File("b.h5") as file:
        assert file["sensors"].shape == (2, 50, 2)
        np.testing.assert_array_equal(file["sensors"][1, 0], file["south"][1, 0])
    assert meshonet("tfi", "b.h5", "-o", "g.h5").code == 0


def test_sensors_need_hdf5(meshonet: Meshonet) -> None:
    done = meshonet("sample-boundary", "naca:0012", "--sensors", "20", "-o", "b.csv")
    assert done.code == 2
    assert not Path("b.csv").exists()


@pytest.mark.parametrize(
    ("family", "way"), [("arch", "extrapolation"), ("wrench", "extrapolation"), ("hole", "random")]
)
def test_a_split_is_kept_and_goes_on_to_grids(meshonet: Meshonet, family: str, way: str) -> None:
    words = ("--family", family, "--count", "12", "--res", "21", "--split", way)
    assert meshonet("sample-boundary", *words, "-o", "b.h5").code == 0
    assert meshonet("tfi", "b.h5", "--allow-invalid", "-o", "g.h5").code == 0
    for path in ("b.h5", "g.h5"):
        with h5py.File(path) as file:
            values, kept = file["parameters"][:, 0], file["split"].asstr()[:]
            assert list(file["parameters"].attrs["names"]) == ["parameter"]
        assert sorted(set(kept)) == ["test", "train"]
        assert (kept == "test").sum() == 2
        if way == "extrapolation":
            ends = np.sort(values)[:2] if family == "wrench" else np.sort(values)[-2:]
            np.testing.assert_array_equal(np.sort(values[kept == "test"]), ends)
    assert len(meshonet("quality", "g.h5#test", "--json").objects) == 2
    assert len(meshonet("quality", "g.h5#train", "--json").objects) == 10


def test_splits_that_cannot_be_are_refused(meshonet: Meshonet) -> None:
    for words, report in (
        (("--family", "arch", "--count", "2", "--split", "random"), "--split: 2 members cannot be split"),
        (("--family", "arch", "--count", "9", "--split", "x"), "--split: split 'x' is not known; use interp"),
        (("--family", "procedural", "--count", "9", "--split", "random"), "--split: random shapes have no"),
    ):
        done = meshonet("sample-boundary", *words, "-o", "b.h5")
        assert done.code == 2
        assert report in done.err
    meshonet("sample-boundary", "--family", "arch", "--count", "2", "--res", "9", "-o", "b.h5")
    assert "b.h5: no sample is marked 'test'; mark samples" in meshonet("tfi", "b.h5#test", "-o", "g.h5").err
    meshonet("tfi", "naca:0012", "--res", "40x20", "-o", "g.vts")
    report = meshonet("quality", "g.vts#test").err
    assert "g.vts: vts files do not say which samples are to test; leave #test out" in report


@pytest.mark.parametrize(
    "words", [("--seed", "0"), ("--count", "1"), ("--range", "0:1"), ("--split", "random")]
)
def test_what_only_a_family_needs_is_refused_without(
    meshonet: Meshonet, duct_h5: Path, words: tuple[str, str]
) -> None:
    done = meshonet("sample-boundary", duct_h5, *words, "-o", "b.h5")
    message = f"error: {words[0]} without --family; give --family as well, or drop {words[0]}\n"
    assert (done.code, done.err) == (2, message)
