"""The quad network's symmetries: a relabelled domain has the relabelled features, frame and kernels."""

import numpy as np
import pytest
from relabelling import relabelled

from meshonet.geometry.arrays import Complexes
from meshonet.solvers.neural.quad import symmetry
from meshonet.solvers.neural.quad.encoding import FEATURES, features, frame
from meshonet.solvers.neural.quad.symmetry import ELEMENTS, INVERSE, ORDER, PRODUCT, SEEN

ALL = range(ORDER)


def grids(n: int = 9) -> Complexes:
    rng = np.random.default_rng(0)
    t = np.linspace(0, 2, n)
    noise = rng.normal(size=(2, 3, n, n))
    return np.asarray(1.5 * t[:, None] + 1j * t + 0.05 * (noise[0] + 1j * noise[1]) + (3.0 - 2.0j))


def normalised(z: Complexes) -> Complexes:
    middle, factor = frame(z, np)
    return np.asarray((z - middle[:, None, None]) * factor[:, None, None])


def test_the_elements_are_a_group() -> None:
    for a in ALL:
        np.testing.assert_array_equal(ELEMENTS[a] @ ELEMENTS[INVERSE[a]], np.eye(2))
        assert sorted(PRODUCT[a]) == list(ALL)


@pytest.mark.parametrize("element", ALL)
def test_relabelling_by_two_elements_is_relabelling_by_their_product(element: int) -> None:
    z = grids()
    for other in ALL:
        once = relabelled(z, PRODUCT[element, other])
        np.testing.assert_allclose(relabelled(relabelled(z, element), other), once, atol=1e-14)


@pytest.mark.parametrize("element", ALL)
def test_features_of_a_relabelled_grid_are_those_seen_from_the_element(element: int) -> None:
    z, step = normalised(grids()), 0.01 * grids()[::-1]
    n = z.shape[-1]
    places = np.arange(n) - (n - 1) / 2
    at = np.rint(ELEMENTS[element] @ np.stack(np.meshgrid(places, places, indexing="ij")).reshape(2, -1))
    rows = (at + (n - 1) / 2).astype(int)
    moved = features(z, step, np)[:, rows[0], rows[1]].reshape(*z.shape, FEATURES)
    result = features(relabelled(z, element), relabelled(step, element), np)
    np.testing.assert_allclose(result, moved @ SEEN[element].T, atol=1e-12)


@pytest.mark.parametrize("element", ALL)
def test_a_domain_anywhere_of_any_size_has_one_normalised_form(element: int) -> None:
    z = grids()
    plain = normalised(z)
    np.testing.assert_allclose(normalised(2.5 * np.exp(0.7j) * z - 40.0), plain, atol=1e-12)
    np.testing.assert_allclose(normalised(relabelled(z, element)), relabelled(plain, element), atol=1e-12)


def test_the_normalised_outline_has_area_one_about_the_origin() -> None:
    z = normalised(grids())
    for one in z:
        outline = np.concatenate([one[:-1, 0], one[-1, :-1], one[:0:-1, -1], one[0, :0:-1]])
        assert abs(outline.mean()) < 1e-12
        assert 0.5 * (outline.conj() * np.roll(outline, -1)).imag.sum() == pytest.approx(1.0)


@pytest.mark.parametrize("size", [1, 3])
def test_a_kernel_from_one_element_to_another_is_the_weights_moved(size: int) -> None:
    weight = np.random.default_rng(1).normal(size=(2, 3, ORDER, size, size))
    kernel = symmetry.convolution(weight, symmetry.table(size), np).reshape(2, ORDER, 3, ORDER, size, size)
    half = size // 2
    for h in ALL:
        for g in ALL:
            for i in range(size):
                for j in range(size):
                    x, y = ELEMENTS[h].T @ [i - half, j - half]
                    expected = weight[:, :, PRODUCT[INVERSE[h], g], x + half, y + half]
                    np.testing.assert_array_equal(kernel[:, h, :, g, i, j], expected)
