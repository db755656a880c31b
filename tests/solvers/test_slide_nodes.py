"""Wall nodes that slide: lines leave the walls of channels at right angles, in layers of 1e-5 too."""

import numpy as np
import pytest
from solver_shapes import arch, folded, hexagon, hole, quad, segment

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.layers.first_cells import Heights
from meshonet.solvers.layers.redistribute import spread
from meshonet.solvers.layers.slide_nodes import slide_walls


def step(x: Floats, steepness: float) -> Floats:
    return np.asarray(1 / (1 + np.exp(-steepness * (x - 2))))


WALLS = {
    "bump": lambda x: (0.2 * np.exp(-8 * (x - 2) ** 2), 1 + 0 * x),
    "two bumps": lambda x: (0.2 * np.exp(-8 * (x - 1.5) ** 2), 1 - 0.15 * np.exp(-10 * (x - 2.3) ** 2)),
    "nozzle": lambda x: (0 * x, 1 - 0.5 * np.exp(-3 * (x - 2) ** 2)),
    "contraction": lambda x: (0 * x, 1 - 0.4 * step(x, 6)),
    "S-duct": lambda x: (0.6 * step(x, 5), 1 + 0.6 * step(x, 5)),
    "diffuser": lambda x: (0 * x, 1 + 0.3 * (x / 4) ** 2 * (3 - x / 2)),
    "hills": lambda x: (0.05 * (1 - np.cos(np.pi * x)), 1 + 0 * x),
    "venturi": lambda x: (0.15 * np.exp(-4 * (x - 2) ** 2), 1 - 0.15 * np.exp(-4 * (x - 2) ** 2)),
}


def channel(kind: str, ni: int = 161, nj: int = 81, clustered: float = 0.0) -> Boundary:
    """A channel of length 4 and height about 1, walls smooth and level at both ends."""
    t = np.linspace(0, 1, ni)
    x = 4 * (t - clustered * np.sin(2 * np.pi * t) / (2 * np.pi))
    floor, roof = WALLS[kind](x)
    south, north = np.stack([x, floor], axis=1), np.stack([x, roof], axis=1)
    west, east = segment(south[0], north[0], nj), segment(south[-1], north[-1], nj)  # type: ignore[arg-type]
    return quad(south, north, west, east, kind)


def bend(kind: str, ni: int = 161, nj: int = 61) -> Boundary:
    """A bend of 90 or 180 degrees whose inner wall waves."""
    angle = np.linspace(0, np.pi if kind == "U" else np.pi / 2, ni)
    wave = 0.06 * np.sin(angle * (3 if kind == "U" else 6)) ** 2
    ring = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    south, north = 1.5 * ring, (0.6 + wave)[:, None] * ring
    west, east = segment(south[0], north[0], nj), segment(south[-1], north[-1], nj)  # type: ignore[arg-type]
    return quad(south, north, west, east, kind)


def leans(nodes: Floats, boundary: Boundary) -> Floats:
    """Degrees (2, ni - 4) between first cells' lines and the wall's normal, its tangent by splines."""
    results = []
    for wall, (one, two) in ((boundary.south, (0, 1)), (boundary.north, (-1, -2))):
        curve, out = Curve(wall), nodes[:, two] - nodes[:, one]
        tangent = curve.tangent(curve.knots)
        sine = (out * tangent).sum(axis=1) / np.hypot(*out.T)
        results.append(np.degrees(np.arcsin(np.abs(sine)))[2:-2])
    return np.array(results)


CHANNELS = [*(channel(kind) for kind in WALLS), bend("U"), bend("L")]


@pytest.mark.parametrize("boundary", CHANNELS, ids=lambda b: b.name)
def test_channels_have_thin_layers_at_right_angles_to_both_walls(boundary: Boundary) -> None:
    slid, controls = slide_walls(boundary)
    made = spread(solve(slid, controls=controls), slid, Heights(south=1e-5, north=1e-5))
    nodes = made.grid.nodes
    assert folded(nodes) == 0
    for one, two in ((0, 1), (-1, -2)):
        np.testing.assert_allclose(np.hypot(*(nodes[:, two] - nodes[:, one]).T), 1e-5, rtol=1e-8)
    assert leans(nodes, slid).max() < 1.0


def test_without_sliding_the_lines_lean() -> None:
    """What the test above would see."""
    boundary = channel("nozzle")
    nodes = spread(solve(boundary), boundary, Heights(south=1e-5, north=1e-5)).grid.nodes
    assert leans(nodes, boundary).max() > 20


def test_random_channels() -> None:
    rng = np.random.default_rng(4)
    x = np.linspace(0, 4, 141)
    level = np.sin(np.pi * x / 4) ** 2  # walls level at both ends
    for _ in range(6):
        waves = [
            sum(rng.normal(0, 0.05) * np.sin((k + 1) * x + rng.uniform(0, 6)) for k in range(4)) for _ in "ab"
        ]
        south, north = np.stack([x, level * waves[0]], axis=1), np.stack([x, 1 + level * waves[1]], axis=1)
        boundary = quad(south, north, segment((0, 0), (0, 1), 61), segment((4, 0), (4, 1), 61))
        slid, controls = slide_walls(boundary)
        nodes = spread(solve(slid, controls=controls), slid, Heights(south=1e-5, north=1e-5)).grid.nodes
        assert folded(nodes) == 0
        assert leans(nodes, slid).max() < 1.0


def test_wall_nodes_stay_on_the_walls_in_order_and_corners_where_they_are() -> None:
    boundary = channel("bump")
    slid, _ = slide_walls(boundary)
    x = slid.south[:, 0]
    assert (np.diff(x) > 0).all()
    np.testing.assert_allclose(slid.south[:, 1], 0.2 * np.exp(-8 * (x - 2) ** 2), atol=1e-6)
    np.testing.assert_array_equal(slid.south[[0, -1]], boundary.south[[0, -1]])
    np.testing.assert_array_equal(slid.north[[0, -1]], boundary.north[[0, -1]])
    assert np.abs(x - boundary.south[:, 0]).max() > 1e-3


def test_kinks_stay_nodes() -> None:
    slid, _ = slide_walls(hexagon(101, 65))
    assert np.hypot(*(slid.south - (0.5, -0.5)).T).min() < 1e-12
    assert np.hypot(*(slid.north - (0.5, 1.5)).T).min() < 1e-12


def test_the_spacing_along_the_walls_is_kept_by_a_control_function() -> None:
    """Nodes crowded at both ends of a channel stay crowded; without control they would even out."""
    boundary = channel("bump", clustered=0.8)
    slid, controls = slide_walls(boundary)
    assert controls is not None
    solution = solve(slid, controls=controls)
    steps = np.hypot(*np.diff(slid.south, axis=0).T)
    assert steps[0] < 0.35 * steps.mean()
    assert leans(spread(solution, slid, Heights(south=1e-5)).grid.nodes, slid).max() < 1.0


def test_a_ring_does_not_slide() -> None:
    with pytest.raises(InputError, match="walls of topology o cannot slide; slide those of channels"):
        slide_walls(hole(41, 20))


def test_too_few_nodes_to_slide_are_left() -> None:
    boundary = arch(4, 4)
    np.testing.assert_array_equal(slide_walls(boundary)[0].south, boundary.south)
