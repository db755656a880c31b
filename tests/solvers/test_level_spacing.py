"""Steps of a march: their sum, and where they grow less because lines at a sharp edge spread."""

import numpy as np
import pytest

from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.growth import growing_steps
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.hyperbolic.level_spacing import Edge, level_steps, sharpest_edge
from meshonet.solvers.hyperbolic.march import hyperbolic


def ratios(steps: np.ndarray) -> np.ndarray:
    return np.log(steps[1:] / steps[:-1])


@pytest.mark.parametrize("edge", [None, Edge(1e-3, 1.0), Edge(1e-6, 0.3), Edge(100.0, 1.0)])
@pytest.mark.parametrize(("cells", "constant"), [(1, 1), (2, 1), (99, 1), (80, 5), (7, 7)])
def test_steps_begin_with_the_first_and_add_up(edge: Edge | None, cells: int, constant: int) -> None:
    distance = 1e-4 * cells if constant == cells else 14.5
    first = distance if cells == 1 else 1e-4 if constant == cells else 0.7 ** min(cells, 30)
    if cells == 2:
        first = 4.0
    steps = level_steps(first, distance, cells, constant, edge)
    assert steps[0] == first
    assert steps.sum() == pytest.approx(distance, rel=1e-12)
    np.testing.assert_allclose(steps[:constant], first, rtol=1e-14)
    assert (np.diff(steps) >= -1e-15).all()


def test_without_an_edge_they_grow_by_one_ratio_and_with_one_less_at_its_cells() -> None:
    plain = level_steps(1e-5, 15.0, 99, 1, None)
    np.testing.assert_array_equal(plain, growing_steps(1e-5, 15.0, 99))
    for size in (1e-3, 1e-2):
        result = ratios(level_steps(1e-5, 15.0, 99, 1, Edge(size, 1.0)))
        height = np.cumsum(level_steps(1e-5, 15.0, 99, 1, Edge(size, 1.0)))
        assert 1.5 * size < height[np.argmin(result)] < 8 * size
        assert 0.7 * result.max() < result.min() < 0.85 * result.max()
        assert result.max() < 1.09 * ratios(plain).max()
    weak = ratios(level_steps(1e-5, 15.0, 99, 1, Edge(1e-3, 0.1)))
    assert weak.min() > 0.97 * weak.max()


def test_the_sharpest_corner_is_found_with_its_cells() -> None:
    t = -np.linspace(0.0, 2 * np.pi, 41)[:-1]
    assert sharpest_edge(np.stack([np.cos(t), np.sin(t)], axis=1)) is None
    wedge = np.array([[1.0, 0.0], [0.7, -0.05], [0.0, -0.1], [-0.3, 0.0], [0.0, 0.1], [0.9, 0.02]])
    result = sharpest_edge(wedge)
    assert result is not None
    assert result.size == pytest.approx(0.5 * (np.hypot(0.3, 0.05) + np.hypot(0.1, 0.02)))
    between = np.arctan(0.05 / 0.3) + np.arctan(0.02 / 0.1)
    assert result.sharpness == pytest.approx(1.0 - np.sin(0.5 * between))
    assert sharpest_edge(wedge[::-1]) is None  # the other way round every corner is a hollow


@pytest.mark.parametrize("section", ["0009", "2415", "4418"])
def test_cells_around_a_sharp_edge_grow_alike_along_all_lines(section: str) -> None:
    sampling = Sampling(250, 100, "o", "curvature", te="wedge", viscous=True)
    nodes = hyperbolic(naca(section).boundary(sampling), wall_spacing=1e-5).grid.nodes
    away = np.hypot(*np.moveaxis(np.diff(nodes, axis=1), -1, 0))
    along = np.hypot(*np.moveaxis(np.diff(nodes, axis=0), -1, 0))
    along = np.vstack([along[-1:], along])
    assert (away[:, 1:] / away[:, :-1]).max() < 1.147
    assert np.exp(np.abs(np.diff(np.log(along), axis=0))).max() < 1.26
