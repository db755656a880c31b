"""Linear algebra of small matrices against that of NumPy, and where matrices are degenerate."""

import numpy as np
import pytest

from meshonet.geometry.linear import (
    inverse,
    least_squares,
    nearest_rotation,
    singular_values,
    solve,
    symmetric_eigen,
)


def random(*shape):
    return np.random.default_rng(sum(shape)).normal(size=shape)


def turned(vectors, values):
    """Return symmetric matrices of given eigenvalues, in the frames of the orthogonal parts of `vectors`."""
    q = np.linalg.qr(vectors)[0]
    return (q * np.asarray(values)[..., None, :]) @ np.swapaxes(q, -2, -1)


@pytest.mark.parametrize("size", [1, 2, 3, 7, 60])
def test_a_system_is_solved_for_a_vector_and_for_columns(size):
    matrix = random(size, size) + 2.0 * np.eye(size)
    for right in (random(size), random(size, 3)):
        np.testing.assert_allclose(
            solve(matrix, right), np.linalg.solve(matrix, right), rtol=1e-11, atol=1e-13
        )


def test_a_stack_of_systems_is_solved_one_by_one():
    matrix, right, vectors = random(5, 2, 3, 3), random(5, 2, 3, 4), random(5, 2, 3)
    np.testing.assert_allclose(solve(matrix, right), np.linalg.solve(matrix, right), rtol=1e-12)
    np.testing.assert_allclose(
        solve(matrix, vectors), np.linalg.solve(matrix, vectors[..., None])[..., 0], rtol=1e-12
    )
    assert np.array_equal(solve(matrix, right)[3, 1], solve(matrix[3, 1], right[3, 1]))
    assert solve(matrix[:0], right[:0]).shape == (0, 2, 3, 4)


def test_rows_are_exchanged_where_a_pivot_is_0_or_tiny():
    assert np.array_equal(solve([[0.0, 2.0], [4.0, 0.0]], [6.0, 8.0]), [2.0, 3.0])
    np.testing.assert_allclose(solve([[1e-20, 1.0], [1.0, 1.0]], [1.0, 2.0]), [1.0, 1.0], rtol=1e-15)


def test_given_arrays_stay_as_they_are():
    matrix, right = random(3, 3), random(3)
    before = matrix.copy(), right.copy()
    (
        solve(matrix, right),
        symmetric_eigen(matrix + matrix.T),
        singular_values(matrix),
        nearest_rotation(matrix),
    )
    assert np.array_equal(matrix, before[0])
    assert np.array_equal(right, before[1])


def test_a_singular_matrix_is_refused():
    with pytest.raises(ValueError, match="singular"):
        solve([[1.0, 2.0], [2.0, 4.0]], [1.0, 1.0])
    with pytest.raises(ValueError, match="singular"):
        inverse(np.stack([np.eye(2), np.zeros((2, 2))]))


def test_an_inverse_times_its_matrix_is_1():
    matrix = random(4, 3, 3)
    np.testing.assert_allclose(inverse(matrix), np.linalg.inv(matrix), rtol=1e-12)
    assert np.array_equal(inverse(np.eye(3)), np.eye(3))


@pytest.mark.parametrize(
    "values", [[1, 2, 3], [-3, 0, 1e-9], [1, 1, 5], [2, 2, 2], [0, 0, 0], [1e-200, 0, 1e200]]
)
def test_eigenvectors_are_orthonormal_and_the_values_rise(values):
    matrix = turned(random(3, 3), np.array(values, float))
    w, v = symmetric_eigen(matrix)
    size = max(np.abs(values).max(), 1e-300)
    np.testing.assert_allclose(w, sorted(values), atol=1e-14 * size)
    np.testing.assert_allclose(v.T @ v, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(v @ np.diag(w / size) @ v.T, matrix / size, atol=1e-14)


@pytest.mark.parametrize("size", [1, 2, 4, 20])
def test_eigenvalues_are_numpy_s(size):
    matrix = random(size, size)
    matrix = matrix + matrix.T
    w, v = symmetric_eigen(matrix)
    np.testing.assert_allclose(w, np.linalg.eigvalsh(matrix), atol=1e-13 * np.abs(w).max())
    np.testing.assert_allclose(matrix @ v, v * w, atol=1e-13 * np.abs(w).max())


def test_a_matrix_in_a_stack_has_the_eigenvectors_that_it_has_alone():
    matrix = random(2, 5, 3, 3)
    matrix = matrix + np.swapaxes(matrix, -2, -1)
    matrix[0, 1] = np.diag([3.0, 1.0, 2.0])
    w, v = symmetric_eigen(matrix)
    for at in np.ndindex(2, 5):
        alone = symmetric_eigen(matrix[at])
        assert np.array_equal(alone[0], w[at])
        assert np.array_equal(alone[1], v[at])
    assert np.array_equal(v[0, 1], np.eye(3)[:, [1, 2, 0]])


@pytest.mark.parametrize("shape", [(3, 3), (50, 2), (7, 4), (2, 3), (1, 1)])
def test_singular_values_are_numpy_s_and_make_the_matrix_again(shape):
    matrix = random(*shape)
    u, s, v = singular_values(matrix)
    expected = np.linalg.svd(matrix, compute_uv=False)
    np.testing.assert_allclose(s[: len(expected)], expected, rtol=1e-13)
    assert (s[len(expected) :] <= 1e-14 * s[0]).all()
    np.testing.assert_allclose(u * s @ v, matrix, atol=1e-14 * s[0])
    np.testing.assert_allclose(v @ v.T, np.eye(shape[1]), atol=1e-14)


def test_points_on_a_line_and_at_one_place_have_singular_values_of_0():
    line = np.arange(5.0)[:, None] * np.array([1.0, 2.0, 2.0])
    u, s, v = singular_values(line)
    np.testing.assert_allclose(s, [3.0 * np.sqrt(30.0), 0.0, 0.0], atol=1e-14)
    np.testing.assert_allclose(np.abs(v[0]), [1 / 3, 2 / 3, 2 / 3], rtol=1e-14)
    np.testing.assert_allclose(line @ v[1:].T, 0.0, atol=1e-13)
    u, s, v = singular_values(np.zeros((4, 2)))
    assert not s.any()
    assert not u.any()
    assert np.array_equal(v, np.eye(2))


@pytest.mark.parametrize("columns", [(), (2,)])
def test_a_least_squares_fit_is_numpy_s(columns):
    matrix, right = random(30, 3), random(30, *columns)
    np.testing.assert_allclose(
        least_squares(matrix, right), np.linalg.lstsq(matrix, right, rcond=None)[0], rtol=1e-12
    )


@pytest.mark.parametrize(
    "rows", [[[0, 0, 1], [1, 1, 1], [2, 2, 1]], [[1, 2, 1]], [[3, 3, 1], [3, 3, 1]], [[0, 0, 0]]]
)
def test_a_fit_that_is_not_determined_is_the_least_one(rows):
    matrix = np.array(rows, float)
    right = random(len(rows), 2)
    np.testing.assert_allclose(
        least_squares(matrix, right), np.linalg.lstsq(matrix, right, rcond=None)[0], atol=1e-14
    )


def best_rotation(matrix):
    """Return the rotation of the most trace with a map, by the singular values of NumPy."""
    u, _, v = np.linalg.svd(matrix)
    u[:, -1] *= np.linalg.det(u @ v)
    return u @ v


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_nearest_rotation_is_that_of_singular_values(dimension):
    maps = random(40, dimension, dimension)
    assert (np.linalg.det(maps) < 0).any()
    rotations = nearest_rotation(maps)
    for each, rotation in zip(maps, rotations, strict=True):
        np.testing.assert_allclose(rotation, best_rotation(each), atol=1e-13)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_rotation_is_nearest_to_itself(dimension):
    rotation = nearest_rotation(random(9, dimension, dimension))
    np.testing.assert_allclose(nearest_rotation(7.0 * rotation), rotation, atol=1e-15)
    assert np.array_equal(nearest_rotation(np.eye(dimension)), np.eye(dimension))


@pytest.mark.parametrize("values", [[1, 1, 0], [1, 0, 0], [0, 0, 0], [1, 1, -1], [-1, -1, -1], [-1, -1, 1]])
def test_flat_and_mirrored_maps_have_a_rotation_as_near_as_any(values):
    for frame in (np.eye(3), np.linalg.qr(random(3, 3))[0]):
        matrix = frame * np.array(values, float) @ frame.T
        rotation = nearest_rotation(matrix)
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-14)
        assert np.linalg.det(rotation) == pytest.approx(1.0)
        assert np.trace(rotation.T @ matrix) == pytest.approx(
            np.trace(best_rotation(matrix).T @ matrix), abs=1e-13
        )


def test_a_plane_map_without_rotation_is_not_turned():
    assert np.array_equal(nearest_rotation(np.diag([1.0, -1.0])), np.eye(2))
