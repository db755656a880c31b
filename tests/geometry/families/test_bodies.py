"""Random bodies in far fields: simple, apart, wound once, and the same shape at any node counts."""

import numpy as np
import pytest

from meshonet.geometry.families.bodies import CLEARANCE, boundary
from meshonet.geometry.polygon.self_intersection import find_crossing

SEEDS = range(24)


def made(seed: int, ni: int = 129, nj: int = 9) -> tuple[np.ndarray, np.ndarray]:
    edges = boundary(np.random.default_rng(seed), ni, nj)
    assert edges.topology == "o"
    return edges.south, edges.north


@pytest.mark.parametrize("seed", SEEDS)
def test_body_and_far_field_are_simple(seed: int) -> None:
    for wall in made(seed):
        assert find_crossing(wall[:-1]) is None


@pytest.mark.parametrize("seed", SEEDS)
def test_the_body_is_inside_and_apart(seed: int) -> None:
    body, far = made(seed, 257)
    for point in body[::16]:
        off = (far - point) @ np.array([1.0, 1.0j])
        assert np.angle(off[1:] / off[:-1]).sum() == pytest.approx(-2 * np.pi)
    radius = np.hypot(*(body - body.mean(axis=0)).T).mean()
    gap = np.hypot(*(body[:, None] - far[None]).transpose(2, 0, 1)).min()
    assert gap > 0.7 * CLEARANCE * radius


@pytest.mark.slow
def test_corners_are_nodes_at_any_node_count() -> None:
    for seed in SEEDS:
        coarse, fine = (made(seed, n)[0] for n in (97, 193))
        lengths = [np.hypot(*np.diff(wall, axis=0).T).sum() for wall in (coarse, fine)]
        assert lengths[0] == pytest.approx(lengths[1], rel=6e-3)  # a missed corner would cut it short


@pytest.mark.slow
def test_there_are_bodies_with_corners_and_without_and_square_far_fields() -> None:
    def bend(wall: np.ndarray) -> float:
        steps = np.diff(wall[:-1], axis=0, append=wall[:1]) @ np.array([1.0, 1.0j])
        return float(np.degrees(np.abs(np.angle(np.roll(steps, -1) / steps)).max()))

    bends = np.array([[bend(wall) for wall in made(seed, 257)] for seed in range(60)])
    for column in bends.T:
        assert (column > 60).sum() >= 10
        assert (column < 20).sum() >= 10
