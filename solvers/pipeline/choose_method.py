"""The method that makes what a request asks for, and on how many nodes it solves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from meshonet.geometry.arrays import TOPOLOGIES
from meshonet.geometry.spacing.y_plus import height_note
from meshonet.solvers.method import Method, method_named
from meshonet.solvers.pipeline.coarse import Coarse
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.select import best, elliptic, fewer_on_quads
from meshonet.solvers.pipeline.sequence import Sequenced

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.layered import FirstCells

OPERATOR_SETTINGS = ("model", "polish", "device")  # settings any of which asks for a network


def method_of(request: GridRequest) -> Method:
    """Return the method that makes the grids of `request`, without the guard.

    Raises InputError: settings that the method does not have.
    """
    base = _base(request)
    method = _at_any_resolution(request, base)
    if not request.at_walls and not request.sides and not request.slide:
        return method
    from meshonet.solvers.pipeline.layered import Layered

    automatic = request.method in ("best", "auto") or request.by_network
    full = None if request.refine or isinstance(request.coarse, int) else base
    own = full is not None and base.name in ("winslow", "steger-sorenson")
    return Layered(
        method, _first_cells(request), {**(request.settings if own else {}), **_angle(request)}, full,
        marched=TOPOLOGIES if request.method == "hyperbolic" else ("o", "c") if automatic else (),
        channels=automatic, slide=request.slide, chosen=request.chosen,
    )  # fmt: skip


def _base(request: GridRequest) -> Method:
    """Return the method with its settings, on all nodes."""
    if request.by_network or request.method == "best":
        return method_named("operator" if request.method == "best" else request.method, **request.settings)
    if request.method == "auto":
        return method_named("winslow", **request.settings)
    if request.method == "hyperbolic":  # whose settings are the first cells
        return method_named("hyperbolic")
    return method_named(request.method, **request.settings, **_angle(request))


def _at_any_resolution(request: GridRequest, base: Method) -> Method:
    """Return `base` on fewer nodes where that is asked for, or left open and as good."""
    if request.refine:
        return Sequenced(base, request.refine)
    if isinstance(request.coarse, int):
        return Coarse(base, request.coarse)
    if request.by_network or request.method == "best":
        network = ":" in request.method or any(name in request.chosen for name in OPERATOR_SETTINGS)
        return base if network else best(base)
    if request.coarse is None or request.settings or request.initial is not None:
        return base
    return elliptic() if request.method == "auto" else fewer_on_quads(base)


def _first_cells(request: GridRequest) -> FirstCells:
    """Return the heights of first cells and the layers that begin with them."""
    from meshonet.solvers.pipeline.layered import FirstCells

    height = request.wall_height()
    where = f"and x/c {request.chord_fraction:g}"
    note = height_note(request.y_plus, request.reynolds, where, f"{height or 0.0:.6g} chords")
    free_rows = request.growth is not None and request.sampling.nj is None
    layers = request.constant_layers or 1, request.growth, free_rows
    return FirstCells(height, request.sides, *layers, in_chords=bool(note), note=note)


def _angle(request: GridRequest) -> dict[str, float]:
    return {} if request.wall_angle is None else {"angle": request.wall_angle}
