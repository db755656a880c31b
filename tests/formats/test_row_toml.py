"""Rows of blades in TOML: what is read, and which place is named where something is not right."""

import re
from dataclasses import replace
from pathlib import Path

import blade_row
import numpy as np
import pytest

import meshonet
from meshonet.formats.stack import stack_of
from meshonet.geometry.errors import InputError
from meshonet.geometry.rows.dimensions import row_dimensions
from meshonet.geometry.rows.row import Row

SECTIONS = "".join(
    f'\n[[sections]]\nairfoil = "naca:0012"\nchord = 1.0\nradius = {radius}\nstagger = 30\nx = 0.3\n'
    for radius in (1.95, 2.5, 3.02)
)


def read(folder: Path, more: str = "") -> Row:
    row = stack_of(str(blade_row.write_row(folder, more)))
    assert isinstance(row, Row)
    return row


def test_a_curve_file_has_a_profile_a_block_and_walls_may_be_csv(tmp_path: Path) -> None:
    row = read(tmp_path)
    assert (row.blades, row.name, row.tip_gap, row.hub_gap) == (blade_row.BLADES, "row", 0.0, 0.0)
    assert len(row.profiles) == 4
    assert all(map(np.array_equal, row.profiles, blade_row.profiles()))
    assert row.hub == pytest.approx(blade_row.HUB, abs=1e-15)
    assert row.shroud == pytest.approx(blade_row.SHROUD, abs=1e-15)


def test_profiles_may_be_files_each_and_marks_of_edges_are_left_out(tmp_path: Path) -> None:
    names = []
    for number, points in enumerate(blade_row.profiles()):
        lines = ["x,y,z", *("{:.17g},{:.17g},{:.17g}".format(*p) for p in points)]
        if number == 0:
            lines[3] += " le1"
        (tmp_path / f"p{number}.csv").write_text("\n".join(lines))
        names.append(f"p{number}.csv")
    row = read(tmp_path, f"profiles = {names}".replace("'", '"'))
    assert all(map(np.array_equal, row.profiles, blade_row.profiles()))


def test_the_axis_may_be_z_and_lengths_in_millimetres(tmp_path: Path) -> None:
    path = blade_row.write_row(tmp_path, 'axis = "z"\nunit = "mm"\ntip_gap = 5')
    for name in ("profile.curve", "shroud.curve"):
        lines = (tmp_path / name).read_text().splitlines()
        moved = [line if line.startswith("#") else turned(line) for line in lines]
        (tmp_path / name).write_text("\n".join(moved))
    (tmp_path / "hub.csv").write_text("\n".join(f"{1000 * x},{1000 * r}" for x, r in blade_row.HUB))
    row = stack_of(str(path))
    assert isinstance(row, Row)
    for own, given in zip(row.profiles, blade_row.profiles(), strict=True):
        assert own == pytest.approx(given, abs=1e-12)
    assert row.tip_gap == pytest.approx(0.005)


def test_python_reads_a_row_and_changes_one_thing(tmp_path: Path) -> None:
    row = meshonet.read_stack(blade_row.write_row(tmp_path, 'unit = "cm"\ntip_gap = 0.02'))
    assert isinstance(row, Row)
    wider = replace(row, tip_gap=2.0 * row.tip_gap)
    assert wider.tip_gap == pytest.approx(4e-4)
    assert (wider.blades, wider.unit, wider.name) == (row.blades, "cm", "row")
    assert wider.channel.tip < row.channel.tip


def test_inlet_and_outlet_may_be_places_along_the_axis(tmp_path: Path) -> None:
    row = read(tmp_path, "inlet = -0.45\noutlet = 1.5")
    for wall, whole in ((row.hub, blade_row.HUB), (row.shroud, blade_row.SHROUD)):
        assert wall[[0, -1], 0] == pytest.approx([-0.45, 1.5], abs=1e-12)
        assert wall[:, 1] == pytest.approx(np.interp(wall[:, 0], *whole.T), abs=1e-9)


def test_inlet_and_outlet_may_be_points_on_hub_and_shroud(tmp_path: Path) -> None:
    row = read(tmp_path, "outlet = [[1.4, 2.04], [1.6, 2.92]]")
    assert (row.hub[0, 0], row.shroud[0, 0]) == (-1.0, -1.0)
    assert (row.hub[-1, 0], row.shroud[-1, 0]) == pytest.approx((1.4, 1.6), abs=1e-3)


@pytest.mark.parametrize(
    "words", ["outlet = 2.7", "outlet = [[2.7, 2.0616666666666665], [2.7, 2.8766666666666665]]"]
)
def test_walls_go_on_straight_to_an_outlet_beyond_their_ends(tmp_path: Path, words: str) -> None:
    row = read(tmp_path, f'{words}\nunit = "cm"')
    for wall, whole, name in ((row.hub, blade_row.HUB, "hub"), (row.shroud, blade_row.SHROUD, "shroud")):
        x, r = 100.0 * wall.T
        slope = (whole[-1, 1] - whole[0, 1]) / 3.0
        assert x[[0, -1]] == pytest.approx([-1.0, 2.7], abs=1e-3)  # points are met to 1/4000 of the wall
        assert r == pytest.approx(whole[0, 1] + slope * (x + 1.0), abs=1e-9)
        assert f"{name} is continued straight by 0.70" in " ".join(row.changes)


def test_a_curved_wall_goes_on_in_the_direction_of_its_end(tmp_path: Path) -> None:
    t = np.linspace(-1.0, 2.0, 61)
    bend = np.stack([t, 2.0 + 0.05 * (t + 1.0) ** 2 / 3.0], axis=1)
    (tmp_path / "bend.csv").write_text("".join("{:.17g},{:.17g}\n".format(*p) for p in bend))
    row = read(tmp_path, 'hub = "bend.csv"\noutlet = 3.0')
    beyond = row.hub[row.hub[:, 0] > 2.0]
    assert len(beyond) > 10
    assert beyond[:, 1] == pytest.approx(2.15 + 0.1 * (beyond[:, 0] - 2.0), abs=2e-4)


@pytest.mark.parametrize(
    ("key", "words"),
    [
        (
            "inlet = -9",
            "inlet: the hub reaches from x = -1 to 2 m, not -9; add points to hub and shroud, or give",
        ),
        ('inlet = -9\nunit = "mm"', "from x = -1 to 2 mm, not -9"),
        ("inlet = [1, 2, 3]", "is no plane"),
        ("outlet = [[1.4, 2.9], [1.6, 2.92]]", "from the hub"),
        ("inlet = 1.8\noutlet = 1.6", "the outlet is before the inlet"),
    ],
)
def test_planes_that_are_none_are_named(tmp_path: Path, key: str, words: str) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        read(tmp_path, key)


def test_walls_may_be_listed(tmp_path: Path) -> None:
    path = blade_row.write_row(tmp_path)
    text = path.read_text().replace('"hub.csv"', "[[-1, 2.0], [2, 2.05]]")
    path.write_text(text.replace('"shroud.curve"', "[[-1, 3], [-1, 3], [2, 2.9]]"))
    row = stack_of(str(path))
    assert isinstance(row, Row)
    assert row.hub.tolist() == [[-1.0, 2.0], [2.0, 2.05]]
    assert row.channel.at(np.array([0.5]), np.array([1.0]))[0] == pytest.approx([0.5, 2.95])


def test_theta_is_in_radians(tmp_path: Path) -> None:
    path = blade_row.write_row(tmp_path, 'coordinates = "xrt"')
    for unit in (1.0, 180.0 / np.pi):
        text = ""
        for x, y, z in (p for points in blade_row.profiles() for p in [points.T]):
            rows = np.stack([x, np.hypot(y, z), unit * np.arctan2(z, y)], axis=1)
            text += "profile\n" + "".join("{:.17g} {:.17g} {:.17g}\n".format(*row) for row in rows)
        (tmp_path / "profile.curve").write_text(text)
        if unit == 1.0:
            row = stack_of(str(path))
            assert isinstance(row, Row)
            assert row.profiles[2] == pytest.approx(blade_row.profiles()[2], abs=1e-14)
        else:
            with pytest.raises(InputError, match=r"coordinates: theta of a profile spans .* in radians"):
                stack_of(str(path))


def turned(line: str) -> str:
    x, y, z = (1000.0 * float(word) for word in line.split())
    return f"{y!r} {z!r} {x!r}"


def test_gaps_may_be_parts_of_the_span(tmp_path: Path) -> None:
    row = read(tmp_path, 'tip_gap = "2 %"\nhub_gap = 0.01')
    assert row.tip_gap == pytest.approx(0.02 * row_dimensions(row).span, rel=1e-3)
    assert row.hub_gap == 0.01


@pytest.mark.parametrize("planes", ["", "inlet = -0.5\noutlet = 1.2"])
def test_parts_of_the_span_are_of_the_span_at_the_blade(tmp_path: Path, planes: str) -> None:
    row = read(tmp_path, 'tip_gap = "2 %"')
    path = blade_row.write_row(tmp_path, f'tip_gap = "2 %"\n{planes}')
    share = np.linspace(0.0, 1.0, 200) ** 4  # nearly all at the inlet
    (tmp_path / "hub.csv").write_text("".join(f"{3 * t - 1},{2 + 0.05 * t}\n" for t in share))
    other = stack_of(str(path))
    assert isinstance(other, Row)
    assert other.tip_gap == pytest.approx(row.tip_gap, rel=1e-6)


def test_airfoils_on_cylinders_have_chord_and_stagger_and_round_edges(tmp_path: Path) -> None:
    row = read(tmp_path, SECTIONS)
    points = np.asarray(row.profiles[1])
    assert np.hypot(points[:, 1], points[:, 2]) == pytest.approx(2.5, abs=1e-12)
    x, arc = points[:, 0], 2.5 * np.arctan2(points[:, 1], points[:, 2])
    ends = x.argmin(), x.argmax()
    slope = (arc[ends[1]] - arc[ends[0]]) / (x[ends[1]] - x[ends[0]])
    assert np.degrees(np.arctan(slope)) == pytest.approx(30.0, abs=1.0)
    assert np.hypot(np.ptp(x), np.ptp(arc)) == pytest.approx(1.0, abs=0.03)
    assert any("its trailing edge" in note for note in row.notes)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("pitch = 2", "pitch: is not known"),
        ('tip_gap = "two"', "tip_gap: 'two' is no part of the span"),
        ("tip_gap = -1", "tip_gap: -1 is negative"),
        ("tip_gap = 0.8", "gaps of 0.8 in a channel"),
        ('axis = "w"', "axis: 'w' is not known; use x, y, z"),
        ('unit = "mile"', "unit: 'mile' is not known"),
        ('profiles = "none.csv"', "none.csv: no such file"),
        ('profiles = "hub.csv"', "hub.csv: line 2: .* is not 3 numbers"),
        (SECTIONS.split("[[sections]]")[0] + "[[sections]]\nradius = 2.0", "sections"),
        (SECTIONS.replace("radius = 2.5", "radius = 1.9"), r"profile 2 \(sections.1.\): .* give profiles"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_named_with_its_place(tmp_path: Path, more: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read(tmp_path, more)


def test_blades_have_to_be_counted(tmp_path: Path) -> None:
    path = blade_row.write_row(tmp_path)
    for count, words in (("2.5", "blades: 2.5 is no whole number"), ("1", "blades: 1 blades; use a")):
        text = path.read_text()
        path.write_text(text.replace(f"blades = {blade_row.BLADES}", f"blades = {count}"))
        with pytest.raises(InputError, match=words):
            stack_of(str(path))
        path.write_text(text)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('kind = "row"\n', "", 'kind: is missing, and a wing has no blades; write kind = "row"'),
        ('"hub.csv"', "[[-1, 2]]", r"hub: .* is not 2 pairs or more; give \[\[x, r\], \[x, r\]\]"),
        ('"hub.csv"', "[[-1, 2], [2]]", r"hub\[1\]: \[2\] is not 2 numbers"),
        ('"hub.csv"', "[[2, 2.05], [-1, 2]]", "hub: runs from outlet to inlet"),
        ('"hub.csv"', "[[-1, 2], [-1, 2]]", "hub: a curve of 1 points"),
    ],
)
def test_what_a_file_says_of_walls_and_kind_is_checked(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    path = blade_row.write_row(tmp_path)
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(InputError, match=words):
        stack_of(str(path))


def test_lines_left_out_of_the_file_of_a_section_are_noted_with_its_name(tmp_path: Path) -> None:
    lines = [f"{x:.6f} {y:.6f}" for x, y in meshonet.read("naca:0012").curve.points]
    (tmp_path / "root.dat").write_text("\n".join(["a root", *lines[:20], "0.8000 .......", *lines[20:]]))
    row = read(tmp_path, SECTIONS.replace("naca:0012", "root.dat", 1))
    note = "root.dat: line 22, '0.8000 .......', is no pair of numbers and is left out"
    assert row.notes.count(note) == 1
