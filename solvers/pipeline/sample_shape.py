"""Boundary nodes of a shape for a request."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Advice
from meshonet.geometry.shapes.shape import Shape, SpatialShape, edges_of
from meshonet.geometry.spacing.sampling import DEFAULT_FAR_FIELD, DEFAULT_NI, DEFAULT_NJ, Sampling
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.uses import AROUND_BASE, IN_SPACE, ONE, USES, refuse

if TYPE_CHECKING:
    from typing import TypeGuard

    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
    from meshonet.geometry.shapes.airfoil.base_wake import BaseWake
    from meshonet.geometry.shapes.domain_shape import DomainShape

MARCHING = ("best", "auto", "hyperbolic")
"""Method names with which grids with layers around airfoils are marched."""
THIN_BASE = 0.005
"""Largest height of a base, in chords, that C grids close with a wedge by default, unless it is resolved."""
RESOLVED = 10.0
"""Height of a base in first cells from which on lines from its corners are straight enough to keep it."""

_TURNED = "xi runs along the walls with layers, which are the sides south and north"
"""Note on a four-sided domain whose walls, according to the names of its sides, are west or east."""


def sampled(shape: Shape, request: GridRequest) -> Boundary | BaseWake | DomainShape | SpatialShape:
    """Return the boundary of a shape; three-dimensional and multi-block shapes are returned unchanged.

    For a C grid that keeps the blunt trailing edge of an airfoil, return the line around airfoil and wake.
    """
    if isinstance(shape, SpatialShape):
        return shape
    if isinstance(shape, (str, Path, np.ndarray)):
        remedy = "use meshonet.grid, or make a shape of it: meshonet.read or Domain.of_polygons"
        what = "points" if isinstance(shape, np.ndarray) else "a name"
        raise InputError(f"make_grid takes shapes, not {what}", remedy)
    if not IN_SPACE.isdisjoint(request.chosen):
        refuse(filter(IN_SPACE.__contains__, request.chosen), ONE)
    if request.sampling.nk is not None:
        problem = f"{request.sampling.nk} nodes along a third direction of a grid in the plane"
        raise InputError(problem, "give NI x NJ", parameter="res")
    if request.asks_for_blocks or request.names_walls or getattr(shape, "many", False):
        from meshonet.solvers.pipeline.blocks import as_blocks

        domain = as_blocks(shape, request)
        if domain is not None:
            default = domain.far_field and request.pitch is None
            return domain.noted(*_far_field_advice(request, "extents of the bodies")) if default else domain
    sampling = request.shape_sampling()
    if sampling.topology == "c" and keeps_base(shape, request):
        k = 2**request.refine
        _check_refined(sampling.ni or DEFAULT_NI, sampling.nj or DEFAULT_NJ, request.refine)
        return _behind_base(shape, _times(sampling, k) if k > 1 else sampling, request)
    # nodes on a base are those of the refined grid
    boundary = edges_of(shape, replace(sampling, base_nodes=None) if request.refine else sampling)
    if request.at_walls and boundary.topology == "quad" and not isinstance(shape, Boundary):
        boundary = _along_walls(boundary, shape, sampling, request)
    if request.refine:
        _check_refined(boundary.ni, boundary.nj, request.refine)
        boundary = edges_of(shape, _finer(sampling, shape, boundary, 2**request.refine))
    unit = getattr(shape, "far_field_unit", "")
    if boundary.topology == "quad" or not (unit and request.at_walls):
        return boundary
    return replace(boundary, notes=(*boundary.notes, *_far_field_advice(request, unit)))


def _along_walls(boundary: Boundary, shape: Shape, sampling: Sampling, request: GridRequest) -> Boundary:
    """Return the `boundary` of a four-sided shape, turned if all its walls with layers are west and east."""
    from meshonet.geometry.blocks.transform import turned_boundary
    from meshonet.solvers.pipeline.first_cells import along_walls

    if along_walls(boundary, request):
        return boundary
    across = replace(sampling, ni=sampling.nj or DEFAULT_NJ, nj=sampling.ni or DEFAULT_NI)
    boundary = turned_boundary(edges_of(shape, across))
    return replace(boundary, notes=(*boundary.notes, _TURNED))


def _check_refined(ni: int, nj: int, halvings: int) -> None:
    if halvings:
        from meshonet.geometry.reach import MOST_REFINED, check_reach

        check_reach(
            (ni - 1.0) * (nj - 1.0) * (1 << 2 * halvings), "cells",
            f"a grid of {ni}x{nj} nodes, its cells halved {halvings} times,", "use fewer",
            most=MOST_REFINED, parameter="refine",
        )  # fmt: skip


def keeps_base(shape: Shape, request: GridRequest) -> TypeGuard[Airfoil]:
    """Return whether a request marches a C grid that keeps the blunt base (trailing edge) of an airfoil.

    `te` ``exact`` keeps every base. ``auto`` without a first-cell height keeps bases higher than `THIN_BASE`
    chords, unless an option such as `coarse` excludes such grids. ``auto`` with a first-cell height keeps a
    base higher than `THIN_BASE` chords if it has the height of at least one first cell, and any other base if
    it has that of `RESOLVED` first cells. If `base_nodes` is given too, every base is kept.
    """
    sampling = request.sampling
    if request.method not in MARCHING or sampling.te not in ("auto", "exact"):
        return False
    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

    if not isinstance(shape, Airfoil):
        return False
    body = shape.prepared(sampling)
    if not body.blunt or sampling.te == "exact":
        return body.blunt
    thick, height = body.gap > THIN_BASE * body.chord, request.height()
    if height is not None:
        least = (1.0 if thick else RESOLVED) * height * body.unit
        return body.gap >= (1.0 - 1e-9) * least or sampling.base_nodes is not None
    return thick and USES[AROUND_BASE].issuperset(request.chosen)


def _behind_base(shape: Airfoil, sampling: Sampling, request: GridRequest) -> BaseWake:
    """Return the lines of nodes around an airfoil with a blunt base and along its wake."""
    from meshonet.geometry.shapes.airfoil.base_wake import behind_base

    refuse(request.chosen, AROUND_BASE)
    body = shape.prepared(sampling)
    height, notes = request.height(), _far_field_advice(request, shape.far_field_unit)
    if height is None:
        from meshonet.solvers.hyperbolic.default_spacing import CHOSEN, first_cell_around_base

        ni, nj = sampling.ni or DEFAULT_NI, sampling.nj or DEFAULT_NJ
        away, notes = sampling.radius * body.chord, (CHOSEN,)
        first = first_cell_around_base(body.gap, away, body.chord, ni, nj)
    else:
        first = height * body.unit
    lines = behind_base(body, sampling, first, request.growth)
    return replace(lines, notes=(*lines.notes, *notes))


def _far_field_advice(request: GridRequest, unit: str) -> tuple[str, ...]:
    if not request.at_walls or request.sampling.far_field is not None:
        return ()
    where = f"the far field is {DEFAULT_FAR_FIELD:g} {unit} away, the default"
    return (Advice(f"{where}: for lift and drag give {{far_field}} 100 or more"),)


def _times(sampling: Sampling, k: int) -> Sampling:
    """Return `sampling` with `k` times the cells of its counts, of which None follow from other sizes."""
    counts = sampling.ni, sampling.nj or DEFAULT_NJ, sampling.wake_nodes
    ni, nj, wake = (n and k * (n - 1) + 1 for n in counts)
    return replace(sampling, ni=ni, nj=nj, wake_nodes=wake, refined=k)


def _finer(sampling: Sampling, shape: Shape, boundary: Boundary, k: int) -> Sampling:
    """Return `sampling` with `k` times the cells of the `boundary` of `shape`, including those of a wake."""
    wakes = [patch.stop - patch.start for patch in boundary.patches if patch.name == "wake"]
    made = boundary.topology == "c" and wakes and not isinstance(shape, Boundary)
    nodes = k * wakes[0] + 1 if made else sampling.wake_nodes
    ni, nj = (k * (n - 1) + 1 for n in (boundary.ni, boundary.nj))
    if isinstance(shape, Boundary):  # whose corners stay where they are, k times as far along
        return replace(sampling, ni=ni, nj=nj)
    return replace(sampling, ni=ni, nj=nj, wake_nodes=nodes, refined=k)
