"""A device that is not there: tensors that say they are on it, compute here and refuse to mix with others."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from torch.overrides import TorchFunctionMode
from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils._pytree import tree_leaves, tree_map

DEVICE = "meta"
"""A name that torch knows everywhere; its own tensors have no values, these have."""

PHYSICAL = {
    torch.ops.aten._conj.default: torch.ops.aten._conj_physical.default,
    torch.ops.aten._neg_view.default: torch.ops.aten.neg.default,
}
"""Views that dispatch below the one here would lose."""


class There(torch.Tensor):
    """A tensor on the device: `held` has its values."""

    held: torch.Tensor

    @staticmethod
    def __new__(cls, held: torch.Tensor) -> There:
        """Wrap `held`."""
        made = torch.Tensor._make_wrapper_subclass(  # type: ignore[attr-defined]
            cls, held.shape, strides=held.stride(), storage_offset=held.storage_offset(), dtype=held.dtype,
            device=DEVICE,
        )  # fmt: skip
        made.held = held
        return made

    @classmethod
    def __torch_dispatch__(cls, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        """Compute `func` here, on tensors of one device."""
        kwargs = dict(kwargs or {})
        given = tree_leaves((args, kwargs))
        there = any(isinstance(one, There) for one in given)
        place = kwargs.get("device")
        if place is not None:
            there, kwargs["device"] = torch.device(place).type == DEVICE, "cpu"
        elif "index" not in func.name() and there:
            mixed = [one for one in given if type(one) is torch.Tensor and one.ndim]
            if mixed:
                raise RuntimeError(
                    f"{func.name()}: tensors of shapes {[m.shape for m in mixed]} are not there"
                )
        args, kwargs = tree_map(lambda one: one.held if isinstance(one, There) else one, (args, kwargs))
        if func in PHYSICAL:
            func, args = PHYSICAL[func], (torch.as_tensor(args[0]),)  # from a number, in slopes
        result = func(*args, **kwargs)
        return tree_map(lambda one: There(one) if there and isinstance(one, torch.Tensor) else one, result)


class _Made(TorchDispatchMode):
    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        return There.__torch_dispatch__(func, types, args, kwargs)


class Pretended(TorchFunctionMode):
    """While entered, `DEVICE` is such a device."""

    def __enter__(self) -> Any:
        """Enter."""
        self._below = _Made()
        self._below.__enter__()
        return super().__enter__()

    def __exit__(self, *message: Any) -> None:
        """Leave."""
        super().__exit__(*message)
        self._below.__exit__(*message)

    def __torch_function__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        """Make tensors from values here, then take them there."""
        kwargs = dict(kwargs or {})
        if func in (torch.tensor, torch.as_tensor, torch.asarray) and kwargs.get("device") is not None:
            place = kwargs.pop("device")
            if torch.device(place).type == DEVICE and not isinstance(args[0], There):
                return func(*args, **kwargs).to(place)
        if func is torch.Tensor.__getitem__:
            args = args[0], tree_map(_placed, args[1], is_leaf=_listed)
        return func(*args, **kwargs)


def _listed(index: Any) -> bool:
    return isinstance(index, list | np.ndarray)


def _placed(index: Any) -> Any:
    """Return lists and arrays of indices as tensors here, which torch takes on any device."""
    return torch.tensor(index) if _listed(index) else index
