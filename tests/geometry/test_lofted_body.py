"""Bodies through cross-sections: their surface, and what is no section."""

import numpy as np
import pytest

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.body_section import BodySection
from meshonet.geometry.aircraft.lofted_body import LoftedBody
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.solvers.aircraft.lofted_map import map_around

X = np.array([0.0, 0.1, 0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 9.0, 10.0])
R = np.array([0.0, 0.2, 0.4, 0.5, 0.55, 0.55, 0.5, 0.3, 0.15, 0.0])
THETA = np.linspace(0.0, np.pi, 37)


def lofted(width: float = 1.0, height: float = 1.0, exponent: float = 2.0, raised: float = 0.0) -> LoftedBody:
    """Sections that are `width` and `height` times 2 R, and `raised` at the tail."""
    return LoftedBody(
        sections=tuple(
            BodySection(float(x), raised * float(x) / 10.0, 2.0 * width * r, 2.0 * height * r, exponent)
            for x, r in zip(X, R.tolist(), strict=True)
        )
    )


def test_circles_make_a_body_of_revolution() -> None:
    s, theta = np.meshgrid(np.linspace(0.0, 10.0, 41), THETA)
    own = lofted()
    round_one = Body(own.meridian)
    assert own.points(s, theta) == pytest.approx(round_one.points(s, theta), abs=1e-14)
    draw = np.random.default_rng(0).uniform([0, -1, 0], [10, 1, 1], (99, 3))
    assert own.outside(draw) == pytest.approx(round_one.outside(draw), abs=1e-12)


@pytest.mark.parametrize("exponent", [1.5, 2.0, 3.0, 5.0])
def test_the_surface_goes_through_superellipses(exponent: float) -> None:
    body = lofted(1.2, 0.9, exponent, 0.4)
    for arc, section in list(zip(body.arcs, body.sections, strict=True))[1:-1]:
        x, y, z = body.points(np.full(len(THETA), arc), THETA).T
        across, up = section.halves
        assert x == pytest.approx(section.x, abs=1e-12)
        one = np.abs(z / across) ** exponent + np.abs((y - section.middle) / up) ** exponent
        assert one == pytest.approx(1.0, abs=2e-5 if exponent < 2.0 else 1e-7)


def frame(width: float = 1.4, top: float = 0.9, bottom: float = -0.5) -> Floats:
    """Points of half a section: a half ellipse below and another above its widest place, at y = 0."""
    t = np.linspace(0.0, np.pi, 41)
    y = np.where(t < 0.5 * np.pi, bottom, -top) * np.cos(t)
    z = 0.5 * width * np.sin(t)
    z[-1] = 0.0
    return np.stack([y, z], axis=1)


def test_a_section_goes_through_the_points_of_a_half_section() -> None:
    points = frame()
    section = BodySection(3.0, 0.1, points=points)
    assert section.middle == pytest.approx(0.3)
    assert section.halves == pytest.approx((0.7, 0.7))
    body = LoftedBody(sections=(BodySection(0.0), *(BodySection(x, 0.1, points=points) for x in (2.0, 3.0)),
                                BodySection(6.0)))  # fmt: skip
    on = np.concatenate([np.full((len(points), 1), 3.0), points + np.array([0.1, 0.0])], axis=1)
    assert np.abs(body.outside(on)).max() < 1e-6
    down = BodySection(3.0, 0.1, points=points[::-1])
    assert np.array_equal(down.shape, section.shape), "from crown to keel is the same"


def test_inside_and_outside_are_those_of_the_section_at_x() -> None:
    body = lofted(1.5, 1.0, 2.0, 0.5)
    at = float(body.sections[5].middle)
    assert body.outside(np.array([[4.0, at, 0.81], [4.0, at, 0.84], [4.0, at + 0.54, 0.0]])).tolist() == [
        pytest.approx(-0.015), pytest.approx(0.015), pytest.approx(-0.01)]  # fmt: skip


POINT, OVAL = BodySection(0.0), BodySection(1.0, width=1.0, height=1.0)
REFUSED = {
    "three sections": ((POINT, OVAL, BodySection(2.0)), "3 sections; give 4 or more", "sections"),
    "a flat nose": ((BodySection(0.0, width=1, height=1), OVAL, OVAL, POINT), "nose is no point", "[0]"),
    "sections not in order": ((POINT, OVAL, OVAL, BodySection(2.0)), "1 is not behind 1", "[2].x"),
    "an open tail": (
        (POINT, OVAL, BodySection(2.0, width=1, height=1), BodySection(3.0, width=1, height=1)),
        "tail is no point", "[3]"),
    "a point within": ((POINT, OVAL, BodySection(2.0), BodySection(3.0)), "a point within the body", "[2]"),
    "a flat body": (
        (POINT, OVAL, BodySection(2.0, width=9, height=1), BodySection(3.0)), "9 wide and 1", "[2]"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_body_is_refused_with_its_place(name: str) -> None:
    sections, words, place = REFUSED[name]
    with pytest.raises(InputError, match=words) as error:
        LoftedBody(sections=sections)
    assert error.value.place.startswith("sections")
    assert place in error.value.place


def few(x: list[float], width: list[float], height: list[float], y: list[float]) -> LoftedBody:
    """Sections in a few places only."""
    return LoftedBody(
        sections=tuple(BodySection(*row) for row in zip(map(float, x), y, width, height, strict=True))
    )


SPOOL = [0, 2, 2, 0.02, 0.02, 0]
FEW = {
    "five over five units": few([0, 0.1, 0.5, 2.5, 5], [0, 0.5, 0.9, 0.84, 0], [0, 0.4, 0.7, 0.8, 0],
                                [-0.1, 0, 0, 0, 0.1]),
    "a flat tail": few([0, 0.3, 1, 4, 9], [0, 0.8, 1, 1, 0], [0, 0.8, 1, 0.4, 0], [0, 0, 0, 0.1, 0.4]),
    "pairs far apart": few([0, 1, 1.01, 3, 3.02, 9], SPOOL, SPOOL, [0] * 6),
    "all at the nose": few([0, 0.2, 0.5, 3, 10], [0, 0.5, 0.9, 1, 0], [0, 0.5, 0.9, 1, 0], [0] * 5),
}  # fmt: skip


@pytest.mark.parametrize("name", FEW)
def test_few_sections_make_a_body_that_neither_closes_nor_bulges(name: str) -> None:
    body = FEW[name]
    across, up, middle = body.sizes(np.linspace(0.0, body.length, 4001)[1:-1])
    assert min(across.min(), up.min()) > 0.0
    assert across.max() < 0.525 * body.width
    assert up.max() < 0.525 * body.height
    heights = [section.middle for section in body.sections]
    assert min(heights) <= middle.min()
    assert middle.max() <= max(heights)


@pytest.mark.parametrize("name", FEW)
def test_nose_and_tail_have_unit_normals(name: str) -> None:
    body = FEW[name]
    ends = np.array([[0.0, 0.0, 0.0], [body.length, 0.0, 0.0]])
    nose, tail = map_around(body, 5.0 * body.extent).normals(ends)
    assert nose[0] < -0.5
    assert tail[0] > 0.5
    assert np.hypot(nose[0], nose[1]) == pytest.approx(1.0)


def test_a_round_tail_far_behind_the_last_section_is_an_ellipse() -> None:
    body = few([0.0, 1, 2, 4, 8], [0, 2, 2, 2, 0], [0, 2, 2, 2, 0], [0] * 5)
    x = np.linspace(7.5, 7.9, 50)
    _, up, _ = body.sizes(body.arc_at(x))
    rise = up * up / (8.0 - x)
    assert np.ptp(rise) < 0.15 * rise.mean(), "the square of the radius is almost a line; a cone has none"


def test_forms_that_change_at_once_do_not_bulge_behind() -> None:
    rhombus, square = (BodySection(x, 0.0, 1.0, 1.0, n) for x, n in ((1.0, 1.2), (1.01, 20.0)))
    sections = (BodySection(0.0), rhombus, square, BodySection(5.0, 0.0, 1.0, 1.0), BodySection(9.0))
    body = LoftedBody(sections=sections)
    s, theta = np.meshgrid(np.linspace(0.0, body.length, 201), THETA)
    shape = body.shape(s.ravel(), theta.ravel())
    assert shape.min() >= rhombus.shape.min() - 1e-9
    assert shape.max() <= square.shape.max() + 1e-9


POINTS = frame()
Y = -np.cos(np.linspace(0.0, np.pi, 201))
NECK = np.stack([Y, np.sqrt(1.0 - Y * Y) * (0.5 - 0.42 * np.exp(-(((Y - 0.4) / 0.15) ** 2)))], axis=1)
WRONG = {
    "a curve": (POINTS[None], "shape"),
    "few points": (POINTS[:3], "give 5 or more"),
    "an open end": (POINTS[:-4], "both in z = 0"),
    "the other half": (POINTS * [1.0, -1.0], "half z >= 0"),
    "not a number": (np.where(POINTS > 0.6, np.nan, POINTS), "not finite"),
    "a point twice": (np.repeat(POINTS, [1] * 9 + [2] + [1] * 31, axis=0), "points 10 and 11 are the same"),
    "a corner": (np.array([[-1, 0], [-1, 0.5], [-1, 1], [0, 1], [1, 1], [1, 0.5], [1, 0]]), "turns by 90"),
    "a hollow": (NECK, "a ray from its middle meets it twice"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_points_that_are_no_half_section_are_refused(name: str) -> None:
    points, words = WRONG[name]
    with pytest.raises(InputError, match=words) as error:
        BodySection(1.0, points=points)
    assert error.value.place == "points"


@pytest.mark.parametrize(
    ("values", "words"),
    [({"width": 1.0}, "neither for a point"), ({"width": -1.0, "height": 1.0}, "negative"),
     ({"width": 1.0, "height": 1.0, "exponent": 0.5}, "use 1.2 to 20"), ({"x": np.nan}, "not finite")],
)  # fmt: skip
def test_sizes_that_are_no_superellipse_are_refused(values: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        BodySection(**({"x": 1.0} | values))


def test_a_meridian_whose_spline_crosses_the_axis_beside_the_tail_is_refused() -> None:
    """It is below the axis only in the last eighth of the last interval."""
    with pytest.raises(InputError, match="reaches the axis") as error:
        Body(np.array([[0, 0], [1, 0.5], [2, 0.6], [3, 0.6], [4, 0.51], [8, 0]]))
    assert error.value.place == "meridian: points 5 and 6"
