"""Volumes inside six faces: interpolated, Winslow's, variational."""

from functools import partial

import near_faces_reference
import numpy as np
import pytest
from volume_shapes import bent_pipe, bump, mapped, random_domain, skewed

from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import count_folded, measure
from meshonet.geometry.threads import limited_to
from meshonet.solvers.solution import Outcome
from meshonet.solvers.volumes.edge_corners import closed_place
from meshonet.solvers.volumes.planes_descent import PlanesDescent
from meshonet.solvers.volumes.tfi import tfi
from meshonet.solvers.volumes.variational import variational
from meshonet.solvers.volumes.winslow import winslow

SOLVERS = (tfi, winslow, variational)


def boolean_sum(nodes: np.ndarray) -> np.ndarray:
    """Return the transfinite interpolation of the faces of `nodes`, one direction after the other."""
    result = np.zeros_like(nodes)
    for axis in range(3):
        rest = np.moveaxis(nodes - result, axis, 0)
        weight = np.linspace(0.0, 1.0, len(rest))[:, None, None, None]
        result = result + np.moveaxis((1 - weight) * rest[0] + weight * rest[-1], 0, axis)
    return result


@pytest.mark.parametrize("blending", ["linear", "arclength"])
def test_interpolation_is_the_boolean_sum_of_three_directions(blending: str) -> None:
    nodes = mapped(bent_pipe, (7, 8, 9))  # its edges are evenly spaced
    grid = tfi(SixFaces.of_block(nodes), blending=blending).grid
    np.testing.assert_allclose(grid.nodes, boolean_sum(nodes), atol=1e-13)


def test_interpolation_by_arc_length_follows_clustered_edges() -> None:
    nodes = mapped(lambda a, b, c: (a, b, c**3), (6, 7, 8))
    np.testing.assert_allclose(tfi(SixFaces.of_block(nodes)).grid.nodes, nodes, atol=1e-15)
    skew = mapped(lambda a, b, c: (a, b, (1 - a) * c**3 + a * c), (6, 7, 8))
    np.testing.assert_allclose(tfi(SixFaces.of_block(skew)).grid.nodes, skew, atol=1e-15)


@pytest.mark.parametrize("solve", SOLVERS)
@pytest.mark.parametrize("counts", [(5, 6, 7), (17, 12, 9), (3, 3, 3)])
def test_faces_are_kept_bitwise_and_boxes_are_even(solve, counts) -> None:
    faces = SixFaces.of_block(mapped(skewed, counts))
    grid = solve(faces).grid
    for own, other in zip(faces.faces, SixFaces.of_block(grid.nodes).faces, strict=True):
        np.testing.assert_array_equal(own, other)
    box = mapped(lambda a, b, c: (a, 2 * b, 3 * c), counts)
    np.testing.assert_allclose(solve(SixFaces.of_block(box)).grid.nodes, box, atol=1e-6)


@pytest.mark.parametrize("solve", SOLVERS)
def test_threads_change_no_bit(eager_threads, solve) -> None:
    faces = random_domain(3, 21)
    grids = []
    for threads in (1, 2, 3):
        with limited_to(threads):
            grids.append(solve(faces).grid.nodes)
    np.testing.assert_array_equal(grids[0], grids[1])
    np.testing.assert_array_equal(grids[0], grids[2])


@pytest.mark.parametrize(("solve", "within"), [(partial(winslow, tol=1e-8), 1e-6), (variational, 2e-3)])
def test_symmetric_faces_have_a_symmetric_volume(solve, within) -> None:
    nodes = solve(SixFaces.of_block(mapped(bump, (13, 13, 13)))).grid.nodes
    np.testing.assert_allclose(nodes[::-1, :, :, 0], 1.0 - nodes[..., 0], atol=within)
    np.testing.assert_allclose(nodes.swapaxes(0, 1)[..., 2], nodes[..., 2], atol=within)


def harmonic(a, b, c):
    """A map whose inverse is harmonic: exponentials of a conformal map in the plane, times a line."""
    size, angle = np.exp(0.9 * a), 0.9 * b
    return size * np.cos(angle), size * np.sin(angle), c + 0.0 * a


def test_winslow_converges_with_second_order_to_a_harmonic_map() -> None:
    errors = []
    for n in (9, 17, 33):
        exact = mapped(harmonic, (n, n, 9))
        errors.append(np.abs(winslow(SixFaces.of_block(exact), tol=1e-8).grid.nodes - exact).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (np.abs(orders - 2.0) < 0.25).all()


def test_winslow_without_tolerance_is_below_the_discretisation_error() -> None:
    faces = random_domain(5, 33)
    exact = winslow(faces, tol=1e-8).grid.nodes
    coarse = winslow(faces.resampled((17, 17, 17)), tol=1e-8).grid.nodes
    discretisation = np.abs(exact[::2, ::2, ::2] - coarse).max() / 3
    assert np.abs(winslow(faces).grid.nodes - exact).max() < discretisation


def test_semi_coarsening_takes_cells_of_any_shape() -> None:
    faces = SixFaces.of_block(mapped(lambda a, b, c: bent_pipe(a, b, 6 * c / 6), (33, 33, 9)))
    assert winslow(faces, tol=1e-6).cycles <= 8


def value(planes: np.ndarray, weights: tuple, gradient: np.ndarray, cubes: bool = False) -> float:
    descent = PlanesDescent(planes, cubes)
    descent.descent.weigh(*weights)
    return descent.descent.evaluate(gradient)[0]


def test_the_gradient_is_that_of_the_functional() -> None:
    planes = np.ascontiguousarray(np.moveaxis(mapped(skewed, (6, 7, 8)), -1, 0))
    planes[:, 1:-1, 1:-1, 1:-1] += 0.02 * np.random.default_rng(0).normal(size=(3, 4, 5, 6))
    inner = (slice(None), *[slice(1, -1)] * 3)
    step = np.zeros_like(planes)
    step[inner] = np.random.default_rng(1).normal(size=step[inner].shape)
    for weights in ((0.9, 2e-3, 2), (0.3, 2e-3, 1), (0.02, 2e-3, 1, 0.3), (1.0, 0.0, 0)):
        gradient, spare = np.empty((3, 4 * 5 * 6)), np.empty((3, 4 * 5 * 6))
        value(planes, weights, gradient)
        ends = [value(planes + h * step, weights, spare) for h in (1e-7, -1e-7)]
        slope = (gradient * step[inner].reshape(3, -1)).sum()
        assert (ends[0] - ends[1]) / 2e-7 == pytest.approx(slope, rel=1e-6)


def test_the_energy_of_shapes_is_the_inverse_mean_ratio() -> None:
    for thick, wanted in ((1.0, 1.0), (2.0, 6.0 / (3.0 * 2.0 ** (2.0 / 3.0)))):
        box = np.moveaxis(mapped(lambda a, b, c, z=thick: (a, b, z * c), (5, 5, 5)), -1, 0)
        result = value(np.ascontiguousarray(box), (1.0, 0.0, 0), np.empty((3, 27)), cubes=True)
        assert result == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("shape", [bump, skewed])
def test_least_energy_of_shapes_has_cells_more_like_cubes(shape) -> None:
    faces = SixFaces.of_block(mapped(shape, (21, 21, 21)))
    angles, cubes = (variational(faces, energy=energy).grid for energy in ("angles", "shape"))
    assert count_folded(cubes.nodes) == 0
    assert (1 / mean_ratios(cubes.nodes)).mean() < (1 / mean_ratios(angles.nodes)).mean()
    assert cubes.provenance["energy"] == "shape"


def mean_ratios(nodes: np.ndarray) -> np.ndarray:
    """Return 3 det(T)^(2/3) / |T|^2 at the centres of cells."""
    edges = []
    for axis in range(3):
        edge = np.diff(nodes, axis=axis)
        for other in {0, 1, 2} - {axis}:
            edge = np.take(edge, range(edge.shape[other] - 1), other) + np.diff(edge, axis=other) / 2
        edges.append(edge)
    matrix = np.stack(edges, axis=-1)
    return 3 * np.cbrt(np.linalg.det(matrix)) ** 2 / (matrix**2).sum(axis=(-2, -1))


@pytest.mark.parametrize("seed", range(8))
def test_random_domains_are_valid_and_no_worse_than_winslows(seed: int) -> None:
    faces = random_domain(seed, 17)
    try:
        solution = variational(faces)
    except InputError as error:
        assert "fold" in str(error)  # noqa: PT017
        return
    own, other = measure(solution.grid), measure(winslow(faces).grid)
    assert own.folded == 0
    assert own["scaled_jacobian"].min >= min(other["scaled_jacobian"].min, 0.5)
    assert own["max_angle"].mean <= other["max_angle"].mean


def test_a_coarse_optimum_is_evaluated_at_any_counts_and_clustering() -> None:
    laws = [np.linspace(0, 1, n) for n in (49, 45)], np.linspace(0, 1, 43) ** 4
    a, b, c = np.meshgrid(*laws[0], laws[1], indexing="ij")
    faces = SixFaces.of_block(np.stack(bump(a, b, c), axis=-1))
    solution = variational(faces)
    assert solution.outcome is Outcome.DONE
    assert count_folded(solution.grid.nodes) == 0
    np.testing.assert_array_equal(solution.grid.nodes[0], faces.west)


def test_unavoidable_folds_are_refused_with_the_node() -> None:
    nodes = mapped(skewed, (9, 9, 9))
    nodes[4, 0, 1, 2] -= 0.4  # below the bottom's edge
    with pytest.raises(InputError, match=r"x=.*south and bottom fold the cells.*i=4, j=0, k=0"):
        variational(SixFaces.of_block(nodes))


def test_faces_that_leave_no_place_for_a_node_are_refused() -> None:
    nodes = mapped(lambda a, b, c: (a, b, c), (9, 9, 9))
    nodes[4, 4, 0] = nodes[4, 4, 0] + (0.2, 0.25, 0.0)  # beyond its neighbours
    with pytest.raises(InputError, match=r"wherever node i=.*, k=1 is"):
        variational(SixFaces.of_block(nodes))


@pytest.mark.parametrize("seed", range(6))
def test_places_next_to_faces_are_those_of_the_reference(seed: int) -> None:
    nodes = mapped(skewed, (7, 8, 9))
    nodes += np.random.default_rng(seed).normal(scale=0.02, size=nodes.shape)
    faces = SixFaces.of_block(nodes)
    places = [closed_place(faces)]
    for threads in (1, 3):
        with limited_to(threads):
            places.append(closed_place(faces))
    assert places == [near_faces_reference.closed_place(faces)] * 3


@pytest.mark.parametrize("solve", SOLVERS)
def test_left_handed_volumes_are_refused(solve) -> None:
    with pytest.raises(InputError, match="left-handed"):
        solve(SixFaces.of_block(mapped(skewed, (5, 5, 5))[::-1]))


@pytest.mark.parametrize(
    ("settings", "name"),
    [({"max_cycles": 0}, "max_cycles"), ({"coarse": 2}, "coarse"), ({"energy": "cube"}, "energy")],
)
def test_settings_are_checked(settings, name) -> None:
    with pytest.raises(InputError) as caught:
        variational(SixFaces.of_block(mapped(skewed, (5, 5, 5))), **settings)
    assert caught.value.parameter == name
    with pytest.raises(InputError, match="blending"):
        tfi(SixFaces.of_block(mapped(skewed, (5, 5, 5))), blending="cubic")


def test_first_cells_are_as_high_as_the_faces_say() -> None:
    law = np.append(0.0, np.cumsum(1.3 ** np.arange(40)))
    a, b, c = np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 25), law / law[-1], indexing="ij")
    hill = 0.4 * np.exp(-((a - 0.5) ** 2 + (b - 0.5) ** 2) / 0.05) * (16 * a * (1 - a) * b * (1 - b))
    faces = SixFaces.of_block(np.stack([a, b, c + hill * (1 - c)], axis=-1))
    nodes = variational(faces).grid.nodes
    heights = np.linalg.norm(nodes[:, :, 1] - nodes[:, :, 0], axis=-1)
    np.testing.assert_allclose(heights, law[1] / law[-1], rtol=1e-6)
    growth = np.diff(nodes[10, 12, :, 2])
    assert (growth[1:20] / growth[:19]).max() < 1.35  # the law's 1.3, changed over a dozen cells
    assert count_folded(nodes) == 0
