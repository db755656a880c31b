"""The quad network around bodies: layers that go round, strips, symmetries, walls."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from quad_models import random_model

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.bodies import boundary
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.far_field import straight
from meshonet.kernels._native import activate, upsample
from meshonet.solvers.neural.quad.encoding import features
from meshonet.solvers.neural.quad.inside_point import inside
from meshonet.solvers.neural.quad.network import Network, shapes
from meshonet.solvers.neural.quad.picard import approach
from meshonet.solvers.neural.quad.unrolled import TURN, even, middles, rolled, unrolled
from meshonet.solvers.neural.registry import load

WIDTHS, BLOCKS = (1, 2, 3), (0, 1, 2)


def strips(m: int = 16, n: int = 9, count: int = 2) -> Complexes:
    """Return random closed strips (count, m + 1, n)."""
    rng = np.random.default_rng(0)
    z = np.linspace(0.0, 3.0, m + 1)[:, None] + 1j * np.linspace(0.0, 1.0, n)
    noise = rng.normal(size=(2, count, m + 1, n))
    z = z + 0.02 * (noise[0] + 1j * noise[1])
    z[:, -1] = z[:, 0] + 3.0
    return np.asarray(z)


def weights() -> dict[str, Any]:
    rng = np.random.default_rng(0)
    return {
        name: rng.normal(size=shape) * (2.0 / np.prod(shape[1:])) ** 0.5
        for name, shape in shapes(WIDTHS, BLOCKS, 2).items()
    }


def bodies(count: int = 3, ni: int = 129, nj: int = 17) -> list[Boundary]:
    return [boundary(np.random.default_rng([1, k]), ni, nj) for k in range(count)]


@pytest.fixture
def model(tmp_path: Path) -> str:
    return str(random_model(tmp_path / "round.safetensors", topology="o"))


def nodes(edges: Boundary, model: str, polish: int = 0) -> Floats:
    return load(model).solve([edges], polish)[0].grid.nodes


def test_activation_goes_round_along_the_first_axis() -> None:
    x = np.random.default_rng(0).normal(size=(2, 6, 5, 8))
    plain, result = np.empty((2, 8, 7, 8)), np.empty((2, 8, 7, 8))
    activate(x, plain)
    activate(x, result, True)
    np.testing.assert_array_equal(result[:, 1:-1], plain[:, 1:-1])
    np.testing.assert_array_equal(result[:, 0], plain[:, -2])
    np.testing.assert_array_equal(result[:, -1], plain[:, 1])


def test_finer_copies_go_round_along_the_first_axis() -> None:
    rng = np.random.default_rng(0)
    x, add = rng.normal(size=(2, 6, 5, 8)), rng.normal(size=(2, 12, 9, 8))
    result, closed = np.empty_like(add), np.empty((2, 13, 9, 8))
    upsample(x, add, result, True)
    upsample(np.concatenate([x, x[:, :1]], 1), np.concatenate([add, add[:, :1]], 1), closed)
    np.testing.assert_array_equal(result, closed[:, :-1])


def test_numpy_equals_torch() -> None:
    torch = pytest.importorskip("torch")
    from meshonet.solvers.neural.fit.networks import QuadUNet

    held, z = weights(), strips()
    net = QuadUNet(WIDTHS, BLOCKS, around=True).double()
    net.load_state_dict({name: torch.from_numpy(value) for name, value in held.items()})
    seen = features(*approach(z, np, around=True), np, around=True)
    report = features(*approach(torch.from_numpy(z), torch, around=True), torch, around=True)
    np.testing.assert_allclose(report.numpy(), seen, rtol=0, atol=1e-10)
    with torch.no_grad():
        expected = net(torch.from_numpy(seen)).numpy()
    result = Network(held, BLOCKS, around=True)(seen)
    np.testing.assert_allclose(result, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_the_answer_shifts_with_the_strip_and_vanishes_on_the_walls_alone() -> None:
    z, network = strips(), Network(weights(), BLOCKS, around=True)
    answer = network(features(*approach(z, np, around=True), np, around=True))
    by = 4  # as many columns as one of the coarsest level stands for
    moved = np.concatenate([z[:, by:-1], z[:, : by + 1] + 3.0], axis=1)
    shifted = network(features(*approach(moved, np, around=True), np, around=True))
    np.testing.assert_allclose(shifted, np.roll(answer, -by, axis=2), atol=1e-12 * np.abs(answer).max())
    assert not answer[..., [0, -1]].any()
    assert (answer[..., 1:-1] != 0).all()


def test_a_strip_is_a_conformal_image_that_rolls_up_again() -> None:
    angle, radius = -np.linspace(0.3, 0.3 + TURN, 33), np.exp(np.linspace(0.0, 1.5, 9))
    z = (2.0 + 1j + np.exp(1j * angle[:, None]) * radius)[None]
    centre = middles(z[:, :-1, 0])
    np.testing.assert_allclose(centre, 2.0 + 1j, atol=1e-14)
    strip, once = unrolled(z, centre)
    assert once.all()
    np.testing.assert_allclose(strip, even(strip, 9), atol=1e-13)  # circles are straight and even there
    np.testing.assert_allclose(rolled(strip, centre), z, atol=1e-13)


def test_the_walls_are_bitwise_those_given_and_the_cut_is_closed(model: str) -> None:
    for edges in bodies():
        for polish in (0, 2):
            result = nodes(edges, model, polish)
            np.testing.assert_array_equal(result[:, 0], edges.south)
            np.testing.assert_array_equal(result[:, -1], edges.north)
            np.testing.assert_array_equal(result[0], result[-1])


def moved(edges: Boundary, move: Any) -> Boundary:
    south, north = move(edges.south), move(edges.north)
    cut = straight(south[0], north[0], edges.nj)
    return replace(edges, south=south, north=north, west=cut, east=cut, chord=0.0)


def test_a_body_turned_scaled_and_moved_has_the_same_grid_moved(model: str) -> None:
    turn = np.array([[np.cos(1.0), np.sin(1.0)], [-np.sin(1.0), np.cos(1.0)]])

    def move(points: Floats) -> Floats:
        return 3.7 * points @ turn + np.array([5.0, -2.0])

    for edges in bodies():
        there = nodes(moved(edges, move), model)
        expected = move(nodes(edges, model))
        np.testing.assert_allclose(there, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_a_mirrored_body_has_the_mirrored_grid(model: str) -> None:
    for edges in bodies():
        there = nodes(moved(edges, lambda points: (points * [1.0, -1.0])[::-1].copy()), model)
        plain = nodes(edges, model)
        np.testing.assert_allclose(there, plain[::-1] * [1.0, -1.0], atol=1e-12 * np.abs(plain).max())


@pytest.mark.parametrize("polish", [2, 5])
def test_steps_after_the_network_move_and_mirror_with_the_body(model: str, polish: int) -> None:
    turn = np.array([[np.cos(1.0), np.sin(1.0)], [-np.sin(1.0), np.cos(1.0)]])
    for edges in [*bodies(), clip(98, 17)]:
        plain = nodes(edges, model, polish)
        there = nodes(moved(edges, lambda points: 3.7 * points @ turn + [5.0, -2.0]), model, polish)
        expected = 3.7 * plain @ turn + [5.0, -2.0]
        np.testing.assert_allclose(there, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
        mirror = moved(edges, lambda points: (points * [1.0, -1.0])[::-1].copy())
        expected = plain[::-1] * [1.0, -1.0]
        np.testing.assert_allclose(
            nodes(mirror, model, polish), expected, atol=1e-12 * np.abs(expected).max()
        )


def test_a_body_that_is_its_own_mirror_image_has_such_a_grid() -> None:
    corners = np.array([1, 1 - 1j, -1j, -1 - 1j, -1, -1 + 1j, 1j, 1 + 1j, 1])
    square = np.interp(np.linspace(0, 8, 97), np.arange(9), corners)
    far = 5.0 * np.exp(-2j * np.pi * np.arange(97) / 96)
    far[49:] = far[47::-1].conj()
    far[-1] = far[0]
    south, north = (np.stack([edge.real, edge.imag], axis=1) for edge in (square, far))
    cut = straight(south[0], north[0], 33)
    result = nodes(Boundary(south, north, cut, cut, topology="o"), "hole-o", 5)
    np.testing.assert_allclose(result, result[::-1] * [1.0, -1.0], rtol=0, atol=1e-14)


def test_a_body_begun_a_quarter_further_has_the_same_grid(model: str) -> None:
    """Three levels of this model: an eighth for the four of a shipped one."""
    for edges in bodies():
        by = 32

        def further(points: Floats, by: int = by) -> Floats:
            return np.concatenate([points[by:-1], points[: by + 1]])

        there, plain = nodes(moved(edges, further), model), nodes(edges, model)
        np.testing.assert_allclose(there, further(plain), atol=1e-12 * np.abs(plain).max())


def test_together_is_as_each_alone(model: str) -> None:
    many = load(model).solve(bodies(5), 0)
    for edges, result in zip(bodies(5), many, strict=True):
        np.testing.assert_array_equal(result.grid.nodes, nodes(edges, model))


def test_a_quad_boundary_is_refused(model: str) -> None:
    t = np.linspace(0.0, 1.0, 9)
    low, left = np.stack([t, 0 * t], 1), np.stack([0 * t, t], 1)
    square = Boundary(low, low + np.array([0.0, 1.0]), left, left + np.array([1.0, 0.0]))
    with pytest.raises(InputError, match="makes o grids, and this boundary is quad; use another model"):
        load(model).solve([square])


def clip(ni: int = 66, nj: int = 9) -> Boundary:
    """Return a bent plate whose centroid is outside it."""
    bend = np.linspace(-2.2, 2.2, ni // 2)
    outer, inner = (r * np.stack([np.sin(bend), np.cos(bend)], axis=1) for r in (1.0, 0.7))
    body = np.concatenate([outer, inner[::-1], outer[:1]])
    far = 9.0 * np.stack([np.sin(t := np.linspace(-2.2, -2.2 + 2 * np.pi, len(body))), np.cos(t)], axis=1)
    far[-1] = far[0]
    cut = straight(body[0], far[0], nj)
    return Boundary(body, far, cut, cut, topology="o", name="a clip")


def test_a_body_whose_centroid_is_outside_it_is_seen_from_inside(model: str) -> None:
    wall = clip().south[:-1] @ [1.0, 1.0j]
    assert abs(middles(wall[None])[0]) < 0.7  # in the hollow
    point = inside(wall)
    assert np.abs(wall - point).min() > 0.1
    turns = np.angle(np.roll(wall - point, -1) / (wall - point)).sum() / TURN
    assert abs(turns) == pytest.approx(1.0)
    assert np.isfinite(nodes(clip(), model)).all()


def test_the_point_inside_moves_turns_and_mirrors_with_the_body() -> None:
    wall = clip().south[:-1] @ [1.0, 1.0j]
    point = inside(wall)
    for moved_to in (1e-6 * np.exp(1j), 1e5, 2.0 + 1.0j):
        assert inside(moved_to * wall + 3.0 - 1.0j) == pytest.approx(moved_to * point + 3.0 - 1.0j, rel=1e-12)
    assert inside(np.roll(wall.conj()[::-1], 1)) == pytest.approx(point.conjugate(), rel=1e-12)


def test_the_point_inside_is_where_the_body_is_thickest() -> None:
    """A pan: a disc of radius 1 with a handle, whose thickness is 0.2."""
    t = np.linspace(0.1, 2 * np.pi - 0.1, 80)
    handle = np.array([5.0 - 0.1j, 5.0 + 0.1j])
    pan = np.concatenate([np.exp(1j * t), handle])
    assert abs(inside(pan)) < 0.1


def test_grids_around_bent_bodies_move_and_mirror_with_them(model: str) -> None:
    plain = nodes(clip(), model)
    size = 1e-12 * np.abs(plain).max()
    there = nodes(moved(clip(), lambda points: points @ [[0.0, 2.0], [-2.0, 0.0]] + 3.0), model)
    np.testing.assert_allclose(there, plain @ [[0.0, 2.0], [-2.0, 0.0]] + 3.0, rtol=0, atol=3 * size)
    mirror = moved(clip(), lambda points: (points * [1.0, -1.0])[::-1].copy())
    np.testing.assert_allclose(nodes(mirror, model), plain[::-1] * [1.0, -1.0], rtol=0, atol=size)


def test_polished_grids_around_bent_bodies_are_valid() -> None:
    assert count_folded(load("hole-o").solve([clip(130, 33)])[0].grid.nodes) == 0


def test_a_body_outside_its_far_field_is_refused(model: str) -> None:
    edges = clip()
    cut = straight(edges.south[0] + 90.0, edges.north[0], edges.nj)
    away = replace(edges, south=edges.south + 90.0, west=cut, east=cut)
    with pytest.raises(InputError, match="a clip: its walls do not go once round a middle of the body"):
        load(model).solve([away])
