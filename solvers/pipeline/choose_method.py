"""Selects the method for a request, and the number of nodes on which it solves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from meshonet.geometry.arrays import TOPOLOGIES
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.solvers.pipeline.methods import OneByOne
from meshonet.solvers.pipeline.request import OneBlock
from meshonet.solvers.solution import Solution

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.methods import Method

NETWORK_SETTINGS = ("model", "polish", "device", "fallback")
"""Settings of the operator; if one of them is given, a network makes the grid."""


def method_of(request: OneBlock) -> Method:
    """Return the method that makes the grids of `request`, without the repair of folded cells.

    Raises InputError if the request has settings that the method does not have.
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
        method, request, {**(request.settings if own else {}), **_angle(request)}, full,
        marched=TOPOLOGIES if request.method == "hyperbolic" else ("o", "c") if automatic else (),
        channels=automatic,
    )  # fmt: skip


def _base(request: OneBlock) -> Method:
    """Return the method with its settings, on all nodes; a network only by its name or settings."""
    best = request.by_network or request.method == "best"
    chosen = ":" in request.method or not set(NETWORK_SETTINGS).isdisjoint(request.chosen)
    if best and not chosen and {*NETWORK_SETTINGS, "answer"}.issuperset(request.settings):
        if "answer" in request.chosen and not (request.at_walls or request.sides):
            raise InputError("{answer} without a network", "give {model} as well, or drop {answer}")
        return Best()
    from meshonet.solvers.pipeline.named import UnknownSettingError, method_named

    if best and chosen:
        return method_named(request.method if request.by_network else "operator", **request.settings)
    if best:
        wrong = next(each for each in request.settings if each not in (*NETWORK_SETTINGS, "answer"))
        raise UnknownSettingError("operator", wrong)
    if request.method == "auto":
        return method_named("winslow", **request.settings)
    if request.method == "hyperbolic":  # whose settings are the first cells
        return method_named("hyperbolic")
    return method_named(request.method, **request.settings, **_angle(request))


def _at_any_resolution(request: OneBlock, base: Method) -> Method:
    """Return `base` on fewer nodes, if this is requested, or left open and equally good."""
    open_method = request.by_network or request.method == "best"
    if request.refine:
        from meshonet.solvers.pipeline.automatic import Anew
        from meshonet.solvers.pipeline.coarse import Sequenced

        return Sequenced(Anew(base) if open_method else base, request.refine)
    if isinstance(request.coarse, int):
        from meshonet.solvers.pipeline.coarse import Coarse

        return Coarse(base, request.coarse)
    if open_method or request.coarse is None or request.settings or request.initial is not None:
        return base
    from meshonet.solvers.pipeline.automatic import elliptic, fewer_on_quads

    return elliptic() if request.method == "auto" else fewer_on_quads(base)


def _angle(request: OneBlock) -> dict[str, float]:
    return {} if request.wall_angle is None else {"angle": request.wall_angle}


@dataclass(frozen=True)
class Best(OneByOne):
    """The default: conformal for O grids, variational for four-sided grids, marching for C grids."""

    name: str = "best"

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of a boundary; only the variational method uses an initial grid."""
        if boundary.topology != "o":
            from meshonet.solvers.pipeline.automatic import AroundWake, Fewer
            from meshonet.solvers.pipeline.named import method_named
        if boundary.topology == "quad":
            return Fewer(method_named("variational")).solve_one(boundary, start)
        if boundary.topology == "c":
            return AroundWake().solve_one(boundary)
        from meshonet.solvers.conformal.solve import solve

        return solve([boundary], substitute=_by_network)[0]


def _by_network(boundary: Boundary, why: str) -> Solution | None:
    """Return the grid of a body without a suitable conformal map, made by the network for bodies."""
    from meshonet.solvers.neural.inference import grid_of_body

    return grid_of_body(boundary, why)
