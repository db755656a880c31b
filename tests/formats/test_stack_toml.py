"""Stacks of sections in TOML: what is read, and which line an error message names."""

from pathlib import Path

import numpy as np
import pytest

from meshonet.formats.stack import stack_of
from meshonet.geometry.errors import InputError

ROOT = """
[[sections]]
airfoil = "naca:2412"
chord = 1.0
z = 0.0
x = 0.1
"""
TIP = """
[[sections]]
airfoil = "naca:0012"
chord = 0.5
z = 2.0
"""


def read(folder: Path, text: str):
    path = folder / "wing.toml"
    path.write_text(text)
    return stack_of(str(path))


def test_sections_have_their_places_and_defaults(tmp_path):
    stack = read(tmp_path, ROOT + TIP)
    assert (stack.kind, stack.tip, stack.between, stack.name) == ("wing", "round", "linear", "wing")
    root, tip = stack.sections
    assert (root.chord, root.z, root.x, root.y, root.twist, root.about) == (1, 0, 0.1, 0, 0, (0.25, 0))
    assert (tip.chord, tip.z, tip.x, tip.y) == (0.5, 2.0, 0.1, 0.0)  # straight on from the root
    assert (root.shape.name, tip.shape.name) == ("NACA 2412", "NACA 0012")


def test_sweep_and_dihedral_are_angles_from_the_section_before(tmp_path):
    tip = read(tmp_path, ROOT + TIP + "sweep = 45\ndihedral = -30\n").sections[1]
    assert tip.x == pytest.approx(2.1)
    assert tip.y == pytest.approx(-2.0 * np.tan(np.pi / 6))


def test_words_of_the_whole_and_a_place_of_twist_for_all(tmp_path):
    head = 'kind = "wing"\ntip = "flat"\nbetween = "smooth"\nname = "mine"\nabout = 0.4\n'
    stack = read(tmp_path, head + ROOT + "twist = -3\n" + TIP + "about = [1, 0.1]\n")
    assert (stack.tip, stack.between, stack.name) == ("flat", "smooth", "mine")
    assert [section.about for section in stack.sections] == [(0.4, 0.0), (1.0, 0.1)]
    assert stack.sections[0].twist == -3.0


def test_a_cant_for_all_applies_to_all_but_the_root(tmp_path):
    stack = read(tmp_path, 'cant = "panel"\n' + ROOT + TIP + TIP.replace("2.0", "3.0") + "cant = -20\n")
    assert [section.cant for section in stack.sections] == [0.0, "panel", -20.0]


def test_files_of_sections_are_looked_for_beside_the_stack(tmp_path):
    (tmp_path / "deep").mkdir()
    angle = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    points = np.stack([np.cos(angle), 0.2 * np.sin(angle)], axis=1)
    np.savetxt(tmp_path / "deep" / "ellipse.csv", points, delimiter=",")
    stack = read(
        tmp_path / "deep", ROOT.replace("naca:2412", "ellipse.csv").replace("airfoil", "outline") + TIP
    )
    assert stack.sections[0].frame[1] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("about = 0.3", "sections: are not 2 or more tables; write [[sections]] above each"),
        (ROOT, "sections: are not 2 or more tables"),
        ("a = 1 = 2", "is no TOML: "),
        (ROOT + TIP + "colour = 1", "sections[1].colour: is not known; use airfoil, "),
        ('shape = "wing"\n' + ROOT + TIP, "shape: is not known; use kind, "),
        ('kind = "kite"\n' + ROOT + TIP, "kind: 'kite' is not known; use wing, blade, duct"),
        (ROOT + TIP.replace("chord = 0.5", ""), "sections[1].chord: is missing; give a number"),
        (ROOT + TIP.replace("0.5", '"half"'), "sections[1].chord: 'half' is no number"),
        (ROOT + TIP.replace("0.5", "-1"), "sections[1].chord: -1 is not positive"),
        (ROOT + TIP.replace("2.0", "nan"), "sections[1].z: nan is out of range"),
        (ROOT + TIP.replace("2.0", "0.0"), "sections[1].z: 0 is not behind 0"),
        (ROOT + TIP + "x = 1\nsweep = 2", "sections[1].sweep: stands beside x"),
        (ROOT + "dihedral = 2" + TIP, "sections[0].dihedral: there is no section before"),
        (ROOT + TIP + "sweep = 90", "sections[1].sweep: 90 degrees"),
        (ROOT + TIP + 'cant = "up"', "sections[1].cant: 'up' is no number"),
        (ROOT + TIP + "nodes = 1", "sections[1].nodes: 1 nodes; use a whole number from 2"),
        (ROOT + TIP + "nodes = 9.5", "sections[1].nodes: 9.5 nodes"),
        (ROOT + "nodes = 9" + TIP, "sections[0].nodes: there is no panel before the first section"),
        (ROOT + TIP + "cant = 120", "sections[1].cant: 120 degrees; use -90 to 90, or panel"),
        (ROOT + TIP + "about = [1, 2, 3]", "sections[1].about: [1, 2, 3] is not 2 numbers"),
        (ROOT + TIP.replace("naca:0012", "none.dat"), "sections[1].airfoil: "),
        (ROOT + TIP.replace("naca:0012", "naca:99"), "sections[1].airfoil: "),
        (ROOT + TIP.replace('airfoil = "naca:0012"', ""), "sections[1].airfoil: is missing"),
    ],
)
def test_what_is_wrong_is_named_with_its_key(tmp_path, text, problem):
    with pytest.raises(InputError) as refusal:
        read(tmp_path, text)
    message = str(refusal.value)
    assert message.startswith(f"{tmp_path / 'wing.toml'}: {problem}")
    assert "; " in message
    assert "\n" not in message


def test_numbers_that_begin_with_a_point_are_refused_with_how_to_write_them(tmp_path):
    with pytest.raises(InputError, match=r"is no TOML: .*; write numbers as 0\.5"):
        read(tmp_path, ROOT + TIP.replace("0.5", ".5"))
