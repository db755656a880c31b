"""Grids as layers: members without a grid are named or NaN, and sides of no batch are refused."""

import subprocess
import sys
from typing import Any

import pytest

from meshonet.geometry.errors import InputError, SolverError

torch = pytest.importorskip("torch")
from layer_inputs import AROUND, LIFTED, QUADS, domains, inputs, sides_of  # noqa: E402 - it imports torch

from meshonet import layer  # noqa: E402


def test_bodies_without_a_map_are_named() -> None:
    _, (south, north) = inputs(layer.conformal, 4)
    south[1], south[3] = 0.0, south[3] * torch.tensor([1.0, 0.0])
    with pytest.raises(SolverError, match=r"members 1, 3 of the batch: the body is a point") as caught:
        layer.conformal(south, north, 6)
    assert caught.value.members == (1, 3)


SOLVED = (*QUADS[1:3], *LIFTED, layer.conformal)


@pytest.mark.parametrize("function", SOLVED)
def test_members_without_a_grid_leave_the_others_as_they_are(function: Any) -> None:
    _, sides = inputs(function, 4)
    more = (6,) if function is layer.conformal else ()
    broken = [side.clone() for side in sides]
    broken[0][1, 4, 1] = torch.nan
    for side in broken:
        side[2] = 0.0
    result = function(*(side.requires_grad_() for side in broken), *more, failed="nan")
    assert result.isfinite().all((1, 2, 3)).tolist() == [True, False, False, True]
    few = [side[[0, 3]].requires_grad_() for side in sides]
    alone = function(*few, *more)
    torch.testing.assert_close(result[[0, 3]], alone, rtol=0, atol=1e-11)
    result.square().sum().backward()
    alone.square().sum().backward()
    for side, own in zip(broken, few, strict=True):
        torch.testing.assert_close(side.grad[[0, 3]], own.grad, rtol=1e-9, atol=1e-9)
        assert not side.grad[1:3].any()


def test_a_batch_of_failures_alone_is_nan() -> None:
    sides = [(0.0 * side).requires_grad_() for side in sides_of(domains(9, 8, 3))]
    nodes = layer.winslow(*sides, failed="nan")
    assert nodes.shape[1:] == (9, 8, 2)
    assert nodes.isnan().all()
    nodes.sum().backward()
    assert not sides[0].grad.any()


def test_an_unknown_word_for_failures_is_refused() -> None:
    with pytest.raises(InputError, match=r"""failed='skip'; use "raise" or "nan\""""):
        layer.winslow(*sides_of(domains(9, 8, 2)), failed="skip")  # type: ignore[arg-type]


@pytest.mark.parametrize("function", QUADS[1:] + AROUND)
def test_a_member_that_is_not_finite_is_named(function: Any) -> None:
    nodes, sides = inputs(function, 2)
    sides[0][1, 4, 1] = torch.nan
    with pytest.raises(SolverError, match=r"member 1 of the batch: a coordinate is not finite"):
        nodes(*sides)


@pytest.mark.parametrize("function", QUADS[1:3])
def test_a_member_without_a_solution_is_named(function: Any) -> None:
    sides = sides_of(domains(9, 8, 5))
    for side in sides:
        side[1] = 0.0
    with pytest.raises(SolverError, match=r"member 1 of the batch"):
        function(*sides)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda s: s[0].__getitem__((slice(None), slice(None, -1))), "opposite sides need equal counts"),
        (lambda s: s[0].float(), "of one type on one device"),
        (lambda s: s[0].long(), r"south is torch\.int64; give floating-point numbers"),
        (lambda s: s[0][..., :1], "n at least 3"),
        (lambda s: s[0][:2], "different batches"),
    ],
)
def test_sides_that_bound_no_batch_are_refused(change: Any, said: str) -> None:
    sides = sides_of(domains(9, 8, 6))
    with pytest.raises(InputError, match=said):
        layer.winslow(change(sides), *sides[1:])


def test_arrays_that_are_no_tensors_are_refused() -> None:
    sides = sides_of(domains(9, 8, 2))
    with pytest.raises(InputError, match=r"south is a ndarray; give tensors of torch"):
        layer.winslow(sides[0].numpy(), *sides[1:])


@pytest.mark.parametrize("function", QUADS)
def test_sides_without_common_corners_are_refused_with_the_member(function: Any) -> None:
    sides = sides_of(domains(9, 9, 3))
    sides[3][2, -1, 0] += 0.1
    with pytest.raises(InputError, match=r"north and east of member 2 end 0\.1 apart"):
        function(*sides)


def test_without_torch_its_installation_is_said() -> None:
    words = "import sys; sys.modules['torch'] = None; from meshonet import layer"
    done = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True)
    assert "ModuleNotFoundError: meshonet.layer needs torch; install" in done.stderr


def test_variational_grids_whose_systems_are_too_large_are_refused() -> None:
    sides = sides_of(domains(601, 601, 1))
    with pytest.raises(InputError, match=r"the optimum of 601 x 601 nodes needs factors of 56 GB"):
        layer.variational(*sides)
