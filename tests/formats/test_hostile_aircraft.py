"""Aircraft that cannot be: each is refused in one line, with file, place, problem and remedy."""

from pathlib import Path

import pytest
from refusal import assert_refused

MERIDIAN = "meridian = [[0, 0], [0.1, 0.2], [1, 0.5], [4, 0.5], [6, 0]]\n"
ROOT, TIP = (f'[[wings.sections]]\nairfoil = "naca:2412"\nchord = 1.5\nx = 2\nz = {z}\n' for z in (0, 4))
KIND = 'kind = "aircraft"\n'


def texts(*, more: str = "", body: str = MERIDIAN, wing: str = ROOT + TIP) -> dict[str, str]:
    """The file of an aircraft, with these lines in its tables."""
    return {"jet.toml": f"{KIND}{more}\n[[bodies]]\n{body}\n[[wings]]\n{wing}"}


def meridian(points: str) -> dict[str, str]:
    return texts(body=f"meridian = {points}")


def csv(text: str) -> dict[str, str]:
    return meridian('"body.csv"') | {"body.csv": text}


def tip(**values: object) -> dict[str, str]:
    """The aircraft with other values of the last section; None leaves one out."""
    keys = {"airfoil": '"naca:2412"', "chord": 1.5, "x": 2, "z": 4} | values
    lines = "".join(f"{key} = {value}\n" for key, value in keys.items() if value is not None)
    return texts(wing=f"{ROOT}[[wings.sections]]\n{lines}")


def frames(*rows: str, more: str = "") -> dict[str, str]:
    """The aircraft with a body of sections: a nose, these, and a tail."""
    tables = "".join(f"[[bodies.sections]]\n{row}\n" for row in ("x = 0", *rows, "x = 6"))
    return texts(body=more + tables)


def frame(points: object) -> dict[str, str]:
    """The same with a section through points."""
    return frames(OVAL.format(1), f"x = 2\npoints = {points}")


def two_wings(more: str) -> dict[str, str]:
    return {"jet.toml": texts()["jet.toml"] + f"[[wings]]\n{more}\n{ROOT}{TIP}"}


OVAL = "x = {}\nwidth = 1.4\nheight = 1.2"
JET = "jet.toml: "
LINE = JET + r"bodies\[0\].meridian"
FRAME = r"bodies\[0\].sections\[2\]."
WING = JET + r"wings\[0\]."
LAST = WING + r"sections\[1\]."
REFUSED = {
    # the table
    "no TOML": ({"jet.toml": "kind = aircraft"}, JET + "is no TOML: .*line 1"),
    "binary": ({"jet.toml": "\1\2"}, JET + "is no TOML"),
    "nothing": ({"jet.toml": ""}, JET + "is empty"),
    "a misspelt kind": ({"jet.toml": 'kind = "aircaft"'}, JET + "kind: 'aircaft' is not known; use wing"),
    "no kind": ({"jet.toml": texts()["jet.toml"].replace(KIND, "")}, JET + 'kind: .* kind = "aircraft"'),
    "nothing but the kind": ({"jet.toml": KIND}, JET + "bodies: are not one or more tables"),
    "bodies a number": ({"jet.toml": KIND + "bodies = 3"}, JET + "bodies: are not one or more tables"),
    "one table of bodies": ({"jet.toml": KIND + "[bodies]"}, JET + r"bodies: .* write \[\[bodies\]\]"),
    "wings a list of words": ({"jet.toml": KIND + 'wings = ["a"]\n[[bodies]]'}, JET + "wings: are not one"),
    "a body without wings": ({"jet.toml": f"{KIND}[[bodies]]\n{MERIDIAN}"}, JET + "wings: are not one or"),
    "a misspelt key": (texts(more="halff = true"), JET + "halff: is not known; use kind, name, bodies"),
    "name a number": (texts(more="name = 3"), JET + "name: 3 is no text"),
    "an empty name": (texts(more='name = ""'), JET + "name: '' is no text"),
    "half a word": (texts(more='half = "no"'), JET + "half: 'no' is neither true nor false; write true or"),
    "half a number": (texts(more="half = 0"), JET + "half: 0 is neither true nor false"),
    # the body
    "a misspelt key of a body": (texts(body=MERIDIAN + "radius = 1"), JET + r"bodies\[0\].radius: is not"),
    "no meridian": (texts(body="y = 0"), LINE + ": is no file and no list of points; name a file"),
    "a meridian that is a number": (meridian("3"), LINE + ": is no file and no list of points"),
    "a meridian without a name": (meridian('""'), LINE + ": '' is no text"),
    "an empty list": (meridian("[]"), LINE + r": \[\] is not 4 pairs or more"),
    "three points": (meridian("[[0, 0], [1, 1], [2, 0]]"), LINE + ": .* is not 4 pairs or more"),
    "numbers without brackets": (meridian("[0, 1, 2, 3]"), LINE + r"\[0\]: 0 is not 2 numbers"),
    "points of three": (meridian("[[0, 0], [1, 1, 0], [2, 1], [3, 0]]"), LINE + r"\[1\]: .* is not 2"),
    "a word in a point": (meridian('[[0, 0], [1, "a"], [2, 1], [3, 0]]'), LINE + r"\[1\]: 'a' is no number"),
    "true in a point": (meridian("[[0, 0], [1, true], [2, 1], [3, 0]]"), LINE + r"\[1\]: True is no"),
    "not a number": (meridian("[[0, 0], [1, nan], [2, 1], [3, 0]]"), LINE + r"\[1\]: nan is out of range"),
    "a number too large": (meridian("[[0, 0], [1, 1e13], [2, 1], [3, 0]]"), LINE + r"\[1\]: .* out of"),
    "tail first": (meridian("[[6, 0], [4, 1], [1, 1], [0, 0]]"), LINE + ": point 2: x is 4 behind 6; give"),
    "a disc": (meridian("[[0, 0], [1, 1], [1, 0.5], [3, 0]]"), LINE + ": point 3: x is 1 behind 1"),
    "a negative radius": (meridian("[[0, 0], [1, 1], [2, -1], [3, 0]]"), LINE + ": point 3: a radius of -1"),
    "a waist on the axis": (meridian("[[0, 0], [1, 1], [2, 0], [3, 0]]"), LINE + ": point 3: a radius of 0"),
    "an open tail": (meridian("[[0, 0], [1, 1], [2, 1], [3, 0.5]]"), LINE + ": radii of 0 and 0.5 at"),
    "a body of nothing": (meridian("[[0, 0], [1e-14, 1], [2e-14, 1], [3e-14, 0]]"), LINE + ": 3e-14 long"),
    "points far apart at a blunt nose": (
        meridian("[[0, 0], [1e-6, 1], [2, 1], [3, 0]]"), LINE + ": points 1 and 2: the spline .* points"),
    "a file that is not there": (meridian('"bodyy.csv"'), "bodyy.csv: no such file"),
    "a folder": (meridian('"."'), "is a folder; name a file in it"),
    "an empty file": (csv(""), "body.csv: is empty"),
    "text alone": (csv("# nothing\n"), "body.csv: holds no points; give 2 numbers a line"),
    "words in a file": (csv("0 0\n1 a\n2 1\n3 0\n"), "body.csv: line 2: '1 a' is no pair of numbers"),
    "lines of three": (csv("0 0 0\n1 1 0\n2 1 0\n"), "body.csv: line 1: '0 0 0' is not 2 numbers"),
    "two curves": (csv("0 0\n1 1\n\n2 1\n3 0\n"), "body.csv: holds 2 blocks of points; give one curve"),
    "a binary file": (csv("0\0 0"), "body.csv: holds binary data"),
    "a height that is a word": (texts(body=MERIDIAN + 'y = "a"'), JET + r"bodies\[0\].y: 'a' is no number"),
    "a height of infinity": (texts(body=MERIDIAN + "y = inf"), JET + r"bodies\[0\].y: inf is out of range"),
    "a body called a number": (texts(body=MERIDIAN + "name = 3"), JET + r"bodies\[0\].name: 3 is no text"),
    "a body called wing": (
        texts(body=MERIDIAN + 'name = "wing"'), JET + r"bodies\[0\].name: wing is the name of another patch"),
    "an escape in a name": (
        texts(body=MERIDIAN + 'name = "a\\u001b[31m"'),
        JET + r"bodies\[0\].name: 'a\\x1b\[31m' has control characters; leave them out"),
    "two lines in a name": (texts(body=MERIDIAN + 'name = "a\\nb"'), JET + r"bodies\[0\].name: 'a\\nb' has"),
    "two bodies": ({"jet.toml": texts()["jet.toml"] + f"[[bodies]]\n{MERIDIAN}"}, JET + r"bodies\[1\]"),
    # the sections of a body
    "a section and a meridian": (
        frames(OVAL.format(1), OVAL.format(2), more=MERIDIAN), r"0\].meridian: is not known; use"),
    "three sections": (frames(OVAL.format(1)), r"0\].sections: are not 4 or more tables"),
    "sections a number": (texts(body="sections = 3"), r"0\].sections: are not 4 or more tables"),
    "a misspelt key of a section": (frames(OVAL.format(1), "x = 2\nwidht = 3"), FRAME + "widht: is not"),
    "a section without x": (frames(OVAL.format(1), "width = 3"), FRAME + "x: is missing"),
    "a width alone": (frames(OVAL.format(1), "x = 2\nwidth = 3"), FRAME + "height: 0; give width and height"),
    "a negative height": (
        frames(OVAL.format(1), "x = 2\nwidth = 3\nheight = -1"), FRAME + "height: -1 is negative"),
    "an exponent of nothing": (
        frames(OVAL.format(1), OVAL.format(2) + "\nexponent = 0"), FRAME + "exponent: 0 is out of range"),
    "a point within": (frames(OVAL.format(1), "x = 2"), FRAME + "width: a point within the body; give"),
    "sections in one place": (frames(OVAL.format(1), OVAL.format(1)), FRAME + "x: 1 is not behind 1; give"),
    "a section behind the tail": (frames(OVAL.format(1), OVAL.format(7)), r"3\].x: 6 is not behind 7"),
    "an open nose": (
        texts(body="".join(f"[[bodies.sections]]\n{OVAL.format(x)}\n" for x in range(5))),
        r"bodies\[0\].sections\[0\]: the nose is no point; leave out"),
    "a flat section": (
        frames(OVAL.format(1), "x = 2\nwidth = 9\nheight = 1"), FRAME[:-1] + ": a section 9 wide"),
    "sections far apart": (
        frames(*(OVAL.format(x) for x in (1e-4, 2e-4, 0.0005))), r"bodies\[0\].sections\[0\]: the surface"),
    "points that are a number": (frame(3), FRAME + r"points: is no file and no list of points; .*\[\[y, z\]"),
    "points and a width": (frames(OVAL.format(1), "x = 2\npoints = []\nwidth = 1"), FRAME + "width: is"),
    "few points": (frame("[[0, 0], [1, 1], [2, 0]]"), FRAME + r"points: .* is not 5 pairs .* \[\[y, z\]"),
    "points of both halves": (
        frame("[[-1, 0], [0, 1], [1, 0], [0, -1], [-1, 0]]"), FRAME + "points: .*give the half z >= 0"),
    "points that are open": (
        frame("[[-1, 0], [-0.7, 0.7], [0, 1], [0.3, 1], [0.7, 0.7]]"), FRAME + "points: ends at z=0"),
    "a box": (
        frame("[[-1, 0], [-1, 0.5], [-1, 1], [0, 1], [1, 1], [1, 0]]"), FRAME + "points: turns by 90 deg"),
    "points in a file that is not there": (frame('"frame.csv"'), FRAME + "points: .*frame.csv: no such file"),
    # the wing
    "two wings of one name": (two_wings(""), JET + r"wings\[1\].name: wing is the name of another patch"),
    "a wing called as the body": (two_wings('name = "fuselage"'), JET + r"bodies\[0\].name: fuselage is the"),
    "a wing called tip": (two_wings('name = "tip"'), JET + r"wings\[1\].name: tip is the name of another"),
    "a wing with an escape": (two_wings('name = "a\\u001b"'), JET + r"wings\[1\].name: 'a\\x1b' is no name"),
    "a fault in the second wing": (
        two_wings('name = "tail"\ntip = "open"'), JET + r"wings\[1\].tip: a wing of an aircraft has a tip"),
    "a wing on a number": (texts(wing=f"on = 3\n{ROOT}{TIP}"), WING + "on: 3 is no text"),
    "a wing on another body": (
        texts(wing=f'on = "hull"\n{ROOT}{TIP}'), WING + "on: hull is no body; use fuselage"),
    "an open tip": (texts(wing=f'tip = "open"\n{ROOT}{TIP}'), WING + "tip: a wing of an aircraft has a tip"),
    "a blade": (texts(wing=f'kind = "blade"\n{ROOT}{TIP}'), WING + "kind: a blade is no wing"),
    "a misspelt key of a wing": (texts(wing=f"sweeep = 3\n{ROOT}{TIP}"), WING + "sweeep: is not known"),
    "one section": (texts(wing=ROOT), WING + r"sections: are not 2 or .* \[\[wings.sections\]\] above each"),
    "a wing that is not there": (texts(wing='file = "wing.toml"'), "wing.toml: no such file"),
    "a wing that is the aircraft": (texts(wing='file = "jet.toml"'), "jet.toml: bodies: is not known"),
    "an empty file of a wing": (texts(wing='file = "wing.toml"') | {"wing.toml": ""}, "wing.toml: is empty"),
    "a fault in the file of a wing": (
        texts(wing='file = "wing.toml"') | {"wing.toml": ROOT.replace("wings.", "") + "[[sections]]\n"},
        r"wing.toml: sections\[1\].z: is missing"),
    "a file beside sections": (texts(wing=f'file = "w.toml"\n{ROOT}{TIP}'), WING + "sections: is not known"),
    "sections in one plane": (tip(z=0), LAST + "z: 0 is not behind 0"),
    "a section without z": (tip(z=None), LAST + "z: is missing"),
    "a chord of nothing": (tip(chord=0), LAST + "chord: 0 is not positive"),
    "a tip that is a point": (tip(chord=1e-6), LAST + "chord: a chord of 1e-06; use at least 0.02"),
    "no airfoil": (tip(airfoil=None), LAST + "airfoil: is missing"),
    "an outline": (
        tip(airfoil=None, outline='"circle:0.1"'), LAST + "outline: a closed curve has no trailing edge"),
    "an airfoil that is not there": (tip(airfoil='"none.dat"'), LAST + "airfoil: none.dat: no such file"),
    "a sweep of 90 degrees": (tip(sweep=90, x=None), LAST + "sweep: 90 degrees; use -85 to 85"),
    "a sweep beside x": (tip(sweep=9), LAST + "sweep: stands beside x"),
    "a twist that is a word": (tip(twist='"a"'), LAST + "twist: 'a' is no number"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_aircraft_is_refused_in_one_line(name: str, tmp_path: Path) -> None:
    assert_refused("jet.toml", *REFUSED[name], tmp_path)
