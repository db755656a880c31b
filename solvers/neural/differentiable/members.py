"""Members of a batch: which one failed, and batches of batches as one."""

from collections.abc import Callable
from typing import Any

from torch import Tensor, isfinite

from meshonet.geometry.errors import SolverError


class MemberError(SolverError):
    """No grid for one member of a batch.

    Parameters
    ----------
    member : int
        Index of the member in the batch, from 0.
    problem, remedy : str
        What is wrong with the member, and what a user can do.
    """

    def __init__(self, member: int, problem: str, remedy: str) -> None:
        super().__init__(f"member {member} of the batch: {problem}; {remedy}")
        self._parts = member, problem, remedy

    def later(self, count: int) -> "MemberError":
        """Return the same error for a batch that has `count` further members before this batch."""
        member, problem, remedy = self._parts
        return MemberError(member + count, problem, remedy)


def check_finite(nodes: Tensor) -> None:
    """Raise MemberError for the first member of `nodes` (batch, ...) with a number that is not finite."""
    bad = (~isfinite(nodes).flatten(1).all(1)).nonzero().flatten()
    if len(bad):
        raise MemberError(int(bad[0]), "a coordinate is not finite", "leave it out")


def as_one_batch(function: Callable[..., Any], count: int, in_dims: Any, *inputs: Any) -> tuple[Any, Any]:
    """Return the values of `function` for `count` batches, computed as one batch, and their batch dimension.

    `inputs` that are no tensors are the same for all batches.
    """
    flat = []
    for value, dim in zip(inputs, in_dims, strict=True):
        if isinstance(value, Tensor):
            moved = value.expand(count, *value.shape) if dim is None else value.movedim(dim, 0)
            flat.append(moved.flatten(0, 1))
        else:
            flat.append(value)
    values = function(*flat)
    if isinstance(values, Tensor):
        return values.unflatten(0, (count, -1)), 0
    return tuple(value.unflatten(0, (count, -1)) for value in values), (0,) * len(values)
