"""Growth is a limit: no two neighbouring cells of a line that leaves a wall differ by more."""

import numpy as np
import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.growth import growth
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.layers.limited import limit_growth
from meshonet.solvers.pipeline.make_grid import make_grid
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.result import Result


def made(name: str, topology: str, limit: float, nj: int | None = None, method: str = "best") -> Result:
    sampling = Sampling(161, nj, topology)  # type: ignore[arg-type]
    return make_grid(naca(name), GridRequest(sampling=sampling, method=method, first_cell=2e-5, growth=limit))


@pytest.mark.parametrize("limit", [1.1, 1.2, 1.4])
@pytest.mark.parametrize(
    ("name", "topology", "method"),
    [("0012", "o", "best"), ("4415", "o", "best"), ("2412-sharp", "c", "best"), ("2412", "o", "winslow")],
)
def test_no_cells_grow_by_more_than_was_asked(name: str, topology: str, method: str, limit: float) -> None:
    grid = made(name, topology, limit, method=method).grid
    eta = growth(grid).eta
    assert eta is not None
    assert eta.max <= limit
    assert eta.mean > 1.0 + 0.5 * (limit - 1.0)  # rows are not more than the limit needs
    heights = np.hypot(
        *(grid.nodes[grid.wake : grid.ni - grid.wake, 1] - grid.nodes[grid.wake : grid.ni - grid.wake, 0]).T
    )
    np.testing.assert_allclose(heights, 2e-5, rtol=1e-8)
    assert count_folded(grid.nodes) == 0


def test_rows_that_cannot_keep_to_it_are_refused_with_a_number_that_can() -> None:
    with pytest.raises(InputError, match=r"far field .* 1[.]2 each; use (\d+) rows or more") as error:
        made("0012", "o", 1.2, nj=40)
    rows = int(str(error.value).split("use ")[1].split()[0])
    assert made("0012", "o", 1.2, nj=rows).grid.nj == rows
    with pytest.raises(InputError, match=rf"use {rows} rows or more"):
        made("0012", "o", 1.2, nj=rows - 1)


def test_lines_keep_their_ends_first_and_last_cells() -> None:
    arcs = np.concatenate([[0.0], np.cumsum([1.0, 1.0, 1.5, 1.6, 3.0, 3.1, 2.0, 2.0])])
    nodes = np.stack([np.stack([np.full(9, float(i)), (1.0 + i) * arcs], axis=-1) for i in range(3)])
    before = nodes.copy()
    assert limit_growth(nodes, 1.4, 2, 1)
    steps = np.diff(nodes[..., 1], axis=1)
    assert (np.maximum(steps[:, 1:], steps[:, :-1]) / np.minimum(steps[:, 1:], steps[:, :-1])).max() <= 1.4
    for kept in (slice(0, 3), slice(-2, None)):
        np.testing.assert_allclose(nodes[:, kept], before[:, kept], rtol=1e-12)
    assert not limit_growth(before, 1.05, 2, 1)
