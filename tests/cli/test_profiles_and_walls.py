"""`meshonet quality --profile`, and the cells at the walls."""

import re
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet, dataset, wave

from meshonet.formats.registry import read_grids
from meshonet.geometry.quality.profiles import PROFILES
from meshonet_cli.app import application


@pytest.fixture
def grid_vts(meshonet: Meshonet, body_h5: Path) -> Path:
    """A marched O grid around an ellipse."""
    assert meshonet("solve-pde", body_h5, "--res", "81x60", "--wall-spacing", "1e-4", "-o", "g.vts").code == 0
    return Path("g.vts")


def test_the_walls_are_always_told(meshonet: Meshonet, grid_vts: Path) -> None:
    (row,) = meshonet("quality", grid_vts, "--json").only["walls"]
    (grid,) = read_grids("g.vts")
    heights = np.linalg.norm(grid.nodes[:, 1] - grid.nodes[:, 0], axis=1)
    assert (row["name"], row["side"]) == ("wall", "south")
    assert row["first_cell"]["min"] == pytest.approx(heights.min(), rel=1e-12)
    assert row["first_cell"]["max"] == pytest.approx(heights.max(), rel=1e-12)
    assert 0 <= row["off_square"]["mean"] < 10
    assert "wall: first cell    0.0001  0.0001" in meshonet("quality", grid_vts).out


@pytest.mark.parametrize("profile", PROFILES)
def test_each_threshold_is_told_with_its_figure(meshonet: Meshonet, grid_vts: Path, profile: str) -> None:
    done = meshonet("quality", grid_vts, "--profile", profile)
    table = done.out[done.out.index(f"profile {profile}") :].splitlines()
    assert len(table) == 1 + len(PROFILES[profile])
    for line, check in zip(table[1:], PROFILES[profile], strict=True):
        assert line.startswith(check.figure)
        assert all(f"{limit.level} {limit.compare} {limit.value:g}" in line for limit in check.limits)
        assert re.search(r"(pass|warn|FAIL)$", line)
    report = meshonet("quality", grid_vts, "--profile", profile, "--json").only
    assert report["profile"]["name"] == profile
    assert [row["figure"] for row in report["profile"]["checks"]] == [c.figure for c in PROFILES[profile]]
    assert done.code == (0 if report["profile"]["passed"] else 1)
    assert report["growth"]["eta"]["max"] > report["growth"]["eta"]["mean"] > 1


def test_a_failed_profile_exits_with_one(meshonet: Meshonet, tmp_path: Path) -> None:
    meshonet("tfi", dataset(tmp_path / "wave.h5", "quad", wave()), "-o", "l.vts", "--allow-invalid", "-q")
    done = meshonet("quality", "l.vts", "--profile", "pointwise", "--fail-on", "max_angle>100")
    assert done.code == 1
    assert "gate not met: l.vts: max_angle.max is" in done.err
    assert "gate not met: l.vts: profile pointwise: skewness is" in done.err
    assert ", and it must not be >= 0.9" in done.err
    assert "FAIL" in done.out


def test_warnings_do_not_fail(meshonet: Meshonet, grid_vts: Path) -> None:
    report = meshonet("quality", grid_vts, "--profile", "viscous", "--json")
    verdicts = {row["figure"]: row["verdict"] for row in report.only["profile"]["checks"]}
    assert verdicts["far_field"] == "warn"
    assert report.code == (1 if "fail" in verdicts.values() else 0)


def test_the_choices_are_those_of_the_library() -> None:
    option = next(p for p in application().commands["quality"].params if "--profile" in p.opts)
    assert tuple(option.type.choices) == tuple(PROFILES)


def test_quads_have_walls_where_they_are_named(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("tfi", duct_h5, "-o", "d.vts")
    (grid,) = read_grids("d.vts")
    assert [part.name for part in grid.walls()] == ["south", "north"]
    named = [type(part)("lower wall" if part.name == "south" else part.name, part.side, part.start, part.stop)
             for part in grid.patches]  # fmt: skip
    assert [part.name for part in grid.from_nodes(grid.nodes, patches=tuple(named)).walls()] == ["lower wall"]


@pytest.mark.parametrize(
    "words",
    [
        "naca:2412 --res 120x60",
        "naca:0012 --res 120x60",
        "naca:2412 --topology c --res 160x60",
        "naca:2412 --topology c --te exact --first-cell 1e-4 --res 301x60",
        "{flatback} --topology o --first-cell 1e-4 --res 201x60",
        "{flatback} --topology c --first-cell 1e-4 --res 301x80",
        "{square} --topology o --res 81x60",
        "{square} --topology o --first-cell 1e-3 --res 81x60",
        "naca:0012 --cells 1500",
    ],
)
def test_a_far_field_passes_the_gate_of_its_own_distance(meshonet: Meshonet, words: str) -> None:
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 41)))
    half = 0.25 * np.sqrt(x) * (1.6 - 1.1 * x)
    upper, lower = np.stack([x, half], axis=1), np.stack([x, -half], axis=1)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    np.savetxt("flatback.dat", np.concatenate([upper[::-1], lower[1:]]), header="flatback", comments="")
    np.savetxt("square.csv", square)
    words = words.format(flatback="flatback.dat", square="square.csv")
    gate = ("--far-field", "50", "--fail-on", "far_field<50", "-o", "g.h5")
    done = meshonet("infer", *words.split(), *gate)
    assert done.code == 0, done.err
    (value,) = (
        check["value"]
        for check in meshonet("quality", "g.h5", "--profile", "viscous", "--json").only["profile"]["checks"]
        if check["figure"] == "far_field"
    )
    assert value < 53.0
