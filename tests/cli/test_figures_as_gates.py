"""`--fail-on` takes every figure that is printed, beside one or several of `--profile`."""

import re
from pathlib import Path

import pytest
from command_line import Meshonet

from meshonet.geometry.quality.figures import COUNTS, FIGURES
from meshonet.geometry.quality.metrics import ALL_NAMES
from meshonet.geometry.quality.profiles import PROFILES
from meshonet.geometry.quality.report import COMPARED, Y_PLUS

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "quality.md"


@pytest.fixture
def c_vts(meshonet: Meshonet) -> Path:
    """A C grid around an airfoil, with a box ratio beyond the 1000 of checkMesh."""
    words = ("--topology", "c", "--te", "wedge", "--res", "121x71", "--first-cell", "1e-5", "--growth", "1.3")
    words = (*words, "--far-field", "200")
    assert meshonet("infer", "naca:2412", *words, "-o", "c.vts", "-q").code == 0
    return Path("c.vts")


@pytest.mark.parametrize("profile", PROFILES)
def test_every_figure_of_a_profile_is_gated_at_the_value_it_prints(
    meshonet: Meshonet, c_vts: Path, profile: str
) -> None:
    checks = meshonet("quality", c_vts, "--profile", profile, "--json").only["profile"]["checks"]
    for check in checks:
        name, value = check["figure"], check["value"]
        sense = check["limits"][0]["when"][0]
        for limit, code in ((value - abs(value) * 1e-6 - 1e-9, 1), (value + abs(value) * 1e-6 + 1e-9, 0)):
            expected = code if sense == ">" else 1 - code
            done = meshonet("quality", c_vts, "-q", "--fail-on", f"{name}{sense}{limit!r}")
            assert done.code == expected, (name, sense, limit, done.err)
            if expected:
                assert done.err.startswith(f"gate not met: c.vts: {name}")


def test_a_limit_of_the_user_replaces_that_of_the_profile_and_the_tables_say_so(
    meshonet: Meshonet, c_vts: Path
) -> None:
    words = ("quality", c_vts, "--profile", "openfoam")
    before = meshonet(*words, "--summary").out
    assert re.search(r"warn     non_orthogonality \S+ > 70, box_ratio \S+ > 1000$", before, re.MULTILINE)
    (check,) = (c for c in meshonet(*words, "--json").only["profile"]["checks"] if c["figure"] == "box_ratio")
    above, below = f"box_ratio>{check['value'] * 1.1:.6g}", f"box_ratio>{check['value'] * 0.9:.6g}"
    accepted = meshonet(*words, "--fail-on", above, "--fail-on", "non_orthogonality>89", "--summary")
    assert accepted.code == 0
    assert accepted.out.splitlines()[-1] == "verdicts: 1 pass"
    limit = f"{float(above.split('>')[1]):g}"
    assert (
        f"--fail-on in place of the profile's limit: non_orthogonality > 89, box_ratio > {limit}"
        in accepted.out
    )
    (row,) = (r for r in meshonet(*words, "--fail-on", above).out.splitlines() if r.startswith("box_ratio"))
    assert "1000" not in row
    assert row.endswith(f"fail > {limit} (--fail-on)     pass")
    refused = meshonet(*words, "--fail-on", below)
    assert (refused.code, refused.err.count("box_ratio is")) == (1, 1)
    assert "profile openfoam" not in refused.err


def test_a_limit_on_a_mean_or_of_the_other_sense_leaves_that_of_the_profile(
    meshonet: Meshonet, c_vts: Path
) -> None:
    for gate in ("min_angle.mean<1", "min_angle>179", "far_field>1e9"):
        done = meshonet("quality", c_vts, "--profile", "viscous", "--fail-on", gate)
        assert "(--fail-on)" not in done.out, gate
        assert "warn < 100" in done.out


def test_profiles_given_together_are_all_judged_in_one_table(meshonet: Meshonet, c_vts: Path) -> None:
    words = ("quality", c_vts, "--profile", "viscous", "--profile", "openfoam")
    done = meshonet(*words)
    assert done.code == 1
    assert "profile viscous: wall_growth is" in done.err  # the first of them, which a second dropped
    checks = meshonet(*words, "--json").only["profile"]["checks"]
    names = [check["figure"] for check in checks]
    assert names[0] == "folded"
    assert names.count("folded") == 1
    assert set(names) == {check.figure for name in ("viscous", "openfoam") for check in PROFILES[name]}
    assert "profile viscous, openfoam" in done.out
    assert {check["profile"] for check in checks} == {"viscous", "openfoam"}
    made = meshonet("infer", "naca:0012", "--res", "41x15", *words[2:], "-o", "g.h5")
    assert "profile viscous: wall_growth is" in made.err


def test_gates_on_growth_name_direction_and_place(meshonet: Meshonet, c_vts: Path) -> None:
    greatest = meshonet("quality", c_vts, "--json").only["growth"]
    for gate, along in (
        ("wall_growth", "eta"),
        ("growth", max(("xi", "eta"), key=lambda x: greatest[x]["max"])),
    ):
        i, j = greatest[along]["at"]
        where = f" along {along} at i={i}, j={j}"
        done = meshonet("quality", c_vts, c_vts, "--summary", "--fail-on", f"{gate}>1.01")
        assert f"{gate} is {greatest[along]['max']:.6g}{where}, which fails --fail-on" in done.err
        assert f"{gate} {greatest[along]['max']:.4g} > 1.01{where}" in done.out


def test_gates_on_growth_of_blocks_name_the_block(meshonet: Meshonet) -> None:
    Path("disc.wkt").write_text(
        "POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (1.5 1.5, 1.5 2.5, 2.5 2.5, 2.5 1.5, 1.5 1.5))", encoding="utf-8"
    )
    assert meshonet("infer", "disc.wkt", "--cells", "600", "-o", "d.h5", "-q").code == 0
    growth = meshonet("quality", "d.h5", "--json").only["growth"]
    along = max((name for name in growth if growth[name]), key=lambda name: growth[name]["max"])
    block, i, j = growth[along]["at"]
    done = meshonet("quality", "d.h5", "-q", "--fail-on", "growth>1")
    assert f" along {along} at block={block}, i={i}, j={j}, which fails --fail-on" in done.err


def test_a_surface_has_no_faces_to_gate(meshonet: Meshonet) -> None:
    import numpy as np

    from meshonet.formats.vtk.vts import write
    from meshonet.geometry.blocks.grid import Grid

    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    write(Path("s.vts"), Grid.from_nodes(np.stack([x, y, x * y], axis=-1)))
    for words in (("--fail-on", "box_ratio>3"), ("--profile", "openfoam")):
        done = meshonet("quality", "s.vts", *words)
        assert (done.code, done.err.count("\n")) == (2, 1)
        assert "a surface has no faces between cells" in done.err


def test_the_page_on_quality_lists_every_name_that_can_be_gated() -> None:
    section = PAGE.read_text(encoding="utf-8").split("## Gates")[1].split("\n## ")[0]
    listed = set(re.findall(r"`(\w+)`", section))
    assert {*COUNTS, *ALL_NAMES, *FIGURES, *COMPARED, Y_PLUS} <= listed


def test_a_gate_on_y_plus_refers_to_the_flow(meshonet: Meshonet) -> None:
    words = "infer", "naca:0012", "--res", "81x33", "--first-cell", "1e-4", "-o", "g.h5", "-q"
    assert meshonet(*words).code == 0
    flow = "--reynolds", "1e6", "--length", "2"
    (wall,) = meshonet("quality", "g.h5", *flow, "--json").only["walls"]
    most = wall["y_plus"]["max"]
    for limit, code in ((0.99 * most, 1), (1.01 * most, 0)):
        assert meshonet("quality", "g.h5", *flow, "-q", "--fail-on", f"y_plus>{limit}").code == code
    done = meshonet("quality", "g.h5", *flow)
    assert "y+ at Re 1e+06 on 2" in done.out
    done = meshonet("quality", "g.h5", "--fail-on", "y_plus>1")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert "y_plus" in done.err
    done = meshonet("quality", "g.h5", "--length", "2")
    assert (done.code, "give --reynolds as well" in done.err) == (2, True)
