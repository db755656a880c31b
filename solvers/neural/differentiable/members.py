"""Members of a batch: which ones failed, and batches of batches as one."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal

import torch
from torch import Tensor

from meshonet.geometry.errors import InputError, SolverError

Failed = Literal["raise", "nan"]
"""What members without a grid cause: an error, or nodes that are not numbers, without gradients."""


class MemberError(SolverError):
    """Error: some members of a batch have no grid.

    `reasons` maps the index of each of these members to two texts: the problem and its remedy.
    """

    members: tuple[int, ...]  # the indices

    def __init__(self, reasons: Mapping[int, tuple[str, str]]) -> None:
        self.members, self.reasons = tuple(sorted(reasons)), dict(reasons)
        which = f"member {self.members[0]}"
        if len(self.members) > 1:
            which = f"members {', '.join(map(str, self.members[:5]))}"
        if len(self.members) > 5:
            which += f" and {len(self.members) - 5} more"
        problem, remedy = reasons[self.members[0]]
        super().__init__(f"{which} of the batch: {problem}; {remedy}")

    @classmethod
    def of(cls, members: Iterable[int], problem: str, remedy: str) -> "MemberError":
        """Return the error for several `members` that have the same `problem`."""
        return cls(dict.fromkeys(members, (problem, remedy)))


def check_finite(*parts: Tensor) -> None:
    """Raise MemberError for batch members with a number that is not finite in one of `parts` (batch, ...)."""
    finite = [torch.isfinite(part).flatten(1).all(1) for part in parts]
    bad = (~torch.stack(finite).all(0)).nonzero().flatten()
    if len(bad):
        raise MemberError.of(bad.tolist(), "a coordinate is not finite", "leave it out")


def check_failed(failed: str) -> None:
    """Raise InputError unless `failed` is "raise" or "nan"."""
    if failed not in ("raise", "nan"):
        raise InputError(f"failed={failed!r}", 'use "raise" or "nan"')


def without_failed(make: Callable[..., Tensor], counts: tuple[int, int], *sides: Tensor) -> Tensor:
    """Return nodes (batch, *counts, 2) that `make` makes for `sides`; NaN for members with a MemberError."""
    left = torch.arange(len(sides[0]), device=sides[0].device)
    none = sides[0].new_full((len(left), *counts, 2), torch.nan)
    while len(left):
        try:
            return none.index_copy(0, left, make(*(side[left] for side in sides)))
        except MemberError as error:
            good = torch.ones_like(left, dtype=torch.bool)
            good[list(error.members)] = False
            left = left[good]
    return none


def in_parts(function: Callable[..., tuple[Tensor, ...]], most: int, *tensors: Tensor) -> tuple[Tensor, ...]:
    """Return the values of `function` for a batch; it is called for at most `most` members at a time.

    Raises MemberError with all members for which `function` failed.
    """
    parts: list[tuple[Tensor, ...]] = []
    reasons: dict[int, tuple[str, str]] = {}
    for first in range(0, len(tensors[0]), max(most, 1)):
        some = slice(first, first + max(most, 1))
        try:
            parts.append(function(*(tensor[some] for tensor in tensors)))
        except MemberError as error:
            reasons |= {first + k: reason for k, reason in error.reasons.items()}
    if reasons:
        raise MemberError(reasons)
    return tuple(torch.cat(values) for values in zip(*parts, strict=True))


class BatchFunction(torch.autograd.Function):
    """Base class of torch functions of a batch; `torch.vmap` evaluates several batches as one batch."""

    @classmethod
    def vmap(cls, info: Any, in_dims: Any, *inputs: Any) -> Any:
        """Return the values for all mapped batches, and their mapped axes (see `torch.autograd.Function`)."""
        flat, count = [], info.batch_size
        for value, dim in zip(inputs, in_dims, strict=True):
            if isinstance(value, Tensor):
                moved = value.expand(count, *value.shape) if dim is None else value.movedim(dim, 0)
                value = moved.flatten(0, 1)
            flat.append(value)
        values = cls.apply(*flat)  # type: ignore[no-untyped-call]
        if isinstance(values, Tensor):
            return values.unflatten(0, (count, -1)), 0
        return tuple(value.unflatten(0, (count, -1)) for value in values), (0,) * len(values)


class FirstDerivative(BatchFunction):
    """Base class of derivatives that cannot be differentiated again."""

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Any) -> None:
        """Keep nothing for `backward`."""

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> None:
        """Raise NotImplementedError, because there are no second derivatives."""
        raise NotImplementedError("these grids have no second derivatives")
