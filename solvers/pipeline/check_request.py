"""Validation of requests: values out of range, options that need or exclude each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.first_cell import check_height
from meshonet.solvers.pipeline.methods import METHODS

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.request import GridRequest

LIMITS = {"tol": (0.0, 1.0, "1e-8")}
"""Settings of single methods, each with the open interval of its values and an example."""


def check_request(request: GridRequest) -> None:
    """Raise InputError if a value is out of range, or if options exclude each other or need another one."""
    if request.method not in ("best", "auto") and request.method.partition(":")[0] not in METHODS:
        from meshonet.solvers.pipeline.named import method_named

        method_named(request.method)  # which says what there is
    _check_first_cells(request)
    if request.wall_angle is not None and request.method != "steger-sorenson":
        problem = f"method {request.method} sets no angle"
        raise InputError(problem, "use {method} steger-sorenson", parameter="wall_angle")
    if isinstance(request.coarse, int):
        if request.refine:
            raise InputError("{coarse} and {refine} both solve on fewer nodes first", "give one of them")
        if request.initial is not None:
            problem = "a coarse solve has no use for a grid to start from"
            raise InputError(problem, "drop {initial} or {coarse}")
    if request.repair and request.settings.get("answer") == "raw":
        problem = "{repair} would change a raw answer"
        raise InputError(problem, "leave one of {repair} and {answer} out")
    for name, (low, high, example) in LIMITS.items():
        value = request.settings.get(name)
        if value is not None and not low < value < high:
            problem = f"{value:g} is not between {low:g} and {high:g}"
            raise InputError(problem, f"use e.g. {example}", parameter=name)
    for name, least in (("threads", 1), ("constant_layers", 1), ("layers", 3)):
        value = getattr(request, name)
        if value is not None and value < least:
            raise InputError(f"{value} is too few", f"give {least} or more", parameter=name)
    if request.blocks not in ("auto", "single"):
        raise InputError(f"blocks {request.blocks!r} is not known", "use auto or single")
    if request.asks_for_blocks or request.names_walls:
        from meshonet.solvers.pipeline.blocks import check_asked

        check_asked(request)


def _check_first_cells(request: GridRequest) -> None:
    request.check_first_cell()
    for side, height in request.sides.items():
        check_height(height, f"spacing_{side}")
    if request.method == "hyperbolic" and not request.at_walls:
        raise InputError("{method} hyperbolic without a first cell", "give {first_cell} or {y_plus} as well")
    if not request.at_walls and not request.sides:
        for name in ("constant_layers", "growth"):
            if getattr(request, name) is not None:
                problem = f"{{{name}}} without a first cell"
                raise InputError(problem, "give {first_cell} or {y_plus} as well")
    if request.at_walls and request.growth is not None and not 1 < request.growth <= 10:
        remedy = "give the ratio of neighbouring cells, such as 1.15"
        raise InputError(f"a growth of {request.growth:g}", remedy, parameter="growth")
