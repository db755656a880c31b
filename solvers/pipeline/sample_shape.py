"""The boundary nodes of a shape, as a request samples them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import Advice
from meshonet.geometry.shapes.shape import Shape, edges_of
from meshonet.geometry.shapes.spatial_shape import SpatialShape
from meshonet.geometry.spacing.sampling import DEFAULT_FAR_FIELD, Sampling
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.uses import IN_SPACE, ONE, refuse

if TYPE_CHECKING:
    from meshonet.geometry.shapes.domain_shape import DomainShape


def sampled(shape: Shape, request: GridRequest) -> Boundary | DomainShape | SpatialShape:
    """Return the boundary of a shape, or the shape itself in space and where many blocks are made of it."""
    if isinstance(shape, SpatialShape):
        return shape
    if isinstance(shape, (str, Path, np.ndarray)):
        remedy = "use meshonet.grid, or make a shape of it: meshonet.read or Domain.of_polygons"
        what = "points" if isinstance(shape, np.ndarray) else "a name"
        raise InputError(f"make_grid takes shapes, not {what}", remedy)
    refuse(filter(IN_SPACE.__contains__, request.chosen), ONE)
    if request.sampling.nk is not None:
        problem = f"{request.sampling.nk} nodes along a third direction of a grid in the plane"
        raise InputError(problem, "give NI x NJ", parameter="res")
    if request.asks_for_blocks or getattr(shape, "many", False):
        from meshonet.solvers.pipeline.blocks import as_blocks

        domain = as_blocks(shape, request)
        if domain is not None:
            default = domain.far_field and request.pitch is None
            return domain.noted(*_far_field_advice(request, "extents of the bodies")) if default else domain
    sampling = request.shape_sampling()
    boundary = edges_of(shape, sampling)
    if request.refine:
        boundary = edges_of(shape, _finer(sampling, shape, boundary, 2**request.refine))
    unit = getattr(shape, "far_field_unit", "")
    if boundary.topology == "quad" or not (unit and request.at_walls):
        return boundary
    return replace(boundary, notes=(*boundary.notes, *_far_field_advice(request, unit)))


def _far_field_advice(request: GridRequest, unit: str) -> tuple[str, ...]:
    """Return advice on forces, where cells are thin at walls and the far field is where it is by default."""
    if not request.at_walls or request.sampling.far_field is not None:
        return ()
    where = f"the far field is {DEFAULT_FAR_FIELD:g} {unit} away, the default"
    return (Advice(f"{where}: for lift and drag give {{far_field}} 100 or more"),)


def _finer(sampling: Sampling, shape: Shape, boundary: Boundary, k: int) -> Sampling:
    """Return `sampling` with `k` times the cells of the `boundary` of `shape`, those of a wake included."""
    wakes = [patch.stop - patch.start for patch in boundary.patches if patch.name == "wake"]
    made = boundary.topology == "c" and wakes and not isinstance(shape, Boundary)
    nodes = k * wakes[0] + 1 if made else sampling.wake_nodes
    return replace(sampling, ni=k * (boundary.ni - 1) + 1, nj=k * (boundary.nj - 1) + 1, wake_nodes=nodes)
