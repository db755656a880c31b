"""The corner energy against finite differences and known angles; unfolding of what solvers fold."""

import numpy as np
import pytest
from solver_shapes import arch, folded, hole, l_shape, meets, naca, spike, wrench

from meshonet.geometry.arrays import Floats, as_planar
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.family import family
from meshonet.kernels._native import repair_energy, repair_minimise
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.energy import untangle as unfolding
from meshonet.solvers.energy.repair import repair
from meshonet.solvers.energy.untangle import FUTILE, Patience, reference_lengths, unfold


def tangled(boundary: Boundary, amount: float, seed: int = 0) -> Floats:
    """Interpolation of the boundary, inner nodes moved at random."""
    nodes = tfi(boundary).nodes.copy(order="K")
    rng = np.random.default_rng(seed)
    rows = slice(None) if boundary.topology == "o" else slice(1, -1)
    nodes[rows, 1:-1] += rng.normal(0, amount, nodes[rows, 1:-1].shape)
    if boundary.topology == "o":
        nodes[-1] = nodes[0]
    return nodes


@pytest.mark.parametrize(("shape", "epsilon"), [(0.0, 0.0), (0.0, 0.3), (0.5, 0.0), (1.0, 0.2)])
@pytest.mark.parametrize("periodic", [False, True])
def test_gradient_is_that_of_the_energy(shape: float, epsilon: float, periodic: bool) -> None:
    nodes = tangled(naca(9, 6) if periodic else arch(7, 6), 0.004 if epsilon == 0 else 0.3)
    lengths = reference_lengths(nodes, periodic)
    x, y = nodes[..., 0], nodes[..., 1]
    _, gx, gy, _ = repair_energy(x, y, *lengths, periodic, shape, epsilon)
    rng = np.random.default_rng(1)
    dx, dy = rng.normal(0, 1, x.shape), rng.normal(0, 1, x.shape)
    dx[:, [0, -1]] = dy[:, [0, -1]] = 0
    if periodic:
        dx[-1], dy[-1] = dx[0], dy[0]
    else:
        dx[[0, -1]] = dy[[0, -1]] = 0
    h = 1e-6
    up = repair_energy(x + h * dx, y + h * dy, *lengths, periodic, shape, epsilon)[0]
    down = repair_energy(x - h * dx, y - h * dy, *lengths, periodic, shape, epsilon)[0]
    assert (gx * dx + gy * dy).sum() == pytest.approx((up - down) / (2 * h), rel=1e-5)
    assert (gx[:, [0, -1]] == 0).all()
    assert periodic or (gx[[0, -1]] == 0).all()


def test_energy_of_a_parallelogram_is_known() -> None:
    angle = np.radians(50.0)
    u, v = np.array([2.0, 0.0]), 0.5 * np.array([np.cos(angle), np.sin(angle)])
    nodes = as_planar(np.array([[[0, 0], v], [u, u + v]], dtype=float))
    width, height = np.array([2.0]), np.array([0.5])
    total, _, _, smallest = repair_energy(nodes[..., 0], nodes[..., 1], width, height, False, 1.0, 0.0)
    assert total == pytest.approx(4 / np.sin(angle) ** 4)
    assert smallest == pytest.approx(np.sin(angle))
    harmonic = repair_energy(nodes[..., 0], nodes[..., 1], width, height, False, 0.0, 0.0)[0]
    assert harmonic == pytest.approx(4 / np.sin(angle))


def test_a_folded_patch_costs_infinitely_without_regularisation() -> None:
    nodes = tangled(arch(9, 9), 0.3)
    assert folded(nodes) > 0
    assert (
        repair_energy(nodes[..., 0], nodes[..., 1], *reference_lengths(nodes, False), False, 0.0, 0.0)[0]
        == np.inf
    )


def test_a_minimum_is_found_to_the_tolerance_and_kept() -> None:
    nodes = tangled(arch(17, 17), 0.005)
    lengths = reference_lengths(nodes, False)
    x, y = nodes[..., 0], nodes[..., 1]
    first = repair_minimise(x, y, *lengths, False, 0.0, 0.0, 500, 1e-9)
    gx, gy = repair_energy(x, y, *lengths, False, 0.0, 0.0)[1:3]
    assert np.hypot(gx, gy).max() < 1e-4
    assert repair_minimise(x, y, *lengths, False, 0.0, 0.0, 500, 1e-9)[1] == pytest.approx(
        first[1], rel=1e-12
    )


@pytest.mark.parametrize(
    "boundary", [arch(25, 20), l_shape(30, 15), hole(40, 12), naca(40, 15, far=2.0)], ids=lambda b: b.name
)
def test_random_tangles_unfold(boundary: Boundary) -> None:
    nodes = tangled(boundary, 0.05)
    assert folded(nodes) > 10
    assert unfold(nodes, boundary.topology == "o", Patience()) == 0
    assert folded(nodes) == 0


CASES = [(wrench, 50), (wrench, 101), (wrench, 200), (spike, 60), (naca, 100)]


@pytest.mark.parametrize(("make", "n"), CASES)
@pytest.mark.parametrize("start", ["winslow", "tfi"])
def test_what_solvers_fold_is_repaired_and_the_boundary_kept(make, n: int, start: str) -> None:  # type: ignore[no-untyped-def]
    boundary = make(n, n)
    made = solve(boundary).grid.nodes if start == "winslow" else tfi(boundary).nodes
    nodes = made.copy(order="K")
    assert repair(nodes, boundary.topology == "o") == 0
    assert folded(nodes) == 0
    assert meets(nodes, boundary)
    if folded(made) == 0:
        assert np.array_equal(nodes, made)


def test_a_fold_across_the_seam_is_repaired() -> None:
    boundary = naca(200, 40)
    nodes = tfi(boundary).nodes.copy(order="K")
    nodes[0, 5] = nodes[-1, 5] = nodes[2, 8]
    nodes[1, 6] = nodes[-3, 3]
    assert folded(nodes) > 3
    far = nodes[60:140].copy()
    assert repair(nodes, True) == 0
    assert np.array_equal(nodes[0], nodes[-1])
    assert np.array_equal(nodes[60:140], far)


def test_repaired_corners_are_open_not_merely_positive() -> None:
    boundary = wrench(101, 101)
    nodes = solve(boundary).grid.nodes.copy(order="K")
    repair(nodes, False)
    u, v = nodes[1:, :-1] - nodes[:-1, :-1], nodes[:-1, 1:] - nodes[:-1, :-1]
    sine = (
        (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
        / np.linalg.norm(u, axis=-1)
        / np.linalg.norm(v, axis=-1)
    )
    assert sine.min() > 0.2


def test_shapes_that_are_nearly_the_same_are_repaired_alike_with_a_wide_margin() -> None:
    """The jaw of a wrench is opened by 0.01: nodes of its boundary move by 0.005."""
    moved = {}
    for margin in (6, 12):
        made = []
        for opening in (0.25, 0.26):
            nodes = solve(family("wrench").boundary(opening, 101, 101)).grid.nodes.copy(order="K")
            assert folded(nodes) > 0
            assert repair(nodes, False, margin) == 0
            made.append(nodes)
        moved[margin] = np.abs(made[1] - made[0]).max()
    assert moved[12] < 0.01 < moved[6]


@pytest.mark.parametrize("shape", [(2, 5), (5, 2), (2, 2)])
def test_a_grid_without_inner_nodes_is_left_alone(shape: tuple[int, int]) -> None:
    nodes = tfi(arch(*shape)).nodes.copy(order="K")
    before = nodes.copy()
    assert repair(nodes, False) == folded(nodes)
    assert np.array_equal(nodes, before)


def test_what_cannot_be_unfolded_is_given_up_soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two nodes of an edge in the wrong order fold a cell for good; without a limit it took minutes."""
    xi, eta = np.meshgrid(np.linspace(0, 2, 81), np.linspace(0, 1, 61) ** 4, indexing="ij")
    nodes = as_planar(np.stack([xi, eta], axis=-1))
    for i in (20, 50):
        nodes[[i, i + 1], 0] = nodes[[i + 1, i], 0]
    spent = 0

    def counted(x: Floats, *rest: object) -> tuple[int, float, float]:
        nonlocal spent
        spent += x.size
        return repair_minimise(x, *rest)  # type: ignore[no-any-return]

    monkeypatch.setattr(unfolding, "repair_minimise", counted)
    assert repair(nodes, False) > 0
    assert 0 < spent < 4 * FUTILE
