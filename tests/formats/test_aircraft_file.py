"""Aircraft in TOML: what is read, and faults with their place."""

from pathlib import Path

import numpy as np
import pytest

from meshonet.formats.stack import stack_of
from meshonet.geometry.aircraft.aircraft import Aircraft
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


def test_meridian_and_wing_may_be_files_beside_it(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "body.csv", [[0, 0], [1, 0.5], [4, 0.5], [6, 0]], delimiter=",")
    (tmp_path / "wing.toml").write_text(SECTIONS.replace("wings.sections", "sections"))
    files = '[[bodies]]\nname = "hull"\ny = 0.2\nmeridian = "body.csv"\n'
    files += '[[wings]]\non = "hull"\nfile = "wing.toml"\n'
    jet, same = read(tmp_path, files), read(tmp_path, BODY + WING)
    assert np.array_equal(jet.body.meridian, same.body.meridian)
    assert (jet.body.name, jet.body.y) == ("hull", 0.2)
    assert np.array_equal(jet.wing.z, same.wing.z)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (BODY, "wings: are not one or more tables"),
        (WING, "bodies: are not one or more tables"),
        (BODY + BODY + WING, r"bodies\[1\].name: a second one of bodies"),
        (BODY + WING.replace("fuselage", "hull"), r"wings\[0\].on: hull is no body; use fuselage"),
        (BODY.replace("[6, 0]", "[6, 0.1]") + WING, r"bodies\[0\]: radii of 0 and 0.1 at nose and tail"),
        (BODY.replace("[4, 0.5]", "[1, 0.5]") + WING, "point 3: x is 1 behind 1"),
        (BODY.replace("[4, 0.5]", "[4, -0.5]") + WING, "point 3: a radius of -0.5"),
        (BODY.replace("[4, 0.5]", "[4, true]") + WING, r"meridian\[2\].meridian: True is no number"),
        (BODY.replace("[[0", '"none.csv" # [[0') + WING, "none.csv"),
        (BODY + "sweep = 3\n" + WING, r"bodies\[0\].sweep: is not known"),
        (BODY + WING.replace("on =", 'file = "wing.toml"\non ='), r"wings\[0\].sections: is not known"),
        (BODY + WING.replace("on =", 'tip = "open"\non ='), "tip: a wing of an aircraft has a tip"),
    ],
)
def test_faults_are_refused_with_their_place(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        read(tmp_path, text)
    assert "\n" not in str(error.value)
    assert str(error.value).startswith(str(tmp_path))
