"""Pairs of singular points that go, against energies written again and domains that need none."""

import numpy as np
import pytest
from planar_domains import blob, block_grid, circle, domain

from meshonet.geometry.domain.domain import Domain
from meshonet.solvers.blocking.decomposition import decompose as decomposition
from meshonet.solvers.blocking.decomposition.collapse.collapse import irregular_inside
from meshonet.solvers.blocking.decomposition.decompose import decompose
from meshonet.solvers.blocking.decomposition.field.cross_field import CrossField, cross_field
from meshonet.solvers.blocking.decomposition.surface.triangulation import triangulate

NEXT = np.array([1, 2, 0])


def funnel() -> Domain:
    """Return a duct that narrows to a fifth, whose field spreads and gathers again."""
    x = np.linspace(0.0, 3.0, 40)
    upper = 0.3 + 0.6 * (1.0 + np.cos(np.pi * x / 3.0))
    return Domain.of_polygons([np.concatenate([np.stack([x, -upper], 1), np.stack([x, upper], 1)[::-1]])])


def holes() -> Domain:
    """Return a smooth domain with two smooth holes."""
    return Domain.of_polygons([blob(9, 2.0), circle(-0.6, 0.1, 0.4, 60), circle(0.6, 0.3, 0.3, 60)])


def fields(of: Domain) -> tuple[CrossField, CrossField]:
    """Return the field with all its singular points, and that with fewer."""
    surface = triangulate(of, 1500)
    return cross_field(surface, fewer=False), cross_field(surface)


def energy(field: CrossField) -> float:
    """Return half the integral of the squared gradient of the phase, of linear pieces in each triangle."""
    surface, phase = field.surface, np.angle(field.crosses)
    steps = phase[surface.triangles[:, NEXT]] - phase[surface.triangles]
    steps -= 2.0 * np.pi * np.round(steps / (2.0 * np.pi))
    x, y = np.moveaxis(surface.points[surface.triangles], 2, 0)
    cotangents = []
    for k in range(3):
        u = np.stack([x[:, k] - x[:, k - 1], y[:, k] - y[:, k - 1]])
        v = np.stack([x[:, (k + 1) % 3] - x[:, k - 1], y[:, (k + 1) % 3] - y[:, k - 1]])
        cotangents.append((u * v).sum(axis=0) / np.abs(u[0] * v[1] - u[1] * v[0]))
    return float(0.25 * (np.stack(cotangents, axis=1) * steps**2).sum())


def irregular(field: CrossField) -> int:
    corners = field.walls.corner_cells
    wall = field.boundary_cells[: len(corners)]
    return len(field.singular) + int(((wall != 2) & (corners == 0) & (wall > 0)).sum())


def test_a_funnel_is_one_block():
    before, after = fields(funnel())
    assert (irregular(before), irregular(after)) == (2, 0)
    assert len(decompose(funnel()).blocks) == 1


@pytest.mark.parametrize("of", [funnel, holes])
def test_fewer_points_at_less_energy_and_the_same_walls(of):
    before, after = fields(of())
    assert irregular(after) < irregular(before)
    assert energy(after) < energy(before)
    wall = before.surface.on_wall
    assert np.array_equal(before.crosses[wall], after.crosses[wall])


@pytest.mark.parametrize("name", ["disc", "hexagon", "cylinder in a channel", "annulus", "tilted L"])
def test_fields_without_pairs_stay_bitwise(name):
    before, after = fields(domain(name))
    assert np.array_equal(before.crosses, after.crosses)


def test_a_grid_around_holes_has_fewer_irregular_nodes(monkeypatch):
    few = irregular_inside(block_grid(holes(), cells=1500)[1].mesh)
    monkeypatch.setattr(decomposition, "FEWER", 0)
    assert few < irregular_inside(block_grid(holes(), cells=1500)[1].mesh)
