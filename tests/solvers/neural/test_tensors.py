"""Tensors that no operator can take are refused with the side and the remedy."""

import pytest

torch = pytest.importorskip("torch")

from meshonet.geometry.errors import InputError  # noqa: E402
from meshonet.solvers.neural.differentiable import AirfoilGrids, QuadGrids  # noqa: E402


def sides(*counts: int, dtype: torch.dtype = torch.float64) -> list[torch.Tensor]:
    return [torch.zeros(1, n, 2, dtype=dtype) for n in counts]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (sides(9, 9, 5, 4), "west has 5 nodes and east 4; opposite sides need equal counts"),
        (sides(9, 9, 5, 1), r"east has shape \(1, 1, 2\); give \(..., n, 2\) with n at least 2"),
        ([side[0, :, 0] for side in sides(9, 9, 5, 5)], r"south has shape \(9,\); give"),
        ([*sides(9, dtype=torch.float32), *sides(9, 5, 5)], "of one type on one device"),
        ([torch.cat(2 * sides(9)), torch.cat(3 * sides(9)), *sides(5, 5)], "of different batches"),
    ],
)
def test_four_sides_are_looked_at(given: list[torch.Tensor], message: str) -> None:
    with pytest.raises(InputError, match=message):
        QuadGrids()(*given)


@pytest.mark.parametrize(
    ("given", "nj", "message"),
    [
        (sides(9, 8), 5, "south has 9 nodes and north 8; opposite"),
        (sides(3, 3), 5, "with n at least 4"),
        ([*sides(9, dtype=torch.float32), *sides(9)], 5, "of one type on one device"),
        (sides(9, 9), 1, "nj is 1 nodes; use at least 2"),
    ],
)
def test_bodies_are_looked_at(given: list[torch.Tensor], nj: int, message: str) -> None:
    with pytest.raises(InputError, match=message):
        AirfoilGrids("base")(*given, nj)


def test_a_model_for_bodies_is_no_model_for_four_sides() -> None:
    with pytest.raises(InputError, match="model hole-o makes o grids; use one of four-sided domains"):
        QuadGrids("hole-o")
