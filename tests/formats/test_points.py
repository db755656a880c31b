import itertools

import numpy as np
import pytest

from meshonet.formats.source import Source
from meshonet.formats.text.points import parse, read_shapes, sniff
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.shape import edges_of
from meshonet.geometry.spacing.sampling import Sampling

SOUTH = np.stack([np.linspace(0, 2, 9), 0.1 * np.sin(np.linspace(0, 3, 9))], axis=1)
SOUTH[[0, -1], 1] = 0
NORTH = np.stack([np.linspace(0, 2, 9), np.full(9, 1.0)], axis=1)
WEST, EAST = (
    np.stack([np.zeros(5), np.linspace(0, 1, 5)], axis=1),
    np.stack([np.full(5, 2.0), np.linspace(0, 1, 5)], axis=1),
)


def lines(points: np.ndarray, separator: str = ",") -> str:
    return "".join(f"{x!r}{separator}{y!r}\n" for x, y in points.tolist())


@pytest.mark.parametrize("head", ["", "x,y\n", "# a duct\n", "x;y;z\n\n"])
@pytest.mark.parametrize("separator", [",", ";", " ", "\t", " , "])
def test_one_closed_curve_is_an_outline(head, separator):
    (shape,) = parse(head + lines(np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]]), separator), "d/duct.csv")
    assert isinstance(shape, Outline)
    assert (shape.name, shape.topology) == ("duct", "quad")
    b = shape.boundary(Sampling(ni=9, nj=5))
    np.testing.assert_array_equal(b.south[[0, -1]], [[0, 0], [2, 0]])


def test_a_repeated_first_point_and_a_third_column_do_not_matter():
    (shape,) = parse("0 0 0\n2 0 0\n2 1 0\n0 1 0\n0 0 0\n", "a.xy")
    assert isinstance(shape, Outline)
    assert len(shape.curve.points) == 4


@pytest.mark.parametrize("order", list(itertools.permutations(range(1, 4))))
@pytest.mark.parametrize("ways", [(1, 1, 1, 1), (-1, 1, -1, 1), (1, -1, -1, -1), (-1, -1, 1, -1)])
def test_four_edges_chain_in_any_order_and_direction(order, ways):
    edges = [SOUTH, EAST, NORTH, WEST]
    text = "\n".join(lines(edges[k][:: ways[k]]) for k in (0, *order))
    (shape,) = parse(text, "four.csv")
    assert isinstance(shape, Boundary)
    np.testing.assert_array_equal(shape.south, SOUTH)
    np.testing.assert_array_equal(shape.north, NORTH)
    np.testing.assert_array_equal(shape.west, WEST)
    np.testing.assert_array_equal(shape.east, EAST)


def test_the_first_edge_is_south():
    (shape,) = parse("\n".join(lines(edge) for edge in (NORTH, SOUTH, EAST, WEST)), "four.csv")
    np.testing.assert_array_equal(shape.south, NORTH[::-1])


def test_four_edges_of_unequal_counts_are_curves_to_sample():
    (shape,) = parse("\n".join(lines(edge) for edge in (SOUTH, EAST, NORTH[::4], WEST)), "four.csv")
    assert isinstance(shape, Outline)
    b = shape.boundary(Sampling(ni=21, nj=11))
    np.testing.assert_array_equal(
        [b.south[0], b.south[-1], b.north[-1], b.north[0]], [[0, 0], [2, 0], [2, 1], [0, 1]]
    )
    for p in SOUTH[[2, 4, 6]]:
        assert np.hypot(*(b.south - p).T).min() < 0.05


def test_edges_of_two_points_are_lines_to_sample():
    """Their ends alone make no grid: before, it had 2 x 2 nodes."""
    for south, north in ((SOUTH[[0, -1]], NORTH[[0, -1]]), (SOUTH, NORTH)):
        ends = [np.array([[2.0, 0.0], [2.0, 1.0]]), np.array([[0.0, 1.0], [0.0, 0.0]])]
        (shape,) = parse("\n".join(map(lines, (south, ends[0], north, ends[1]))), "four.csv")
        boundary = shape.boundary(Sampling(ni=21, nj=11))
        assert (boundary.ni, boundary.nj) == (21, 11)
        np.testing.assert_allclose(boundary.east, np.stack([np.full(11, 2.0), np.linspace(0, 1, 11)], 1))


def test_four_edges_can_be_sampled_anew():
    (shape,) = parse("\n".join(lines(edge) for edge in (SOUTH, EAST, NORTH, WEST)), "four.csv")
    assert shape.boundary(Sampling(ni=33, nj=17)).ni == 33


@pytest.mark.parametrize("base", [0.0, 0.01])
def test_a_section_in_a_list_of_points_is_an_airfoil(base):
    x = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 41))
    half = 0.3 * np.sqrt(x) * (1 - x) + 0.5 * base * x
    points = np.concatenate([np.stack([x, half], 1)[::-1], np.stack([x, -half], 1)[1:]])
    (shape,) = parse("x,y\n" + lines(points), "section.csv")
    assert isinstance(shape, Airfoil)
    assert shape.blunt == (base > 0)
    assert shape.name == "section"


def test_a_round_body_is_no_airfoil():
    t = np.linspace(0, 2 * np.pi, 60)
    (shape,) = parse(lines(np.stack([3 * np.cos(t), np.sin(t)], axis=1)), "a.xy")
    assert isinstance(shape, Outline)
    assert shape.topology == "o"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a.csv: 0 blocks of points; give closed curves, or four edges"),
        ("0,0\n1,1\n", "2 points; a closed curve needs at least 3"),
        ("0,0\n1,0\n1,1\n0,1\n\n5,5\n6,6\n", "a.csv: line 6: 2 blocks of points"),
        ("0,0\n1,x\n1,1\n", "a.csv: line 2: '1,x' is no pair of numbers"),
        ("0,0\n1,1\n1,0\n0,1\n", r"crosses itself at \(0.5, 0.5\), behind line 1 and behind line 3"),
        (
            "0,0\n1,0\n\n1,0\n1,1\n\n1,1\n0,1\n\n0,0.9\n0,0\n",
            r"no other edge starts or ends at \(0, 1\); the nearest is 0.1",
        ),
        ("0,0\n1,0\n\n1,0\n1,1\n\n1,1\n0,1\n\n0,1\n0,0.1\n", "do not close: 0.1 are left open"),
        (
            "0,0\n1,2\n2,0\n\n2,0\n2,1\n\n2,1\n1,1\n0,1\n\n0,1\n0,0\n",
            r"crosses itself at \(0.5, 1\), behind line 1 and behind line 9; correct these points",
        ),
        (
            "0,0\n1,0\n\n1,0\n1,.5\n1,.5\n1,1\n\n1,1\n0,1\n\n0,1\n0,0\n",
            r"line 6: repeats the point \(1, 0.5\) of the line before; remove it",
        ),
        (
            "0,0\n1,0\n\n1,0\n1,0\n\n1,0\n0,1\n\n0,1\n0,0\n",
            "line 4: an edge is one point; give two or more points of every edge",
        ),
    ],
)
def test_what_is_no_shape_is_refused_with_the_line(text, message):
    with pytest.raises(InputError, match=message):
        parse(text, "a.csv")


@pytest.mark.parametrize(
    "text", ["0 0\n2 0\n2 ...\n2 1\n0 1\n", "\n".join(lines(e) for e in (SOUTH, EAST, NORTH, WEST)) + "0.3\n"]
)
def test_a_line_that_is_left_out_is_a_note_of_the_boundary(text):
    (shape,) = parse(text, "a.csv")
    for sampling in (Sampling(), Sampling(ni=21, nj=11)):
        (note,) = edges_of(shape, sampling).notes
        assert "is no pair of numbers and is left out" in note


def test_reading_names_the_shape_after_the_file():
    (shape,) = read_shapes(Source("duct.csv", data=b"\xef\xbb\xbf0,0\r\n2,0\r\n2,1\r\n0,1\r\n"))
    assert shape.name == "duct"


def test_sniffing_knows_points_from_prose():
    assert sniff(b"x,y\n0,0\n1,0\n1,1\n")
    assert not sniff(b"a\nb\nc\n")


WALLS = {
    "as drawn": (SOUTH, NORTH[::2]),
    "against each other": (SOUTH, NORTH[::-2]),
    "from the outlet": (SOUTH[::-1], NORTH[::2]),
}


@pytest.mark.parametrize("case", WALLS)
@pytest.mark.parametrize("titles", [("", ""), ("# floor\n", "# the roof\n"), ("# a channel\n", "")])
def test_two_open_curves_are_the_walls_of_a_channel(case, titles):
    text = "\n".join(title + lines(wall) for title, wall in zip(titles, WALLS[case], strict=True))
    (shape,) = parse(text, "channel.csv")
    b = shape.boundary(Sampling(ni=21, nj=7))
    assert b.topology == "quad"
    np.testing.assert_allclose(sorted(b.south[[0, -1]].tolist()), [[0, 0], [2, 0]], atol=1e-12)
    floor, roof = ("floor", "the roof") if titles[1] else ("wall", "wall")
    start, stop = ("west", "east") if case != "from the outlet" else ("east", "west")
    assert {p.side: p.name for p in b.patches} == {
        "south": floor,
        "north": roof,
        start: "inlet",
        stop: "outlet",
    }
    assert [p.stop - p.start for p in b.patches] == [20, 6, 20, 6]


def test_the_steps_of_a_channels_wall_are_corners_of_its_domain():
    (shape,) = parse("# floor\n0 0\n3 0\n3 -1\n6 -1\n6 0\n9 0\n\n# roof\n0 1\n9 1\n", "slot.csv")
    (loop,) = shape.domain.loops
    points = loop.curve.points[list(loop.corners)].tolist()
    assert sorted(points) == [[0, 0], [0, 1], [3, -1], [3, 0], [6, -1], [6, 0], [9, 0], [9, 1]]
    ends = [*loop.corners[1:], loop.corners[0]]
    named = {tuple(sorted((a, b))): n for a, b, n in zip(loop.corners, ends, loop.names, strict=True)}
    assert sorted(named.values()) == ["floor"] * 5 + ["inlet", "outlet", "roof"]
    for (a, b), name in named.items():
        ys = loop.curve.points[[a, b], 1]
        assert (name == "roof") == (ys == 1).all()


def test_two_bodies_left_open_are_no_channel():
    t = np.linspace(0, 2 * np.pi, 40)[:-1]
    circle = np.stack([np.cos(t), np.sin(t)], axis=1)
    assert len(parse(lines(circle) + "\n" + lines(circle + 5), "two.csv")) == 2


@pytest.mark.parametrize("step", [1, 2])
def test_four_edges_are_called_as_lines_above_them_say(step):
    names = ("floor", "out", "roof", "in")
    text = "\n".join(
        f"# {n}\n{lines(e)}" for n, e in zip(names, (SOUTH, EAST, NORTH[::step], WEST), strict=True)
    )
    (shape,) = parse(text, "four.csv")
    b = shape.boundary(Sampling(ni=9, nj=5))
    assert {p.side: p.name for p in b.patches} == dict(
        zip(("south", "east", "north", "west"), names, strict=True)
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x,y\n0,0\n1,0\nfoo\n", "line 4: 'foo' is no pair of numbers, and too few points"),
        ("0,0\n1,0\n1,1\nfoo\n0,1\n", "line 4: 'foo' is no pair of numbers, and too few points"),
        ("x,y\n0,0\n1,0\n", "2 points; a closed curve needs at least 3"),
    ],
)
def test_words_beside_too_few_points_are_named(text, message):
    with pytest.raises(InputError, match=message):
        parse(text, "bad.csv")
