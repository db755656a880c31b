"""Grids of many boundaries through torch, on a device of its: the networks' own, without guard."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.operator import Polish
from meshonet.solvers.neural.operator import infer as infer_strip
from meshonet.solvers.neural.quads.operator import in_batches
from meshonet.solvers.neural.weights import DEFAULT
from meshonet.solvers.solution import Solution

Device = Literal["cpu", "cuda"]

STEPS = 3
"""Picard steps of "auto" after the network."""


def infer_on(
    device: Device,
    boundaries: Sequence[Boundary],
    model: str | None,
    polish: Polish,
    quads: Topology | None = None,
) -> list[Solution]:
    """Return a grid inside each boundary, those of equal size computed together.

    Bodies that the strip operator cannot lift are solved as `meshonet.solvers.neural.operator.infer` does.

    Parameters
    ----------
    device : ``cpu`` or ``cuda``.
    model : a strip or quad model; None is the shipped strip model.
    polish : Picard steps of the strip operator; ``auto`` or ``off`` for quad models.
    quads : topology of the grids of a quad model; None for a strip model.

    Raises
    ------
    InputError
        torch or the device is not there; boundaries or polish that do not suit the model.
    """
    _check(device)
    if quads and polish not in ("auto", "off", 0):
        raise InputError("steps of descent are not taken on a device", "leave --polish or --device out")
    topology = quads or "o"
    for boundary in boundaries:
        if boundary.topology != topology:
            told = f"model {model or DEFAULT} makes {topology} grids on a device"
            raise InputError(f"{told}, and this boundary is {boundary.topology}", "name another model")
    found: dict[int, Solution] = {}
    for rows in in_batches(boundaries):
        some = [boundaries[k] for k in rows]
        begun = time.perf_counter()
        nodes = _quads(some, str(model), quads, device) if quads else _strips(some, model, polish, device)
        spent = (time.perf_counter() - begun) / len(rows)
        for k, boundary, one in zip(rows, some, nodes, strict=True):
            found[k] = _solution(boundary, one, model or DEFAULT, device, spent)
    return [found[k] for k in range(len(boundaries))]


def _check(device: Device) -> None:
    try:
        import torch
    except ImportError:
        raise InputError("--device needs torch", "install it: pip install 'meshonet[train]'") from None
    if device == "cuda" and not torch.cuda.is_available():
        raise InputError("torch sees no CUDA device", "use --device cpu, or leave it out", source="--device")


def _stacked(boundaries: Sequence[Boundary], sides: Sequence[str], device: Device) -> list[Any]:
    import torch

    arrays = [np.stack([getattr(b, side) for b in boundaries]) for side in sides]
    return [torch.tensor(array, device=device) for array in arrays]


def _quads(
    boundaries: Sequence[Boundary], model: str, topology: Topology, device: Device
) -> list[Floats | None]:
    if topology == "quad":
        from meshonet.solvers.neural.quads.differentiable import QuadGrids

        sides = _stacked(boundaries, ("south", "north", "west", "east"), device)
        return list(QuadGrids(model, device)(*sides).cpu().numpy())
    from meshonet.solvers.neural.quads.differentiable_around import BodyGrids

    south, north = _stacked(boundaries, ("south", "north"), device)
    return list(BodyGrids(model, device)(south, north, boundaries[0].nj).cpu().numpy())


def _strips(
    boundaries: Sequence[Boundary], model: str | None, polish: Polish, device: Device
) -> list[Floats | None]:
    import torch

    from meshonet.solvers.neural.differentiable import AirfoilGrids

    steps = STEPS if polish == "auto" else 0 if polish == "off" else polish
    grids = AirfoilGrids(model or DEFAULT, steps, device)
    with torch.no_grad():
        try:
            south, north = _stacked(boundaries, ("south", "north"), device)
            return list(grids(south, north, boundaries[0].nj).cpu().numpy())
        except InputError:
            if len(boundaries) == 1:
                return [None]
    return [_strips([one], model, polish, device)[0] for one in boundaries]


def _solution(boundary: Boundary, nodes: Floats | None, model: str, device: Device, spent: float) -> Solution:
    if nodes is None or not np.isfinite(nodes).all():
        found = infer_strip(boundary)
        return replace(found, notes=("not made on the device", *found.notes))
    facts = {"method": "operator", "model": model, "device": device}
    grid = boundary.grid(nodes, facts)
    return Solution(grid, "operator", model=model, seconds={"grid": spent})
