"""Aircraft in TOML: what is read."""

from pathlib import Path

import numpy as np
import pytest

from meshonet.formats.stack import stack_of
from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.fin import Fin
from meshonet.geometry.aircraft.lofted_body import LoftedBody
from meshonet.geometry.errors import InputError

BODY = "[[bodies]]\nmeridian = [[0, 0], [1, 0.5], [4, 0.5], [6, 0]]\n"
SECTIONS = "".join(
    f'[[wings.sections]]\nairfoil = "naca:2412"\nchord = {chord}\nz = {z}\nx = 2\n'
    for chord, z in ((1.5, 0), (1, 4))
)
WING = f'[[wings]]\non = "fuselage"\n{SECTIONS}'


def read(folder: Path, text: str) -> Aircraft:
    (folder / "jet.toml").write_text(f'kind = "aircraft"\n{text}')
    made = stack_of(str(folder / "jet.toml"))
    assert isinstance(made, Aircraft)
    return made


def test_a_body_and_the_sections_of_its_wing_are_read(tmp_path: Path) -> None:
    jet = read(tmp_path, BODY + WING)
    assert (jet.name, jet.body.name, jet.body.y) == ("jet", "fuselage", 0.0)
    assert jet.body.meridian.tolist() == [[0, 0], [1, 0.5], [4, 0.5], [6, 0]]
    assert [section.chord for section in jet.wing.sections] == [1.5, 1.0]


def test_both_halves_are_made_where_the_file_says_so(tmp_path: Path) -> None:
    assert read(tmp_path, BODY + WING).half
    assert read(tmp_path, "half = true\n" + BODY + WING).half
    assert not read(tmp_path, "half = false\n" + BODY + WING).half


def test_meridian_and_wing_may_be_files_beside_it(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "body.csv", [[0, 0], [1, 0.5], [4, 0.5], [6, 0]], delimiter=",")
    (tmp_path / "wing.toml").write_text(SECTIONS.replace("wings.sections", "sections"))
    files = '[[bodies]]\nname = "hull"\ny = 0.2\nmeridian = "body.csv"\n'
    files += '[[wings]]\non = "hull"\nfile = "wing.toml"\n'
    jet, same = read(tmp_path, files), read(tmp_path, BODY + WING)
    assert np.array_equal(jet.body.meridian, same.body.meridian)
    assert (jet.body.name, jet.body.y) == ("hull", 0.2)
    assert np.array_equal(jet.wing.z, same.wing.z)


def test_bodies_may_be_sections_from_nose_to_tail(tmp_path: Path) -> None:
    t = np.linspace(0.0, np.pi, 21)
    half = np.stack([-0.5 * np.cos(t), 0.6 * np.sin(t) * [*np.ones(20), 0.0]], axis=1)
    np.savetxt(tmp_path / "frame.csv", half, delimiter=",")
    oval = "width = 1.4\nheight = 1.2\nexponent = 2.5\n"
    rows = "x = 0\ny = -0.1", f"x = 1\n{oval}", 'x = 4\ny = 0.1\npoints = "frame.csv"', "x = 6\ny = 0.3"
    text = '[[bodies]]\nname = "hull"\n' + "".join(f"[[bodies.sections]]\n{row}\n" for row in rows)
    body = read(tmp_path, text + WING.replace("fuselage", "hull")).body
    assert isinstance(body, LoftedBody)
    nose, cabin, file, tail = body.sections
    assert (nose.is_point, nose.y, tail.is_point, tail.y) == (True, -0.1, True, 0.3)
    assert (cabin.halves, cabin.exponent) == ((0.7, 0.6), 2.5)
    assert file.middle == pytest.approx(0.1)
    assert file.halves == pytest.approx((0.6, 0.5))
    listed = text.replace('"frame.csv"', str(half.tolist()))
    same = read(tmp_path, listed + WING.replace("fuselage", "hull")).body
    assert isinstance(same, LoftedBody)
    assert np.array_equal(same.sections[2].shape, file.shape)


def test_further_wings_have_names_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "tail.toml").write_text(SECTIONS.replace("wings.sections", "sections"))
    jet = read(tmp_path, BODY + WING + '[[wings]]\nname = "tail"\nfile = "tail.toml"\n')
    assert jet.patches == (("wing", "tip"), ("tail", "tail-tip"))
    assert [wing.name for wing in jet.wings] == ["wing", "tail"]
    named = read(tmp_path, BODY + WING.replace("on =", 'name = "left"\non ='))
    assert named.patches == (("left", "tip"),)


FIN = '[[wings]]\nplane = "symmetry"\n' + "".join(
    f'[[wings.sections]]\nairfoil = "naca:0010"\nchord = 1\ny = {y}\n{place}\n'
    for y, place in ((0, "x = 4"), (2, "sweep = 45"))
)


def test_sections_of_a_fin_go_upwards(tmp_path: Path) -> None:
    jet = read(tmp_path, BODY + WING + FIN)
    (fin,) = jet.others
    assert isinstance(fin, Fin)
    assert jet.patches == (("wing", "tip"), ("fin", "fin-tip"))
    assert fin.end == pytest.approx((6.0, 2.0, 0.0))


def test_a_fin_may_be_the_file_of_a_wing(tmp_path: Path) -> None:
    (tmp_path / "fin.toml").write_text(SECTIONS.replace("wings.sections", "sections").replace("2412", "0012"))
    jet = read(tmp_path, BODY + WING + '[[wings]]\nname = "rudder"\nplane = "symmetry"\nfile = "fin.toml"\n')
    assert isinstance(jet.others[0], Fin)
    assert (jet.others[0].name, jet.others[0].end) == ("rudder", (2.0, 4.0, 0.0))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("0010", "2410", "NACA 2410 is not symmetric"),
        ("y = 2", "y = -2", "-2 is not above 0; give sections upwards"),
        ("y = 2", "z = 2", "z"),
        ("symmetry", "vertical", "plane"),
        ('plane = "symmetry"', 'plane = "symmetry"\non = "tail"', "tail is no body"),
        ('plane = "symmetry"', 'plane = "symmetry"\non = "fin"', "a wing on the fin, as in a T-tail"),
    ],
)
def test_fins_that_cannot_be_made_are_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read(tmp_path, BODY + WING + FIN.replace(old, new))
