import numpy as np
import pytest
import shapely

from meshonet.geometry.errors import InputError
from meshonet.geometry.families.family import FAMILIES, family

KINKS = {
    "arch": lambda p: [],
    "hexagon": lambda p: [
        (0.5, -0.5 / np.tan(np.radians(p / 2))),
        (0.5, 1 + 0.5 / np.tan(np.radians(p / 2))),
    ],
    "wrench": lambda p: [
        (0.5 - p / 2, 0.6),
        (0.5 + p / 2, 0.6),
        (0.5 - p / 2, 1.0),
        (0.5 + p / 2 + 0.05, 1.15),
    ],
    "semicircle": lambda p: [(p - 0.2, 0.0), (p + 0.2, 0.0)],
    "airfoil": lambda p: [(1.0, 0.0)],
    "hole": lambda p: [(1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (0.35, p)],
}


def areas(name: str, p: float) -> float:
    """Return the area of the domain, from geometry."""
    h = 0.5 / np.tan(np.radians(p / 2)) if name == "hexagon" else 0.0
    return {
        "arch": 1 + p * 2 / np.pi,
        "hexagon": 1 + h,
        "wrench": 1 + 0.15 * (0.5 - p / 2) - 0.4 * p,
        "semicircle": 2 - np.pi * 0.02,
        "hole": 4 - np.pi * 0.35**2,
    }[name]


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("where", [0.0, 0.37, 1.0])
@pytest.mark.parametrize(("ni", "nj"), [(21, 11), (100, 60), (301, 200)])
def test_members_are_valid_with_their_kinks_on_nodes(name, where, ni, nj):
    kind = family(name)
    p = kind.low + where * (kind.high - kind.low)
    b = kind.boundary(p, ni, nj)
    assert (b.ni, b.nj, b.topology) == (ni, nj, kind.topology)
    assert b.name == f"{name}-{p:.6g}"
    outer = shapely.Polygon(b.outline() if b.topology == "quad" else b.north)
    assert outer.is_valid
    nodes = np.concatenate([b.south, b.north])
    for kink in KINKS[name](p):
        assert np.abs(nodes - kink).max(axis=1).min() < 1e-14
    if name != "airfoil":
        inner = 0.0 if b.topology == "quad" else shapely.Polygon(b.south).area
        assert outer.area - inner == pytest.approx(areas(name, p), rel=20 / ni**2 + 1e-9)


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("end", ["least", "most"])
def test_members_at_the_ends_of_what_is_possible_are_simple(name, end):
    kind = family(name)
    b = kind.boundary(getattr(kind, end), 60, 30)
    ring = shapely.LinearRing(b.outline() if b.topology == "quad" else b.south[:-1])
    assert ring.is_simple


def test_the_nodes_of_a_wrench_move_straight_with_the_opening():
    """Its kinks move so, and lie on the same nodes whatever the opening: no node jumps."""
    a, b, c = (family("wrench").boundary(p, 101, 33).north for p in (0.15, 0.25, 0.35))
    np.testing.assert_allclose(a + c, 2 * b, atol=1e-14)
    assert np.abs(a - b).max() == pytest.approx(0.05)


def test_the_airfoil_family_is_as_thick_as_asked():
    south = family("airfoil").boundary(0.18, 401, 9).south
    assert np.ptp(south[:, 1]) == pytest.approx(0.18, rel=2e-3)


@pytest.mark.parametrize("name", FAMILIES)
def test_a_parameter_out_of_range_is_refused_with_the_range(name):
    kind = family(name)
    with pytest.raises(InputError, match=f"use {kind.least:g} to {kind.most:g}"):
        kind.boundary(kind.most + 1, 30, 30)


def test_an_unknown_family_is_refused_with_the_list():
    with pytest.raises(InputError, match="use one of arch, hexagon, wrench, semicircle, airfoil, hole"):
        family("spanner")


def test_too_few_nodes_for_the_kinks_are_refused():
    with pytest.raises(InputError, match="corners do not fit on 5 nodes"):
        family("wrench").boundary(0.3, 5, 5)
