"""From a boundary to a grid by whatever model is named."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from meshonet.geometry.arrays import Floats, Topology, as_planar
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.operator import Polish, infer_strips
from meshonet.solvers.neural.operator import infer as infer_strip
from meshonet.solvers.neural.quads.encoding import KIND as QUADS
from meshonet.solvers.neural.weights import KIND, kind_of, load_model, model_path
from meshonet.solvers.solution import Solution

if TYPE_CHECKING:
    from meshonet.solvers.neural.devices import Device
    from meshonet.solvers.neural.model_file import Trained

FOUR_SIDED = "quad-general"
"""Model for four-sided domains when none is named and a network is wanted: steps after it, or a device."""

Answer = Literal["valid", "pasted", "raw"]
"""What becomes of a network's answer: ``raw`` nothing; ``pasted`` the boundary's own nodes are put on its
edges, as the paper does; ``valid`` folded cells are repaired as well (by the caller's guard)."""


def infer(
    boundary: Boundary,
    model: str | None = None,
    polish: Polish = "auto",
    answer: Answer = "valid",
    device: Device | None = None,
) -> Solution:
    """Return the grid inside `boundary` by a shipped model, or by one that `meshonet train` made.

    Parameters
    ----------
    model : name of a shipped model, path to a ``.safetensors`` file, ``base``, or None for what measures
        best: with a given `polish` or `device` the network for the topology, else often no network.
    polish : of the strip operator (`meshonet.solvers.neural.operator.infer`) or of a quad model
        (`meshonet.solvers.neural.quads.inference.infer_quads`).
    answer : what becomes of the answer of a model that does not meet the boundary exactly.
    device : where torch computes the grid; None computes it here, without torch.

    Raises
    ------
    InputError
        a model that does not exist, cannot be read or does not suit the boundary; no such device.
    """
    if model is None and not boundary.around_body and (device is not None or polish != "auto"):
        model = FOUR_SIDED
    kind = KIND if model in (None, "base") else kind_of(model_path(model))
    if kind == "":
        load_model(model)  # which says what is wrong with the file
    if boundary.topology == "c" and kind in (KIND, QUADS):
        _refuse(model=model, polish=None if polish == "auto" else polish, device=device)
    if device is not None:
        return infer_many([boundary], model, polish, device)[0]
    if kind == KIND:
        return infer_strip(boundary, model, polish)
    if model is not None and kind == QUADS:
        from meshonet.solvers.neural.quads.inference import infer_quads

        return infer_quads([boundary], model, polish)[0]
    from meshonet.solvers.neural.model_file import load_trained

    trained = load_trained(model_path(model))
    begun = time.perf_counter()
    nodes, away = answered(trained, boundary, paste=answer != "raw")
    spent = time.perf_counter() - begun
    facts = {"method": "operator", "model": trained.name, "boundary_error": away}
    grid = boundary.grid(nodes, facts)
    told = f"the network's own boundary was off by {away:.1e} at most, and was {_DONE[answer != 'raw']}"
    notes = (told,) if away > 0.0 else ()
    return Solution(grid, "operator", model=trained.name, seconds={"grid": spent}, notes=notes)


def _refuse(**asked: object) -> None:
    """Raise InputError when anything was asked for that C grids, which no network makes, have no use for."""
    for option, value in asked.items():
        if value is not None:
            raise InputError(
                f"--{option} {value} is of no use to a c grid: it is marched, no model makes it",
                f"drop --{option}",
            )


def many_of(model: str | None, device: Device | None = None, polish: Polish = "auto") -> Topology | None:
    """Return the topology of what `infer_many` makes grids of in one go; None if that has no advantage."""
    if device is not None and not _is_quad(model):
        return "o"
    if model == "base" or (model is None and polish == "auto"):
        return None  # no network
    kind = KIND if model is None else kind_of(model_path(model))
    if kind != QUADS:
        return "o" if kind == KIND else None
    from meshonet.solvers.neural.quads.model import load_quads

    return load_quads(model_path(model)).topology


def infer_many(
    boundaries: Sequence[Boundary],
    model: str | None = None,
    polish: Polish = "auto",
    device: Device | None = None,
) -> list[Solution]:
    """Return what `infer` does for each of the boundaries, by one pass of a network, or on a device.

    Boundaries are O for the strip operator, and of the topology of a quad model.

    Raises
    ------
    InputError
        as `infer` does; a model that makes one grid at a time, or none on a device.
    """
    if device is not None:
        from meshonet.solvers.neural.devices import infer_on

        if kind_of(model_path(_named(model))) not in (KIND, QUADS):
            raise InputError(f"model {model} has no grids on a device", "leave --device out")
        return infer_on(device, boundaries, model, polish, many_of(model) if _is_quad(model) else None)
    from meshonet.solvers.neural.quads.inference import infer_quads

    kind = KIND if _named(model) is None else kind_of(model_path(model))
    if kind == KIND:
        return infer_strips(boundaries, model, polish)
    if kind != QUADS or model is None:
        raise InputError(f"model {model} makes one grid at a time", "name a shipped model")
    return infer_quads(boundaries, model, polish)


def _named(model: str | None) -> str | None:
    return None if model == "base" else model


def _is_quad(model: str | None) -> bool:
    return _named(model) is not None and kind_of(model_path(model)) == QUADS


_DONE = {True: "replaced by the true one", False: "left so"}


def answered(trained: Trained, boundary: Boundary, *, paste: bool = True) -> tuple[Floats, float]:
    """Return the nodes (ni, nj, 2), and how far their edges were from `boundary` at most before any pasting.

    The nodes of an O grid's cut are made one either way.
    """
    found = trained.difference(boundary)
    if trained.model.base == "harmonic":
        from meshonet.solvers.conformal.harmonic import extend

        found += extend(boundary)
    nodes = as_planar(found)
    edges = [(nodes[:, 0], boundary.south), (nodes[:, -1], boundary.north)]
    if boundary.periodic:
        nodes[-1] = nodes[0]
    else:
        edges += [(nodes[0], boundary.west), (nodes[-1], boundary.east)]
    away = max(float(np.hypot(*(own - true).T).max()) for own, true in edges)
    if paste:
        for own, true in edges:
            own[:] = true
    return nodes, away
