"""Grids of boundaries by a given network, or by the default one of their topology."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.conformal import solve as conformal
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.neural.devices import Device, solve_on
from meshonet.solvers.neural.registry import BASE, DEFAULTS, load
from meshonet.solvers.solution import Solution

Answer = Literal["valid", "pasted", "raw"]
"""Treatment of a network's output: ``raw`` none; ``pasted`` its edges are replaced by the boundary's nodes,
as in the paper; ``valid`` folded cells are repaired as well (by the caller)."""


def infer_many(
    boundaries: Sequence[Boundary],
    model: str | None = None,
    polish: Polish = "auto",
    answer: Answer = "valid",
    device: Device | None = None,
) -> list[Solution]:
    """Return a grid inside each boundary by a shipped model, or by one that `meshonet train` made.

    `model` is the name of a shipped model, the path of a ``.safetensors`` file, ``base`` for the conformal
    solver, or None for the default of the topology. `polish` are steps after the network
    (`operator.Operator.solve`). On a `device` torch computes the grids, where polish ``auto`` means 3 Picard
    steps of a strip operator and none of a quad operator; without one NumPy does. Raises InputError: a model
    that does not exist, cannot be read or does not suit a boundary; no such device.
    """
    named = None if model is None else load(model)
    solutions: dict[int, Solution] = {}
    for topology in dict.fromkeys(boundary.topology for boundary in boundaries):
        rows = [k for k, boundary in enumerate(boundaries) if boundary.topology == topology]
        some = [boundaries[k] for k in rows]
        if topology == "c" and (named is None or named.batched):
            _refuse(model=model, polish=None if polish == "auto" else polish, device=device)
        network = named or load(DEFAULTS[topology])
        if device is None:
            solved = network.solve(some, polish, paste=answer != "raw")
        else:
            solved = solve_on(device, network, some, polish, instead=_without_network)
        solutions |= zip(rows, solved, strict=True)
    return [solutions[k] for k in range(len(boundaries))]


def grid_of_body(boundary: Boundary, why: str) -> Solution | None:
    """Return the grid of a compact body by `hole-o`, with a note of `why` it was used; None if folded."""
    from meshonet.solvers.algebraic.resample.grids import thinned
    from meshonet.solvers.neural.quad.encoding import LATENT
    from meshonet.solvers.neural.quad.o_grids import compact
    from meshonet.solvers.neural.quad.unrolled import AROUND

    if boundary.ni < LATENT or not compact(boundary):
        return None
    network = load("hole-o")
    try:
        coarse = network.solve([thinned(boundary, AROUND, LATENT)], "off")[0]
        if count_folded(coarse.grid.nodes):
            return None  # to untangle it takes longer than to solve
        solution = network.solve([boundary])[0]
    except InputError:
        return None
    if count_folded(solution.grid.nodes):
        return None
    return replace(solution, notes=(f"{why}: hole-o used",))


def _without_network(boundary: Boundary) -> Solution:
    """Return the grid of a boundary unsuited to networks: by the conformal solver, for a quad variational."""
    if boundary.topology == "o":
        return conformal.solve([boundary], substitute=grid_of_body)[0]
    from meshonet.solvers.energy.variational import solve

    return solve(boundary)


def _refuse(**parameters: object) -> None:
    """Raise InputError for parameters that do not apply to C grids, which no network makes."""
    for name, value in parameters.items():
        if value is not None:
            problem = f"{{{name}}} {value} is of no use to a c grid: it is marched, no model makes it"
            raise InputError(problem, f"drop {{{name}}}")


@dataclass(frozen=True)
class OperatorMethod:
    """The method ``operator``: grids by `infer_many`, whose settings are its fields."""

    model: str | None = None
    polish: Polish = "auto"
    answer: Answer = "valid"
    device: Device | None = None
    name = "operator"

    @cached_property
    def together(self) -> Topology | None:
        """The topology of boundaries that the network processes in one batch; None if one by one."""
        if self.device is None and self.model == BASE:
            return None  # no network
        network = load(self.model or DEFAULTS["o"])
        return network.topology if network.batched else None

    def solve(
        self,
        problems: Sequence[Boundary],
        start: Sequence[Grid] | None = None,  # noqa: ARG002 - networks start from nothing
    ) -> list[Solution]:
        """Return a solution for each of the boundaries, in batches where the network allows it."""
        return infer_many(problems, self.model, self.polish, self.answer, self.device)
