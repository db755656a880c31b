"""Blade rows that cannot be: each is refused in one line, with file, place, problem and remedy."""

from pathlib import Path

import blade_row
import numpy as np
import pytest
from blade_row import BLADES, HUB, SHROUD, curve, texts, turned
from refusal import assert_refused

from meshonet.formats.stack import stack_of
from meshonet.geometry.rows.row import Row

P = blade_row.profiles()
LINES = curve(*P).splitlines()


def with_line(number: int, text: str, *, instead: bool = True) -> dict[str, str]:
    """The row with a line of its profiles, from 1, replaced, or put before it."""
    lines = list(LINES)
    lines[number - 1 : number - 1 + instead] = [text]
    return texts(blade="\n".join(lines))


def with_profiles(*profiles: np.ndarray) -> dict[str, str]:
    return texts(blade=curve(*profiles))


def flared(points: np.ndarray, slope: float) -> np.ndarray:
    """Points whose radius grows along x."""
    return points * np.stack([np.ones(len(points)), *2 * [1.0 + slope * (points[:, 0] - 0.5)]], axis=1)


def sections(**second: object) -> dict[str, str]:
    """The row of two airfoils on cylinders, the second one with other values."""
    first = {"airfoil": '"naca:0012"', "chord": 1, "radius": 2, "stagger": 20}
    rows = first, first | {"radius": 3} | second
    return texts("".join("[[sections]]\n" + "".join(f"{k} = {v}\n" for k, v in row.items()) for row in rows))


def with_file(name: str, text: str) -> dict[str, str]:
    return texts() | {name: text}


def hub(*points: tuple[float, float]) -> dict[str, str]:
    return texts(f"hub = {[list(p) for p in points]}")


ROW = "row.toml: "
OPEN = r"is open between its first and its last point, .* no blank line or text between them"
CROSSING = "hub and casing cross or turn back near x = "
OUTSIDE = "the hub is outside, at r = .*, the shroud at .*; exchange them, or give both in one unit"
BACKWARDS = "{}: runs from outlet to inlet; give its points from inlet to outlet"
BOTH_BACKWARDS = "hub and shroud run from outlet to inlet, or the axis points the other way; give"
OTHER_UNIT = "lies at r = .*, hub and casing at .*; give all lengths in one unit"
SECOND_BLADE = "give .*all of one blade: splitters are not made"
NOT_LONG = r"hub and casing (end before|begin behind) the blade's point .*; use longer curves"
IN_LINES = r"profile {} \(lines {} to {} of profile.curve\): "
REFUSED = {
    # the table
    "no TOML": ({"row.toml": "kind = row"}, ROW + r"is no TOML: .*line 1"),
    "binary": ({"row.toml": "\1\2"}, ROW + "is no TOML"),
    "a key twice": (texts("blades = 3\nblades = 4"), ROW + "is no TOML: Cannot overwrite"),
    "a misspelt key": (texts("tipgap = 0.1"), ROW + "tipgap: is not known; use kind, name, blades"),
    "a misspelt kind": (texts('kind = "rows"'), ROW + "kind: 'rows' is not known; use wing"),
    "kind a number": (texts("kind = 3"), ROW + "kind: 3 is no text"),
    "nothing but the kind": ({"row.toml": 'kind = "row"'}, ROW + "hub: is missing; name a file"),
    "name a number": (texts("name = 3"), ROW + "name: 3 is no text"),
    "an unknown unit": (texts('unit = "furlong"'), ROW + "unit: 'furlong' is not known; use m, cm"),
    "unknown coordinates": (texts('coordinates = "rtx"'), ROW + "coordinates: 'rtx' is not known"),
    "an axis in capitals": (texts('axis = "X"'), ROW + "axis: 'X' is not known; use x, y, z, -x"),
    "an axis of no direction": (texts("axis = [0, 0, 0]"), ROW + "axis: has no direction"),
    "an axis of two numbers": (texts("axis = [0, 1]"), ROW + r"axis: \[0, 1\] is not 3 numbers"),
    "an axis across the channel": (texts('axis = "z"'), ROW + CROSSING),
    # blades
    "no blades": (texts("blades = 0"), ROW + "blades: 0 blades; use a whole number from 2"),
    "one blade": (texts("blades = 1"), ROW + "blades: 1 blades; use a whole number from 2"),
    "negative blades": (texts("blades = -3"), ROW + "blades: -3 blades; use"),
    "half a blade": (texts("blades = 2.5"), ROW + "blades: 2.5 is no whole number"),
    "blades in quotes": (texts('blades = "36"'), ROW + "blades: '36' is no number"),
    "blades not a number": (texts("blades = nan"), ROW + "blades: nan is out of range"),
    "blades true": (texts("blades = true"), ROW + "blades: True is no number"),
    "a thousand million blades": (texts("blades = 1000000000"), ROW + "blades: 1000000000 blades"),
    "blades that touch": (texts("blades = 400"), ROW + IN_LINES.format(1, 2, 161) + "is 2.494 degrees"),
    # hub and shroud
    "a hub that is not there": (texts('hub = "hubb.csv"'), "hubb.csv: no such file; did you mean 'hub.csv'"),
    "a hub that is a folder": (texts('hub = "."'), "is a folder; name a file in it"),
    "a hub without a name": (texts('hub = ""'), ROW + "hub: is no file and no list of points; name a file"),
    "a hub that is a number": (texts("hub = 3"), ROW + "hub: is no file and no list of points"),
    "an empty list": (hub(), ROW + r"hub: \[\] is not 2 pairs or more"),
    "one point": (hub((-1, 2)), ROW + "hub: .* is not 2 pairs or more"),
    "points of three": (texts("hub = [[-1, 0, 2], [2, 0, 2]]"), ROW + r"hub\[0\]: .* is not 2 numbers"),
    "a point that is no number": (texts("hub = [[-1, 2], [2, nan]]"), ROW + r"hub\[1\]: nan is out of"),
    "a negative radius": (hub((-1, -2), (2, -2)), ROW + "the hub reaches the axis, r = -2; give r > 0"),
    "the hub on the axis": (hub((-1, 0), (2, 0)), ROW + "the hub reaches the axis, r = 0; give r > 0"),
    "the hub outside": (hub((-1, 3.5), (2, 3.5)), ROW + OUTSIDE),
    "hub and shroud crossing": (hub((-1, 2), (2, 3.4)), ROW + CROSSING),
    "hub and shroud exchanged": (texts('hub = "shroud.curve"\nshroud = "hub.csv"'), ROW + OUTSIDE),
    "the hub the other way": (texts(hub=HUB[::-1]), ROW + BACKWARDS.format("hub")),
    "the shroud the other way": (texts(shroud=SHROUD[::-1]), ROW + BACKWARDS.format("shroud")),
    "both the other way": (texts(hub=HUB[::-1], shroud=SHROUD[::-1]), ROW + BOTH_BACKWARDS),
    "a hub that turns back": (texts(hub=np.concatenate([HUB[:15], HUB[5:]])), ROW + CROSSING),
    "a hub that ends in the blade": (texts(hub=HUB[:14]), ROW + IN_LINES.format(1, 2, 161) + NOT_LONG),
    "a hub that begins in it": (texts(hub=HUB[14:]), ROW + IN_LINES.format(1, 2, 161) + NOT_LONG),
    "a shroud that ends in it": (texts(shroud=SHROUD[:14]), ROW + IN_LINES.format(3, 324, 483) + NOT_LONG),
    "a hub in two parts": (
        with_file("hub.csv", "-1,2\n1,2\n\n1,2\n2,2\n"), "hub.csv: holds 2 blocks of points; give one curve"),
    "an empty hub": (with_file("hub.csv", ""), "hub.csv: is empty"),
    "a hub of four numbers": (with_file("hub.csv", "1 2 3 4\n2 3 4 5\n"), "hub.csv: line 1: .* 3 or 2"),
    "a binary hub": (with_file("hub.csv", "1\0 2"), "hub.csv: holds binary data"),
    "a hub in millimetres": (texts(hub=1e3 * HUB, shroud=1e3 * SHROUD), ROW + "profile 1 .*" + OTHER_UNIT),
    "a hub alone in millimetres": (texts(hub=1e3 * HUB), ROW + OUTSIDE),
    "a hub with columns r, x": (
        with_file("hub.csv", "r,x\n2,-1\n2.05,2\n"), "hub.csv: line 1: the columns are r, x; give x, r in"),
    # inlet and outlet
    "an inlet outside": (texts("inlet = -9"), ROW + "inlet: the hub reaches from x = -1 to 2 m, not -9"),
    "an inlet in the blade": (texts("inlet = 0.5"), ROW + "profile 1 .*" + NOT_LONG),
    "an outlet in the blade": (texts("outlet = 0.5"), ROW + "profile 1 .*" + NOT_LONG),
    "an outlet before the inlet": (texts("inlet = 1.9\noutlet = -0.9"), ROW + "outlet: .* before the inlet"),
    "an inlet that is a word": (texts('inlet = "x"'), ROW + "inlet: 'x' is no number"),
    "an inlet that is a point": (texts("inlet = [1, 2]"), ROW + r"inlet: \[1, 2\] is no plane"),
    "an inlet of lists": (texts("inlet = [[1, [2]], [1, 2]]"), ROW + "inlet: .* is no number"),
    # gaps
    "a negative gap": (texts("tip_gap = -0.1"), ROW + "tip_gap: -0.1 is negative"),
    "a gap wider than the span": (texts("tip_gap = 5"), ROW + "tip_gap: gaps of 5 in a channel 0.85 wide"),
    "gaps wider than half of it": (texts("tip_gap = 0.1\nhub_gap = 0.4"), ROW + "hub_gap: gaps of 0.5"),
    "a gap of no number": (texts("tip_gap = nan"), ROW + "tip_gap: nan is out of range"),
    "a gap of nothing": (texts("tip_gap = 1e-15"), ROW + "tip_gap: 1e-15 is less than 1e-06 of the span"),
    "a gap in a list": (texts("tip_gap = [1]"), ROW + r"tip_gap: \[1\] is no number"),
    **{
        f"a gap of {text!r}": (texts(f'tip_gap = "{text}"'), ROW + "tip_gap: .* is no part of the span")
        for text in ("", "1", "%", "1 percent", "1,5 %", "-1 %", "60 %", "1e %", "1 % chord")
    },
    # profiles
    "no file of profiles": (texts("profiles = []"), ROW + "profiles: are no files; name a file"),
    "profiles in the table": (texts("profiles = [[[0, 0, 1], [1, 0, 1]]]"), ROW + "profiles: are no files"),
    "a number among files": (texts('profiles = ["profile.curve", 3]'), ROW + "profiles: are no files"),
    "profiles beside sections": (
        texts('profiles = "profile.curve"\n[[sections]]\nchord = 1'), ROW + "profiles: stands beside"),
    "one profile": (with_profiles(P[0]), ROW + "profiles: 1 of a blade; give two or more"),
    "an empty file": (texts(blade=""), "profile.curve: is empty"),
    "text alone": (texts(blade="# nothing\n"), "profile.curve: holds no points; give 3 numbers a line"),
    "a hub for profiles": (texts('profiles = "hub.csv"'), "hub.csv: line 2: .* is not 3 numbers"),
    "a word in a point": (with_line(6, "0.1 abc 2.0"), "profile.curve: line 6: '0.1 abc 2.0' is no pair"),
    "a point of two": (with_line(6, "0.1 2.0"), "profile.curve: line 6: '0.1 2.0' is not 3 numbers"),
    "a point of four": (with_line(6, "0.1 2 3 4"), "profile.curve: line 6: '0.1 2 3 4' is not 3 numbers"),
    "not a number": (with_line(6, "0.1 nan 2"), "profile.curve: line 6: '0.1 nan 2'"),
    "infinity": (with_line(6, "inf 1 2"), "profile.curve: line 6: 'inf 1 2'"),
    "a number too large": (with_line(6, "1e200 1 2"), "profile.curve: line 6: '1e200 1 2'"),
    "the letter O": (with_line(6, "O.1 1 2"), "profile.curve: line 6: 'O.1 1 2'"),
    "text within": (with_line(41, "here", instead=False), ROW + IN_LINES.format(1, 2, 40) + OPEN),
    "a blank line within": (with_line(41, "", instead=False), ROW + IN_LINES.format(1, 2, 40) + OPEN),
    "half a profile": (with_profiles(P[0][:80], *P[1:]), ROW + IN_LINES.format(1, 2, 81) + OPEN),
    "few points": (with_profiles(P[0][::40], *P[1:]), ROW + IN_LINES.format(1, 2, 5) + "4 points; give 12"),
    "a point far away": (with_line(6, "1e11 1 2"), ROW + IN_LINES.format(1, 2, 161) + r"\d+ different"),
    "one point often": (with_profiles(0 * P[0] + 1, *P[1:]), ROW + "profile 1 .*: 0 different points of 160"),
    "a plate": (
        with_profiles(*(np.concatenate([p[:80], p[79::-1]]) for p in P)), ROW + "profile 1 .*no area"),
    "points out of order": (
        with_profiles(P[0][np.r_[:20, 50:20:-1, 50:160]], *P[1:]), ROW + "profile 1 .*crosses itself near"),
    "profiles out of order": (
        with_profiles(P[0], P[2], P[1], P[3]), ROW + IN_LINES.format(3, 324, 483) + "is at 29.7 % of"),
    "the same profile twice": (with_profiles(P[0], P[0]), ROW + "profile 2 .*, as the one before"),
    "two blades": (
        with_profiles(*P, *(turned(p, 360 / BLADES) for p in P)), ROW + "profile 5 .* of one blade"),
    "a profile of a blade opposite": (
        with_profiles(P[0], turned(P[1], 180), *P[2:]), ROW + "profile 2 .*lies 179.8 degrees around"),
    "profiles that cross": (
        with_profiles(P[0], flared(P[1], 0.4), *P[2:]), ROW + "profile [23] .*crosses the one before"),
    "a profile across the hub": (with_profiles(flared(P[1], 0.3), *P[2:]), ROW + "profile 1 .*begins at"),
    "a profile across the casing": (with_profiles(*P[:2], flared(P[2], 0.2)), ROW + "profile 3 .*ends at"),
    "no profile near the hub": (with_profiles(*P[2:]), ROW + "profile 1 .*nearer to the hub"),
    "no profile near the casing": (with_profiles(*P[:2]), ROW + "profile 2 .*nearer to the casing"),
    "profiles in millimetres": (with_profiles(*(1e3 * p for p in P)), ROW + "profile 1 .*" + OTHER_UNIT),
    "profiles in inches": (with_profiles(*(p / 2.54 for p in P)), ROW + "profile 1 .*" + OTHER_UNIT),
    "columns in another order": (
        with_line(1, "z [m], y [m], x [m]"), "profile.curve: line 1: the columns are z, y, x; give x, y, z"),
    "columns of angles": (
        with_line(1, "# x r theta"), r'profile.curve: line 1: .*; give x, r, theta, .* coordinates = "xrt"'),
    "columns of degrees": (
        texts('coordinates = "xrt"', blade=curve(*P).replace("# Profile 1", "x r theta(deg)")),
        "profile.curve: line 1: theta is in degrees; give it in radians"),
    "columns of x, y, z as angles": (
        texts('coordinates = "xrt"', blade=curve(*P).replace("# Profile 1", "x y z")),
        "profile.curve: line 1: the columns are x, y, z; give x, r, theta in this order"),
    "a splitter": (
        texts(blade="## Main blade\n" + curve(*P) + "## Splitter blade\n" + curve(*P)),
        "profile.curve: line 646: '## Splitter blade' is the heading of a splitter; .* not made"),
    "a second blade": (with_profiles(*P, *(turned(p, 6) for p in P)), ROW + "profile 5 .*" + SECOND_BLADE),
    "profiles behind the channel": (
        with_profiles(*(p + np.array([5, 0, 0]) for p in P)), ROW + "profile 1 .*" + NOT_LONG),
    # airfoils on cylinders
    "one section": (
        texts('[[sections]]\nairfoil = "naca:0012"\nchord = 1\nradius = 2'), ROW + "sections: are not 2"),
    "a chord of nothing": (sections(chord=0), ROW + r"sections\[1\].chord: 0 is not positive"),
    "a negative one": (sections(radius=-2), ROW + r"sections\[1\].radius: -2 is not positive"),
    "a chord of the channel": (sections(chord=100), ROW + r"profile 2 \(sections\[1\]\): " + NOT_LONG),
    "a section across": (sections(stagger=90), ROW + r"sections\[1\].stagger: 90 degrees; use -89 to 89"),
    "a section backwards": (sections(stagger=200), ROW + r"sections\[1\].stagger: 200 degrees; use"),
    "an airfoil that is not there": (
        sections(airfoil='"none.dat"'), ROW + r"sections\[1\].airfoil: none.dat: no such file"),
    "a misspelt key of a section": (sections(stager=1), ROW + r"sections\[1\].stager: is not known"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_row_is_refused_in_one_line(name: str, tmp_path: Path) -> None:
    assert_refused("row.toml", *REFUSED[name], tmp_path)


HARMLESS = {
    "profiles the other way round": with_profiles(*(p[::-1] for p in P)),
    "one profile the other way round": with_profiles(P[0], P[1][::-1], *P[2:]),
    "profiles that start elsewhere": with_profiles(*(np.roll(p, 17 * k, axis=0) for k, p in enumerate(P))),
    "points that are repeated": with_profiles(*(np.repeat(p, 2, axis=0) for p in P)),
    "names of the blade and of profiles": texts(blade="## Main blade\n" + curve(*P).replace("# P", "#P")),
    "names of columns": texts(blade=curve(*P).replace("# Profile 1", "x [m], y [m], z [m]")),
    "names of blades and a comment": texts(blade="## Blade 1\n! from a drawing\n" + curve(*P)),
    "tabs, a mark of bytes and ends of lines as of Windows": texts(
        blade="\ufeff" + curve(*P).replace(" ", "\t").replace("\n", "\r\n")
    ),
    "decimal commas": texts(blade=curve(*P).replace(".", ",")),
    "marks of edges": texts(blade=curve(*P).replace("\n", " le1\n", 2).replace("le1", "", 1)),
    "marks of edges without a number": texts(blade=curve(*P).replace("\n", " le\n", 2).replace("le", "", 2)),
}


@pytest.mark.parametrize("name", HARMLESS)
def test_what_does_not_matter_changes_nothing(name: str, tmp_path: Path) -> None:
    for file, text in HARMLESS[name].items():
        (tmp_path / file).write_text(text)
    row = stack_of(str(tmp_path / "row.toml"))
    assert isinstance(row, Row)
    assert row.changes == ()
    u = np.linspace(0.05, 0.45, 9)
    plain = blade_row.blade_row().surface.section(0.4, u)
    assert row.surface.section(0.4, u) == pytest.approx(plain, abs=1e-5)  # to which edges are found
