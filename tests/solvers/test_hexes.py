"""The functional over hexahedra: its value and slopes, however a volume is cut into blocks and bricks."""

from collections.abc import Callable

import numpy as np
import pytest
from joined_volumes import joined, perturbed, shell

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.threads import limited_to
from meshonet.geometry.volume.hex_mesh import HexMesh, hex_mesh_of
from meshonet.solvers.energy.hex_tables import Targets
from meshonet.solvers.energy.hexes import HexProblem, optimise
from meshonet.solvers.smoothing.volume_spacing import wanted_edges

VALID, UNFOLDING = (0.9, 2e-3, 2, 0.0, 0.0), (0.02, 2e-3, 1, 0.3, 0.1)
Weights = tuple[float, float, int, float, float]


def bent(ni: int, nj: int, nk: int, noise: float = 0.004) -> Floats:
    x = np.stack(np.meshgrid(*(np.linspace(0, 1, n) for n in (ni, nj, nk)), indexing="ij"), axis=-1)
    x[..., 0] += 0.2 * x[..., 1] * x[..., 2]
    x[1:-1, 1:-1, 1:-1] += np.random.default_rng(1).normal(size=x[1:-1, 1:-1, 1:-1].shape) * noise
    return x


def alike(mesh: HexMesh) -> Targets:
    """Edges as long as each other."""
    wanted = wanted_edges(mesh, ~mesh.outer, rounds=0)
    return [tuple(np.full_like(each, np.log(0.08)) for each in edges) for edges in wanted]  # type: ignore[misc]


def value(mesh: HexMesh, weights: Weights, targets: Targets) -> tuple[float, Floats]:
    problem = HexProblem(mesh, ~mesh.outer, targets)
    problem.descent.weigh(*weights)
    slopes = np.empty((3, np.count_nonzero(~mesh.outer)))
    return problem.descent.evaluate(slopes)[0], slopes.T


def reference(x: Floats, w: float, beta: float, length: float) -> float:
    """The functional of one block whose edges should all be `length` long."""
    terms = []
    counts = [n - 1 for n in x.shape[:3]]
    for corner in np.ndindex(2, 2, 2):
        edges = []
        for axis in range(3):
            at = [slice(c, c + n) for c, n in zip(corner, counts, strict=True)]
            at[axis] = slice(None)
            edges.append(np.diff(x, axis=axis)[tuple(at)] / length)
        u, v, n = edges
        jacobian = np.einsum("...c,...c", u, np.cross(v, n))
        areas = sum((np.cross(a, b) ** 2).sum(axis=-1) for a, b in ((u, v), (v, n), (n, u)))
        squares = (u**2).sum(-1) * (v**2).sum(-1) * (n**2).sum(-1)
        terms.append((1 - w) * areas / (3 * jacobian) + w * (squares / jacobian**2) ** 2)
    cells = np.prod(counts)
    pairs = 0.0
    for axis in range(3):
        logs = 0.5 * np.log((np.diff(x, axis=axis) ** 2).sum(axis=-1))
        for way in range(3):
            around = np.ones(1)
            for other in range(3):  # cells at the pair, over all that there can be
                if other != axis and other != way:
                    ends = np.ones(logs.shape[other])
                    ends[[0, -1]] = 0.5
                    shape = [1, 1, 1]
                    shape[other] = -1
                    around = around * ends.reshape(shape)
            pairs += float((around * np.diff(logs, axis=way) ** 2).sum())
    return float(np.mean(terms)) + beta * cells ** (2 / 3) / cells * pairs


@pytest.mark.parametrize("shape", [(5, 6, 7), (4, 11, 70), (40, 5, 4)])
def test_the_value_is_that_of_the_formula(shape: tuple[int, int, int]) -> None:
    x = bent(*shape, noise=0.002)
    mesh = hex_mesh_of(Grid((Block(x),)))
    assert value(mesh, VALID, alike(mesh))[0] == pytest.approx(reference(x, 0.9, 2e-3, 0.08), rel=1e-12)


def cut(x: Floats) -> Grid:
    """Blocks of a volume, each turned otherwise."""
    return joined([x[:6, :5], x[5:, :5].transpose(1, 2, 0, 3), x[:, 4:].transpose(2, 0, 1, 3)])


@pytest.mark.parametrize("weights", [VALID, UNFOLDING])
def test_cuts_into_blocks_change_nothing(weights: Weights) -> None:
    x = bent(12, 9, 17)
    whole, parts = hex_mesh_of(Grid((Block(x),))), hex_mesh_of(cut(x))
    one, of_one = value(whole, weights, alike(whole))
    many, of_many = value(parts, weights, alike(parts))
    assert many == pytest.approx(one, rel=1e-13)
    order = [np.lexsort(each.nodes[~each.outer].T) for each in (whole, parts)]
    np.testing.assert_allclose(of_many[order[1]], of_one[order[0]], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("weights", [VALID, UNFOLDING])
@pytest.mark.parametrize("make", [lambda: cut(bent(12, 9, 17)), lambda: perturbed(shell(), 0.2)])
def test_slopes_are_those_of_the_value(make: Callable[[], Grid], weights: Weights) -> None:
    mesh = hex_mesh_of(make())
    targets = wanted_edges(mesh, ~mesh.outer)
    _, slopes = value(mesh, weights, targets)
    way = np.zeros_like(mesh.nodes)
    way[~mesh.outer] = np.random.default_rng(2).normal(size=slopes.shape)
    step = 1e-6
    ends = [value(mesh.with_nodes(mesh.nodes + s * way), weights, targets)[0] for s in (step, -step)]
    expected = float((slopes * way[~mesh.outer]).sum())
    assert (ends[0] - ends[1]) / (2 * step) == pytest.approx(expected, rel=1e-5, abs=1e-6)


def test_the_optimum_is_the_same_to_the_bit_for_any_number_of_threads(eager_threads: None) -> None:
    mesh = hex_mesh_of(perturbed(shell(n=17, layers=24), 0.5))
    results = []
    for threads in (1, 2, 3):
        with limited_to(threads):
            results.append(optimise(mesh, ~mesh.outer, wanted_edges(mesh, ~mesh.outer), iterations=4).nodes)
    np.testing.assert_array_equal(results[0], results[1])
    np.testing.assert_array_equal(results[0], results[2])


def test_a_box_is_its_own_optimum() -> None:
    x = np.stack(np.meshgrid(np.linspace(0, 3, 7), *(np.linspace(0, 1, 5),) * 2, indexing="ij"), axis=-1)
    mesh = hex_mesh_of(Grid((Block(x),)))
    optimum = optimise(mesh, ~mesh.outer, wanted_edges(mesh, ~mesh.outer))
    np.testing.assert_allclose(optimum.nodes, mesh.nodes, atol=1e-7)
    assert optimum.value == pytest.approx(1.0)
