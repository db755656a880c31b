"""Derivatives of nodes by boundary nodes: against finite differences, and products against each other."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import meshonet
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError, NoValidGridError, SolverError
from meshonet.solvers.derivatives.lattice import jacobian
from meshonet.solvers.derivatives.optimum import OptimumDerivative, aspect_slope, winslow_residual
from meshonet.solvers.energy.functional import aspect_of

EXAMPLE = Path(__file__).parents[2] / "examples" / "shape-optimisation" / "throat.py"
RANDOM = np.random.default_rng(7)


def bump(height: float, n: int = 41) -> Floats:
    x = np.linspace(0, 3, n)
    return np.stack([x, height * np.exp(-(((x - 1.5) / 0.4) ** 2))], axis=1)


def channel(ni: int = 41, nj: int = 17) -> Grid:
    away = np.expm1(3 * np.linspace(0, 1, nj)) / np.expm1(3)
    x, y = np.meshgrid(np.linspace(0, 3, ni), away, indexing="ij")
    return Grid.from_nodes(np.stack([x, y], axis=-1))


def two_blocks() -> Grid:
    whole = ((0, 16),)
    nodes = channel().nodes
    blocks = tuple(Grid.from_nodes(part).blocks[0] for part in (nodes[:21], nodes[20:]))
    joined = Connection(0, "east", whole, 1, "west", whole, (1,))
    return Grid(blocks, tuple(Patch("floor", "south", 0, 20, block=k) for k in (0, 1)), (joined,))


def c_case() -> tuple[Grid, dict[str, Floats]]:
    start = meshonet.grid("naca:0012", res=(81, 33), topology="c", te="wedge", first_cell=1e-4)
    wall = slice(start.wake, start.ni - start.wake)
    return start, {"wall": meshonet.deform(start, "naca:2412").nodes[wall, 0]}


def smooth_moves(n: int) -> Floats:
    """Moves of n nodes that are zero at both ends."""
    s = np.linspace(0, 1, n)
    return np.stack([0.3 * np.sin(2 * np.pi * s), np.sin(np.pi * s)], axis=1)


CASES = {
    "wake": c_case,
    "sliding sides": lambda: (channel(), {"south": bump(0.2) + np.array([0, 0.1])}),
    "blocks": lambda: (two_blocks(), {"floor": bump(0.2)}),
}


@pytest.mark.parametrize("case", CASES)
def test_deformed_nodes_follow_walls_as_differences_say(case: str) -> None:
    start, walls = CASES[case]()
    derivative = meshonet.deform_derivative(start, walls)
    ((name, nodes),) = walls.items()
    moves = smooth_moves(len(nodes))
    if case == "sliding sides":
        moves[:, 1] += 0.5  # the corners slide too
    step = 1e-6
    ahead, back = (meshonet.deform(start, {name: nodes + s * step * moves}) for s in (1, -1))
    for own, a, b in zip(derivative.along({name: moves}), ahead.blocks, back.blocks, strict=True):
        assert own == pytest.approx((a.nodes - b.nodes) / (2 * step), abs=1e-7)


@pytest.mark.parametrize("case", CASES)
def test_pulls_on_deformed_nodes_come_back_to_walls(case: str) -> None:
    start, walls = CASES[case]()
    derivative = meshonet.deform_derivative(start, walls)
    ((name, nodes),) = walls.items()
    moves, pull = smooth_moves(len(nodes)), [RANDOM.standard_normal(b.nodes.shape) for b in start.blocks]
    forward = sum(float((p * m).sum()) for p, m in zip(pull, derivative.along({name: moves}), strict=True))
    assert float((derivative.transposed(pull)[name] * moves).sum()) == pytest.approx(forward, rel=1e-9)


def test_the_deformed_grid_comes_with_its_derivative() -> None:
    walls = {"south": bump(0.2)}
    made = meshonet.deform_derivative(channel(), walls)
    assert np.array_equal(made.grid.nodes, meshonet.deform(channel(), walls).nodes)
    assert len(made.walls["south"]) == 41


def optimum(method: str) -> OptimumDerivative:
    x, y = np.meshgrid(np.linspace(0, 3, 31), np.linspace(0, 1, 13), indexing="ij")
    low = bump(0.3, 31)[:, 1:]
    start = Grid.from_nodes(np.stack([x, low * (1 - y) + y * (1 + 0.05 * np.sin(x))], axis=-1))
    solved = meshonet.solve_pde(start, res=(31, 13), method=method)
    return meshonet.optimum_derivative(solved, method=method)


def with_rim(grid: Grid, moves: Floats) -> Grid:
    rim = np.ones(grid.nodes.shape, dtype=bool)
    rim[1:-1, 1:-1] = False
    return Grid.from_nodes(np.where(rim, grid.nodes + moves, grid.nodes))


@pytest.mark.parametrize("method", ["variational", "winslow"])
def test_optima_follow_their_rim_as_differences_say(method: str) -> None:
    made = optimum(method)
    moves = np.zeros((31, 13, 2))
    moves[:, 0], moves[:, -1] = smooth_moves(31), 0.3
    moves[0, :, 1] += np.linspace(0, 0.3, 13)
    step = 1e-5
    ahead, back = (OptimumDerivative(with_rim(made.grid, s * step * moves), method).grid for s in (1, -1))
    assert made.along(moves) == pytest.approx((ahead.nodes - back.nodes) / (2 * step), abs=1e-6)


@pytest.mark.parametrize("method", ["variational", "winslow"])
def test_pulls_on_optima_come_back_to_the_rim(method: str) -> None:
    made = optimum(method)
    moves, pull = RANDOM.standard_normal((2, 31, 13, 2))
    back = made.transposed(pull)
    assert not back[1:-1, 1:-1].any()
    assert float((back * moves).sum()) == pytest.approx(float((pull * made.along(moves)).sum()), rel=1e-8)


def test_moving_the_whole_rim_moves_the_whole_grid() -> None:
    for method in ("variational", "winslow"):
        made = optimum(method)
        shift = np.broadcast_to([0.3, -0.7], (31, 13, 2))
        assert made.along(shift) == pytest.approx(shift, abs=1e-7)
        assert made.along(made.grid.nodes) == pytest.approx(made.grid.nodes, abs=1e-6)  # scaled


def test_the_grid_it_returns_solves_winslows_equations_to_rounding() -> None:
    nodes = np.moveaxis(optimum("winslow").grid.nodes, -1, 0)
    assert np.abs(winslow_residual(nodes)).max() < 1e-15


def test_the_jacobian_of_a_quadratic_is_exact() -> None:
    nodes = np.array(np.moveaxis(channel(9, 7).nodes, -1, 0))

    def product(z: Floats) -> Floats:
        value = np.zeros_like(z)
        value[:, 1:-1, 1:-1] = z[::-1, 2:, 1:-1] * z[:, 1:-1, :-2]
        return value

    entries = jacobian(product, nodes, reach=1)
    moves = RANDOM.standard_normal(nodes.shape)
    exact = moves[::-1, 2:, 1:-1] * nodes[:, 1:-1, :-2] + nodes[::-1, 2:, 1:-1] * moves[:, 1:-1, :-2]
    result = entries.times(moves.ravel()).reshape(nodes.shape)[:, 1:-1, 1:-1]
    assert result == pytest.approx(exact, abs=1e-8)
    left, right = RANDOM.standard_normal((2, nodes.size))
    assert left @ entries.times(right) == pytest.approx(entries.transposed_times(left) @ right, rel=1e-12)


def test_the_ratio_of_steps_has_its_derivative() -> None:
    nodes, moves = channel().nodes, RANDOM.standard_normal((41, 17, 2))
    ahead, back = (aspect_of(nodes + s * 1e-6 * moves) for s in (1, -1))
    slope = np.moveaxis(aspect_slope(np.moveaxis(nodes, -1, 0)), 0, -1)
    assert float((slope * moves).sum()) == pytest.approx((ahead - back) / 2e-6, rel=1e-6)


def test_the_example_has_the_gradient_of_its_goal() -> None:
    throat = runpy.run_path(str(EXAMPLE))

    def skew(shape: Floats) -> tuple[float, Floats]:
        heights, slopes = throat["top"](shape)
        made = meshonet.solve_pde(throat["boundary"](heights), method="variational")
        derivative = meshonet.optimum_derivative(made)
        value, slope = throat["skewness"](derivative.grid.nodes)
        return value, slopes @ derivative.transposed(slope)[:, -1, 1]

    shape, way = np.array([1.0, 0.1, 0, 0, 0.02, 0]), np.array([0.0, 1, 2, -1, 0, 1])
    ends = [skew(shape + s * 1e-4 * way)[0] for s in (1, -1)]
    assert float(skew(shape)[1] @ way) == pytest.approx((ends[0] - ends[1]) / 2e-4, rel=1e-4)


def test_what_has_no_derivative_is_refused() -> None:
    ring = meshonet.grid("naca:0012", res=(41, 15))
    with pytest.raises(InputError, match="topology o"):
        meshonet.optimum_derivative(ring)
    with pytest.raises(InputError, match="'tfi' has no derivative; use variational or winslow"):
        meshonet.optimum_derivative(channel(), method="tfi")
    with pytest.raises(SolverError, match="no solution by winslow"):
        meshonet.optimum_derivative(channel(), method="winslow")
    with pytest.raises(NoValidGridError, match="in one step"):
        meshonet.deform_derivative(channel(), {"south": bump(0.9)})
    volume = np.stack(np.meshgrid(*[np.arange(4.0)] * 3, indexing="ij"), axis=-1)
    with pytest.raises(InputError, match="volume"):
        meshonet.deform_derivative(Grid.from_nodes(volume), {"bottom": volume[:, :, 0]})
    with pytest.raises(InputError, match="moves of shape"):
        meshonet.deform_derivative(channel(), {"south": bump(0.1)}).along({"south": np.zeros((3, 2))})
    with pytest.raises(InputError, match="other sizes"):
        meshonet.deform_derivative(channel(), {"south": bump(0.1)}).transposed(np.zeros((3, 2, 2)))
