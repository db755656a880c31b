"""Inference for many boundaries by torch on a CPU or GPU, without repair of folded cells."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.neural.operator import Operator, in_batches
from meshonet.solvers.neural.strip.operator import StripOperator
from meshonet.solvers.solution import Solution

if TYPE_CHECKING:
    from torch import Tensor

Device = Literal["cpu", "cuda"]

INSTALL_TORCH = (
    "install it: pip install 'meshonet[train]'; without a GPU install PyTorch's CPU wheel first, "
    "which is a tenth as large"
)
STEPS = 3  # Picard steps of "auto" after the strip network


def solve_on(
    device: Device,
    operator: Operator,
    boundaries: Sequence[Boundary],
    polish: Polish,
    instead: Callable[[Boundary], Solution],
) -> list[Solution]:
    """Return a grid inside each boundary, computed by torch on `device`.

    Boundaries with equal node counts are computed in one batch. `polish` selects improving steps after the
    network: ``auto``, ``off`` or, for airfoil operators, a number of Picard steps. `instead` makes the grids
    that cannot be computed on the device. Raises InputError if torch or the device is missing, or if
    arguments do not suit the operator. Raises MemoryError if the device has too little memory.
    """
    if not operator.batched:
        raise InputError(f"model {operator.name} has no grids on a device", "leave {device} out")
    try:
        import torch
    except ImportError:
        raise InputError("{device} needs torch", INSTALL_TORCH) from None
    if device == "cuda" and not torch.cuda.is_available():
        remedy = "use {device} cpu, or leave it out"
        raise InputError("torch sees no CUDA device", remedy, parameter="device")
    operator.check(boundaries)
    grids = _grids(device, operator, polish)
    cycles = _steps(polish) if isinstance(operator, StripOperator) else None
    solutions: dict[int, Solution] = {}
    for rows in in_batches(boundaries):
        some = [boundaries[k] for k in rows]
        begun = time.perf_counter()
        try:
            nodes = grids(some).cpu().numpy()
        except torch.OutOfMemoryError as error:
            raise MemoryError(str(error).split("\n")[0]) from error
        spent = (time.perf_counter() - begun) / len(rows)
        for k, boundary, own in zip(rows, some, nodes, strict=True):
            if not np.isfinite(own).all():
                solution = instead(boundary)
                solutions[k] = replace(solution, notes=("not made on the device", *solution.notes))
                continue
            grid = boundary.grid(own, {"method": "operator", "model": operator.name, "device": device})
            solutions[k] = Solution(
                grid, "operator", model=operator.name, cycles=cycles, seconds={"grid": spent}
            )
    return [solutions[k] for k in range(len(boundaries))]


def _grids(device: Device, operator: Operator, polish: Polish) -> Callable[[Sequence[Boundary]], Tensor]:
    import torch

    from meshonet.solvers.neural.differentiable import AirfoilGrids, BodyGrids, QuadGrids

    grids: Any
    quad = operator.topology == "quad"
    if isinstance(operator, StripOperator):
        grids = partial(AirfoilGrids(operator, _steps(polish), device), failed="nan")
    elif polish not in ("auto", "off", 0):
        raise InputError("steps of descent are not taken on a device", "leave {polish} or {device} out")
    else:
        grids = (QuadGrids if quad else BodyGrids)(operator, device)

    def stacked(boundaries: Sequence[Boundary]) -> Tensor:
        names = ("south", "north", "west", "east")[: 4 if quad else 2]
        arrays = [np.stack([getattr(b, side) for b in boundaries]) for side in names]
        more = () if quad else (boundaries[0].nj,)
        with torch.no_grad():
            nodes: Tensor = grids(*(torch.tensor(array, device=device) for array in arrays), *more)
        return nodes

    return stacked


def _steps(polish: Polish) -> int:
    return STEPS if polish == "auto" else 0 if polish == "off" else polish
