"""Paths: points of text files, lines and arcs of TOML."""

import numpy as np
import pytest

from meshonet.formats.path import path_of
from meshonet.geometry.errors import InputError


def read(folder, name, text):
    path = folder / name
    path.write_text(text)
    return path_of(str(path))


def test_points_stand_one_a_line_with_any_separator(tmp_path):
    plain = read(tmp_path, "a.txt", "# x y z\n0 0 0\n1 0 0\n2 1 0\n")
    other = read(tmp_path, "b.csv", "x,y,z\n0,0,0\n1,0,0\n2,1,0\n")
    assert plain.length == other.length > 2.4
    assert plain.at(np.array([plain.length])).points[0].tolist() == [2.0, 1.0, 0.0]


def test_a_file_that_ends_where_it_begins_is_a_closed_path(tmp_path):
    path = read(tmp_path, "ring.csv", "1,0,0\n0,1,0\n-1,0,0\n0,-1,0\n1,0,0\n")
    assert path.closed
    assert path.length == pytest.approx(2.0 * np.pi, rel=0.03)


def test_lines_and_arcs_lead_on_from_start_and_direction(tmp_path):
    text = """
start = [0, 0, 1]
direction = [0, 1, 0]
[[pieces]]
line = 2
[[pieces]]
arc = 90
radius = 3
towards = [1, 0, 0]
"""
    path = read(tmp_path, "bend.toml", text)
    assert path.length == pytest.approx(2.0 + 1.5 * np.pi)
    end = path.at(np.array([path.length]))
    assert end.points[0] == pytest.approx([3.0, 5.0, 1.0])
    assert end.tangents[0] == pytest.approx([1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("name", "text", "problem"),
    [
        ("a.csv", "0,0,0\n1,0\n2,0,0\n", "line 2: '1,0' is not x, y and z"),
        ("a.csv", "x,y,z\n1,0,0\n", "holds 1 points"),
        ("a.csv", "0,0,0\n0,0,0\n1,0,0\n", "point 0 of the path and the next are the same"),
        ("a.toml", "start = [0, 0, 0]", "pieces: are not one or more tables"),
        ("a.toml", "[[pieces]]\nline = 0\n", "pieces[0].line: 0 is not positive"),
        ("a.toml", "[[pieces]]\nline = 1\nradius = 2\n", "pieces[0].radius: is not known; use line"),
        ("a.toml", "[[pieces]]\narc = 9\nradius = 2\n", "pieces[0].towards: is missing"),
        ("a.toml", "direction = [0, 0, 0]\n[[pieces]]\nline = 1\n", "the direction of the path has no"),
    ],
)
def test_what_is_wrong_is_named_with_its_place(tmp_path, name, text, problem):
    with pytest.raises(InputError) as refusal:
        read(tmp_path, name, text)
    assert str(refusal.value).startswith(f"{tmp_path / name}: {problem}")
