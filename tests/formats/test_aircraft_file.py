"""Aircraft in TOML: what is read."""

from pathlib import Path

import numpy as np

from meshonet.formats.stack import stack_of
from meshonet.geometry.aircraft.aircraft import Aircraft

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


def test_further_wings_have_names_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "tail.toml").write_text(SECTIONS.replace("wings.sections", "sections"))
    jet = read(tmp_path, BODY + WING + '[[wings]]\nname = "tail"\nfile = "tail.toml"\n')
    assert jet.patches == (("wing", "tip"), ("tail", "tail-tip"))
    assert [wing.name for wing in jet.wings] == ["wing", "tail"]
    named = read(tmp_path, BODY + WING.replace("on =", 'name = "left"\non ='))
    assert named.patches == (("left", "tip"),)
