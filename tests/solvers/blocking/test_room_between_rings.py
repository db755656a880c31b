"""Rings around bodies that come close to each other leave room between their fronts."""

import numpy as np
import pytest
from shapely.geometry import Polygon

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.shapes.airfoil.naca import naca_points
from meshonet.solvers.blocking.layers.wall_layers import rings_around
from meshonet.solvers.layers.layer_settings import LayerSettings

FAR = Loop(
    Curve(20.0 * np.exp(2j * np.pi * np.arange(64) / 64)[:, None].view(float), closed=True), (), ("far",)
)


def sharp_airfoil(chord: float, turn: float, at: tuple[float, float]) -> Loop:
    """Return a NACA 0012 with a closed edge, turned by degrees, its nose at a point."""
    points = naca_points("0012-sharp")[::-1]
    points = points[np.hypot(*(points - np.roll(points, 1, axis=0)).T) > 0.0]
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    places = chord * points @ np.array([[c, -s], [s, c]]) + np.array(at)
    corner = int(points[:, 0].argmax())
    return Loop(Curve(places, closed=True, corners=(corner,)), (corner,), ("airfoil",))


@pytest.mark.parametrize("gap", [0.006, 0.012, 0.02])
@pytest.mark.parametrize("overlap", [-0.01, 0.01, 0.03])
def test_fronts_do_not_cross_where_a_sharp_edge_is_close_to_another_wall(gap, overlap):
    main = sharp_airfoil(1.0, 0.0, (0.0, 0.0))
    flap = sharp_airfoil(0.3, 30.0, (1.0 - overlap, 0.0))
    outline = Polygon(main.curve.points)
    down = next(
        y
        for y in np.linspace(0.0, 0.2, 2001)
        if Polygon(flap.curve.points - [0.0, y]).distance(outline) > gap
    )
    flap = sharp_airfoil(0.3, 30.0, (1.0 - overlap, -down))
    rings = rings_around(Domain((FAR, main, flap)), [1, 2], LayerSettings(1e-5))
    one, other = (Polygon(ring.front.at(np.linspace(0, ring.front.length, 4000))) for ring in rings.values())
    assert one.distance(other) > 0.05 * gap
