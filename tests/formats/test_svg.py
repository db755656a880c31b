"""Outlines from SVG drawings: curves within the tolerance that is stated, names, maps, what is refused."""

from math import cos, radians, sin

import numpy as np
import pytest
from format_shapes import memory

from meshonet.formats.outlines.joined import SAG
from meshonet.formats.outlines.svg import read_shapes
from meshonet.formats.registry import format_of
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.geometry.spacing.sampling import Sampling

SQUARE = '<rect id="box" x="-5" y="-5" width="10" height="10"/>'


def drawn(content: str) -> Domain:
    """Return the domain of a drawing; the square around is 10 wide."""
    text = f'<svg xmlns="http://www.w3.org/2000/svg">{SQUARE}{content}</svg>'
    (shape,) = read_shapes(memory(text.encode(), "a.svg"))
    assert isinstance(shape, DomainShape)
    return shape.domain


def hole(content: str) -> np.ndarray:
    return drawn(content).loops[1].curve.points


def middles(points: np.ndarray) -> np.ndarray:
    return 0.5 * (points + np.roll(points, -1, axis=0))


ELLIPSES = {
    "ellipse": '<ellipse rx="2" ry="1"/>',
    "circle, scaled": '<g transform="scale(2 1)"><circle r="1"/></g>',
    "two arcs": '<path d="M-2,0 A2 1 0 0 0 2,0 A2,1,0,0,0,-2,0 Z"/>',
    "relative, turned the other way": '<path d="M2 0a2 1 0 1 1-4 0 2 1 0 1 1 4 0"/>',
    "arcs that are too small": '<path d="M-2,0 A.5 .25 0 0 0 2,0 A.5,.25,0,0,0,-2,0 Z"/>',
    "an arc with its axes turned": '<path d="M-2,0 A1 2 90 0 0 2,0 A1,2,90,0,0,-2,0 Z"/>',
    "large arc": '<path d="M2,0 A2 1 0 1 0 0,1 A2 1 0 0 0 2,0 Z"/>',
}


@pytest.mark.parametrize("case", ELLIPSES)
def test_arcs_are_within_the_tolerance(case: str) -> None:
    points = hole(ELLIPSES[case])
    for off in (points, middles(points)):
        assert np.abs(np.hypot(off[:, 0] / 2, off[:, 1]) - 1).max() < 10 * SAG
    assert np.ptp(points, axis=0) == pytest.approx([4, 2], abs=1e-4)


def test_bezier_curves_are_within_the_tolerance() -> None:
    t = np.linspace(0, 1, 20001)[:, None]
    a, b, c, d = np.array([[0, 0], [1, 3], [2, 3], [3, 0]])
    cubic = (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
    points = hole('<path d="M0 0C1-3,2-3,3 0Q1.5 1 0 0z"/>')
    upper = middles(points)[middles(points)[:, 1] > 1e-3]
    assert np.abs(upper[:, 1] - np.interp(upper[:, 0], *cubic.T)).max() < 20 * SAG


def test_names_are_ids_of_elements_or_groups_and_y_points_upwards() -> None:
    text = """<svg xmlns="http://www.w3.org/2000/svg">
    <g id="walls"><path d="M0 0H3"/><polyline points="0,-1 3,-1"/></g>
    <line id="outlet" x1="3" y1="0" x2="3" y2="-1"/><path id="inlet" d="M0,0v-1"/>
    <defs><circle r="9"/></defs><text>duct</text></svg>"""
    (shape,) = read_shapes(memory(text.encode(), "a.svg"))
    patches = {patch.name: patch.side for patch in shape.boundary(Sampling(ni=9, nj=5)).patches}
    assert set(patches) == {"walls", "outlet", "inlet"}
    assert (patches["inlet"], patches["outlet"]) == ("west", "east")
    assert shape.notes == ("of the drawing, elements that are no curves are left out: 1 text",)


def test_maps_of_groups_are_applied_from_the_inside_out() -> None:
    path = '<path transform="matrix(1 0 0 2 0 0) skewX(0)" d="M0 0H1V1z"/>'
    content = f'<g transform="translate(1,1) rotate(30)">{path}</g>'
    c, s = cos(radians(30)), sin(radians(30))
    wanted = {
        (round(1 + x * c - y * s, 9), round(-(1 + x * s + y * c), 9)) for x, y in ((0, 0), (1, 0), (1, 2))
    }
    assert {tuple(np.round(point, 9)) for point in hole(content)} == wanted


REFUSED = {
    "no XML": (b"<svg", "is no SVG drawing that can be read"),
    "entities": (b'<!DOCTYPE a [<!ENTITY a "b">]><svg/>', "its XML defines entities"),
    "nothing": (b"<svg><text>a</text></svg>", "has no curves; draw lines, paths or shapes"),
    "a path": (b'<svg><path d="L 1 2"/></svg>', "is no SVG drawing that can be read"),
    "half of a number": (b'<svg><path d="M0 0L1"/></svg>', "is no SVG drawing that can be read"),
    "an arc cut short": (b'<svg><path d="M0 0A1 1"/></svg>', "is no SVG drawing that can be read"),
    "a map": (b'<svg><path transform="bend(3)" d="M0 0H1"/></svg>', "transform 'bend.3.'"),
    "a unit": (b'<svg><circle r="2mm"/></svg>', "could not convert string to float: '2mm'"),
    "open": (
        b'<svg><path d="M0 0H2V1"/></svg>',
        "the boundary has to consist of closed curves|has 2 boundary edges",
    ),
    "huge": (b'<svg><circle r="1e200"/></svg>', "no size, or one that is not finite"),
    "a point": (b'<svg><path d="M0 0L0 0z"/></svg>', "no size, or one that is not finite"),
    "deep": (b"<svg>" + b"<g>" * 5000 + b"</g>" * 5000 + b"</svg>", "groups in groups without end"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_drawing_is_refused(case: str) -> None:
    data, message = REFUSED[case]
    with pytest.raises(InputError, match=message):
        list(read_shapes(memory(data, "a.svg")))


def test_a_drawing_is_known_by_its_ending_and_its_content() -> None:
    data = b'<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg"/>'
    assert format_of(memory(data)).name == format_of(memory(b"", "a.svg")).name == "svg"
