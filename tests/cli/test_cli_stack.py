"""``meshonet stack``: from sections in TOML to volumes and surfaces."""

import re
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

import meshonet as library
from meshonet.formats.registry import read_grids
from meshonet.formats.stack import stack_of
from meshonet.geometry.aircraft.aircraft import Aircraft

SECTIONS = """
[[sections]]
airfoil = "naca:2412"
chord = 2.0
z = 0.0

[[sections]]
airfoil = "naca:0012"
chord = 1.0
z = 3.0
sweep = 20
"""
SMALL = ("--around", "33", "--span", "9", "--first-cell", "0.004")
FINER = ("--around", "49", "--span", "13", "--first-cell", "0.002")


@pytest.fixture
def wing(tmp_path: Path) -> Path:
    path = tmp_path / "wing.toml"
    path.write_text(SECTIONS)
    return path


def test_a_wing_is_valid_with_its_names_first_cells_and_far_field(meshonet: Meshonet, wing: Path) -> None:
    done = meshonet("stack", str(wing), *SMALL, "-o", "wing.h5", "--json")
    assert done.code == 0, done.err
    assert done.only["folded"] == 0
    assert done.only["method"] == "hyperbolic"
    (grid,) = read_grids("wing.h5")
    assert {patch.name for patch in grid.patches} == {"wing", "tip", "symmetry", "farfield"}
    first = [np.linalg.norm(block.nodes[:, :, 1] - block.nodes[:, :, 0], axis=-1) for block in grid.blocks]
    assert np.concatenate([each.ravel() for each in first]) == pytest.approx(0.008, rel=1e-9)
    far = grid.blocks[0].nodes[:, :, -1]
    assert np.linalg.norm(far - [1.0, 0.0, 1.5], axis=-1).min() > 20.0


@pytest.mark.parametrize(
    "words",
    [
        "--cells 30000",
        "--cells 60000 --growth 1.4",
        "--cells 25000 --around 65 --tip open",
        "--cells 30000 --span 21 --layers 20",
    ],
)
def test_cells_of_a_wing_are_about_those_wanted(meshonet: Meshonet, wing: Path, words: str) -> None:
    done = meshonet("stack", str(wing), *words.split(), "--first-cell", ".01", "-o", "w.h5")
    assert done.code == 0, done.err
    (grid,) = read_grids("w.h5")
    made = sum(int(np.prod(np.array(block.counts) - 1)) for block in grid.blocks)
    assert made == pytest.approx(int(words.split()[1]), rel=0.1)
    counts = grid.blocks[0].counts
    for option, kept in (("--around", counts[0]), ("--span", counts[1]), ("--layers", counts[2])):
        assert option not in words or f"{option} {kept}" in words
    assert "cells in all" not in done.err


def test_cells_of_a_wing_that_its_layers_exceed_are_noted_with_the_least(
    meshonet: Meshonet, wing: Path
) -> None:
    words = ("--first-cell", "0.01", "--growth", "1.3", "-o", "w.h5", "--json")
    few = meshonet("stack", str(wing), "--cells", "2000", *words).only
    (note,) = (note for note in few["notes"] if "cells in all" in note)
    match = re.fullmatch(r"(\d+) layers of cells need at least (\d+) cells in all, more than 2000", note)
    assert match is not None
    (grid,) = read_grids("w.h5")
    assert sum(int(np.prod(np.array(block.counts) - 1)) for block in grid.blocks) == int(match[2])
    assert {block.counts[2] - 1 for block in grid.blocks} == {int(match[1])}
    enough = meshonet("stack", str(wing), "--cells", match[2], *words).only
    assert not any("cells in all" in note for note in enough["notes"])


def test_cells_of_blades_are_counted_and_those_of_ducts_are_not(meshonet: Meshonet, wing: Path) -> None:
    Path("blade.toml").write_text('kind = "blade"\n' + SECTIONS)
    assert meshonet("stack", "blade.toml", "--cells", "20000", "-o", "b.h5", "-q").code == 0
    (grid,) = read_grids("b.h5")
    assert int(np.prod(np.array(grid.blocks[0].counts) - 1)) == pytest.approx(20000, rel=0.1)
    section = '[[sections]]\noutline = "circle:0.5"\nchord = {}\nz = {}\n'
    Path("duct.toml").write_text('kind = "duct"\n' + section.format(1, 0) + section.format(1.6, 2))
    for file, more, line in (
        ("duct.toml", (), "a duct has no --cells; leave --cells out"),
        (wing, ("--around", "65", "--span", "9"), "give two of them at most"),
    ):
        done = meshonet("stack", str(file), "--cells", "20000", *more, "-o", "none.h5")
        assert (done.code, line in done.err, Path("none.h5").exists()) == (2, True, False)


def test_changed_trailing_edges_are_told_and_y_plus_says_its_height(meshonet: Meshonet, wing: Path) -> None:
    done = meshonet("stack", str(wing), *SMALL[:4], "--y-plus", "90", "--reynolds", "1e5", "-o", "w.h5")
    assert done.code == 0, done.err
    assert "NACA 2412 is changed: its trailing edge" in done.err
    assert "y+ 90 at Re 100000 on a chord of 2 needs first cells of height" in done.err


def test_z_of_a_duct_can_be_an_angle_and_that_of_a_wing_cannot(meshonet: Meshonet, wing: Path) -> None:
    section = '[[sections]]\noutline = "circle:0.5"\nchord = {}\ny = 2\nz = {}\n'
    Path("duct.toml").write_text('kind = "duct"\n' + section.format(1, 0) + section.format(1.6, 2))
    done = meshonet(
        "stack", "duct.toml", "--revolve", "120", "--around", "33", "--span", "9", "-o", "d.h5", "-q"
    )
    assert done.code == 0, done.err
    (grid,) = read_grids("d.h5")
    ends = [patch for patch in grid.patches if patch.name in ("inlet", "outlet")]
    assert {patch.side for patch in ends} == {"bottom", "top"}
    last = grid.blocks[0].nodes[:, :, -1]
    assert np.degrees(np.arctan2(last[..., 2], last[..., 1])) == pytest.approx(np.full(last.shape[:2], 120.0))
    refused = meshonet("stack", str(wing), *SMALL, "--revolve", "90", "-o", "w.h5")
    assert (refused.code, "--revolve: a wing is not turned about an axis" in refused.err) == (2, True)


def test_the_surface_alone_is_what_solve_pde_marches_from(meshonet: Meshonet, wing: Path) -> None:
    assert meshonet("stack", str(wing), *FINER[:4], "--surface", "-o", "surface.h5", "-q").code == 0
    (surface,) = read_grids("surface.h5")
    assert [block.counts for block in surface.blocks] == [(49, 13), (49, 7), (17, 9)]
    words = "solve-pde surface.h5 --method hyperbolic --wall-spacing 0.004 --far-field 30 -o volume.h5 -q"
    assert meshonet(*words.split()).code == 0
    assert meshonet("stack", str(wing), *FINER, "-o", "wing.h5", "-q").code == 0
    (volume,), (made,) = read_grids("volume.h5"), read_grids("wing.h5")
    assert [block.counts for block in volume.blocks] == [block.counts for block in made.blocks]


def test_the_function_makes_what_the_command_writes(meshonet: Meshonet, wing: Path) -> None:
    assert meshonet("stack", str(wing), *SMALL, "-o", "wing.h5", "-q").code == 0
    (written,) = read_grids("wing.h5")
    made = library.stack(wing, around=33, span=9, first_cell=0.004)
    for one, two in zip(written.blocks, made.blocks, strict=True):
        assert np.array_equal(one.nodes, two.nodes)


def test_a_gate_ends_with_1(meshonet: Meshonet, wing: Path) -> None:
    done = meshonet("stack", str(wing), *SMALL, "-o", "wing.h5", "-q", "--fail-on", "max_angle>91")
    assert done.code == 1
    assert "gate not met" in done.err


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("--around", "50"), "--around: 50 nodes around a section"),
        (("--span", "2"), "--span: 2 nodes"),
        (("--base", "0"), "--base: a base of 0 chords"),
        (("--far-field", "0.5"), "--far-field: 0.5 chords"),
        (("--first-cell", "0"), "--first-cell: a first cell of 0"),
        (
            ("--first-cell", "1e-3", "--y-plus", "1", "--reynolds", "1e6"),
            "--first-cell and --y-plus both say",
        ),
        (("--y-plus", "1"), "--y-plus without --reynolds"),
        (("--layers", "9", "--growth", "1.2"), "--layers and --growth both say"),
        (
            ("--surface", "--fail-on", "folded>0"),
            "--fail-on and --profile judge cells, and a surface has none",
        ),
    ],
)
def test_values_that_do_not_fit_get_a_line(
    meshonet: Meshonet, wing: Path, words: tuple[str, ...], problem: str
) -> None:
    done = meshonet("stack", str(wing), *words, "-o", "wing.h5")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert problem in done.err
    assert not Path("wing.h5").exists()


FEW_LAYERS = ("--around", "33", "--span", "9", "--first-cell", "0.02", "--growth", "1.5", "--far-field", "6")
AIRCRAFT = """kind = "aircraft"
[[bodies]]
meridian = [[0, 0], [0.1, 0.3], [0.5, 0.55], [2, 0.6], [5, 0.6], [8, 0.4], [9.6, 0.1], [10, 0]]
[[wings]]
on = "fuselage"
""" + SECTIONS.replace("sections", "wings.sections").replace("z = 0.0", "z = 0.0\nx = 3.5")


def test_a_body_with_a_wing_is_made_with_its_names(meshonet: Meshonet, tmp_path: Path) -> None:
    (tmp_path / "jet.toml").write_text(AIRCRAFT)
    done = meshonet("stack", "jet.toml", *FEW_LAYERS, "-o", "jet.cgns", "--json")
    assert done.code == 0, done.err
    assert (done.only["folded"], done.only["method"]) == (0, "aircraft")
    assert "the tip of the wing is flat" in str(done.only["notes"])
    sizes = done.only["aircraft"]
    assert (sizes["length"], sizes["spans"]) == (10.0, {"wing": 6.0})
    (grid,) = read_grids("jet.cgns")
    assert {patch.name for patch in grid.patches} == {"fuselage", "wing", "tip", "symmetry", "farfield"}


def test_a_whole_aircraft_has_no_plane_of_symmetry_and_a_closed_surface(
    meshonet: Meshonet, tmp_path: Path
) -> None:
    (tmp_path / "jet.toml").write_text("half = false\n" + AIRCRAFT)
    done = meshonet("stack", "jet.toml", *FEW_LAYERS, "-o", "jet.cgns", "--json")
    assert (done.code, done.only["folded"]) == (0, 0), done.err
    (grid,) = read_grids("jet.cgns")
    assert {patch.name for patch in grid.patches} == {"fuselage", "wing", "tip", "farfield"}
    low, high = grid.box
    assert low[2] == -high[2]
    assert meshonet("stack", "jet.toml", *FEW_LAYERS, "--surface", "-o", "surface.cgns", "-q").code == 0
    (surface,) = read_grids("surface.cgns")
    sides = [len(ranges) for ranges in surface.joined_ranges()]
    assert (min(sides), surface.outer_patches()) == (4, [])


def _flux_of_z(nodes: np.ndarray) -> float:
    """The flux of (0, 0, z) through a patch: together that of a closed surface is its volume."""
    one, two = nodes[1:, 1:] - nodes[:-1, :-1], nodes[:-1, 1:] - nodes[1:, :-1]
    middle = 0.25 * (nodes[1:, 1:] + nodes[:-1, :-1] + nodes[:-1, 1:] + nodes[1:, :-1])[..., 2]
    return float((0.5 * np.cross(one, two)[..., 2] * middle).sum())


def test_the_surface_of_a_body_with_a_wing_is_that_of_its_volume(meshonet: Meshonet, tmp_path: Path) -> None:
    (tmp_path / "jet.toml").write_text(AIRCRAFT)
    words = "--around 49 --span 5 --first-cell 0.02 --growth 1.5 --far-field 6 --surface -q"
    assert meshonet("stack", "jet.toml", *words.split(), "-o", "surface.cgns").code == 0
    (surface,) = read_grids("surface.cgns")
    names = surface.provenance["zones"]
    assert set(names) == {"fuselage", "wing", "tip"}
    volumes = [_flux_of_z(block.nodes) for block in surface.blocks]
    assert min(volume for volume, name in zip(volumes, names, strict=True) if name != "wing") > 0.0
    jet = stack_of("jet.toml")
    assert isinstance(jet, Aircraft)
    x, r = jet.body.meridional(np.linspace(0.0, jet.body.length, 999)).T
    chord = np.linspace(2.0 - 0.6 / 3.0, 1.0, 99)  # of the wing outside of the body
    wing = 0.0817 * np.trapezoid(chord**2, dx=2.4 / 98)  # area of NACA 2412 over its chord squared
    assert sum(volumes) == pytest.approx(0.5 * np.pi * np.trapezoid(r * r, x) + wing, rel=0.03)
    ends = [surface.face(patch.block, patch.side) for patch in surface.patches if patch.name == "symmetry"]
    assert ends
    assert not any(end[..., 2].any() for end in ends)


@pytest.mark.parametrize(
    "words",
    ["--layers 31", "--copies 2", "--cells 5000 --around 65", "--tip round", "--revolve 20"],
)
def test_options_of_other_stacks_are_refused_for_a_body_with_a_wing(
    meshonet: Meshonet, tmp_path: Path, words: str
) -> None:
    (tmp_path / "jet.toml").write_text(AIRCRAFT)
    done = meshonet("stack", "jet.toml", *words.split(), "-o", "jet.cgns")
    assert done.code == 2
    assert words.split()[0] in done.err
    assert not (tmp_path / "jet.cgns").exists()


@pytest.mark.parametrize(
    ("change", "words", "problem"),
    [
        (("z = 0.0", "z = 0.7"), (), "wings: a line of the wing begins outside of the fuselage at x="),
        (("z = 3.0", "z = 0.3"), (), "wings: a line of the wing does not leave the fuselage at x="),
        (("z = 3.0", "z = 30"), (), "--far-field: the tip of the wing is 31.4439"),
        (("x = 3.5", "x = -1"), (), "wings: a line of the wing begins outside of the fuselage"),
        ((), ("--first-cell", "0.2"), "--first-cell: first cells are 0.4 high at a wing with a chord of"),
    ],
)
def test_a_wing_that_does_not_fit_its_body_gets_a_line(
    meshonet: Meshonet, tmp_path: Path, change: tuple[str, str], words: tuple[str, ...], problem: str
) -> None:
    (tmp_path / "jet.toml").write_text(AIRCRAFT.replace(*change) if change else AIRCRAFT)
    done = meshonet("stack", "jet.toml", "--far-field", "4", *words, "-o", "jet.cgns")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert f"error: jet.toml: {problem}" in done.err
    assert not (tmp_path / "jet.cgns").exists()


@pytest.mark.parametrize(
    ("place", "where"),
    [
        ("x = -1", "ahead of its nose: it is from x=0 to 10"),
        ("x = 9", "behind its tail: it is from x=0 to 10"),
        ("x = 3\ny = 2", r"2\.1\d+ from its axis, where its radius is 0\.6"),  # its highest line
    ],
)
def test_a_wing_outside_of_the_body_is_said_to_be_where_it_is(
    meshonet: Meshonet, tmp_path: Path, place: str, where: str
) -> None:
    (tmp_path / "jet.toml").write_text(AIRCRAFT.replace("x = 3.5", place))
    done = meshonet("stack", "jet.toml", "-o", "jet.cgns")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert re.search(f"{where}; give a first section inside the body", done.err)


def test_the_warnings_of_a_profile_are_in_the_report(meshonet: Meshonet, wing: Path) -> None:
    done = meshonet("stack", str(wing), *SMALL, "--profile", "viscous", "-o", "wing.h5")
    assert done.code == 0, done.err
    (far_field,) = (line.split() for line in done.err.splitlines() if "far_field" in line)
    assert far_field[-4:] == ["warn", "<", "100", "warn"]


@pytest.mark.parametrize("kind", ["wing", "surface", "blade", "duct", "aircraft"])
def test_lines_left_out_of_a_section_file_are_noted_with_its_name(
    meshonet: Meshonet, tmp_path: Path, kind: str
) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 65)[:-1]
    circle = np.column_stack([0.5 + 0.5 * np.cos(angle), 0.5 * np.sin(angle)])
    points = circle if kind == "duct" else library.read("naca:2412").curve.points
    lines = [f"{x:.6f} {y:.6f}" for x, y in points]
    name = "root.csv" if kind == "duct" else "root.dat"
    (tmp_path / name).write_text("\n".join(["# a root", *lines[:20], "0.8000 .......", *lines[20:]]))
    text = (AIRCRAFT if kind == "aircraft" else SECTIONS).replace("naca:2412", name)
    words = FEW_LAYERS
    if kind == "surface":
        words = [*SMALL[:4], "--surface"]
    elif kind == "duct":
        words = ["--around", "33", "--span", "9"]
        text = text.replace("sweep = 20\n", "").replace("airfoil", "outline").replace("naca:0012", "circle:1")
    if kind in ("blade", "duct"):
        text = f'kind = "{kind}"\n{text}'
    (tmp_path / "made.toml").write_text(text)
    note = f"{name}: line 22, '0.8000 .......', is no pair of numbers and is left out"
    done = meshonet("stack", "made.toml", *words, "-o", "made.cgns")
    assert done.code == 0, done.err
    assert note in [line.strip() for line in done.err.splitlines()]
    report = meshonet("stack", "made.toml", *words, "-o", "made.cgns", "--json").only
    assert note in report["notes"]
    (grid,) = read_grids("made.cgns")
    assert note in grid.provenance["changes"]


@pytest.mark.parametrize("output", ["wing.stl", "wing.png"])
def test_a_format_without_volumes_is_refused_before_the_work(
    meshonet: Meshonet, tmp_path: Path, output: str
) -> None:
    (tmp_path / "wing.toml").write_text('kind = "wing"\n')  # which would be refused later
    done = meshonet("stack", tmp_path / "wing.toml", "-o", tmp_path / output)
    assert done.code == 2
    assert "files hold grids in the plane" in done.err
    assert output in done.err
    assert not (tmp_path / output).exists()
