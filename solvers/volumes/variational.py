"""Variational volumes inside six faces: optimised on few nodes, refined, and repaired."""

import time
from typing import Literal

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.errors import InputError
from meshonet.solvers.energy.hex_functional import ENERGIES, OPTIMAL, Energy, HexWeights
from meshonet.solvers.energy.hexes import NEARLY
from meshonet.solvers.iteration import check_tolerances
from meshonet.solvers.solution import Outcome, Solution
from meshonet.solvers.stages import reached
from meshonet.solvers.volumes.edge_corners import check_corners
from meshonet.solvers.volumes.first_cells import keep_first_cells
from meshonet.solvers.volumes.interpolate import Laws, arc_laws, interpolate, mean_laws, uniform_laws
from meshonet.solvers.volumes.planes_descent import PlanesDescent
from meshonet.solvers.volumes.refine import refine_volume
from meshonet.solvers.volumes.repair import open_flat_cells, repair

COARSE = 33  # default node count along a direction for the optimisation
SPARE = 41
"""Largest node count along a direction for which the nodes of the faces are used instead of coarse ones."""
EVEN = 1.5  # largest ratio of the steps of an evenly spaced edge
COARSEST = 11  # a copy of no more nodes along each direction is solved from the interpolation
ITERATIONS = 30, 20, 40  # largest numbers of iterations on coarser levels, on the last but one, on the last
FEW = 20  # largest node count of levels on which flat cells are opened first
LEAST = 5  # nodes along a direction of coarse faces


def variational(
    faces: SixFaces,
    *,
    max_cycles: int | None = None,
    coarse: int | Literal["auto"] | None = "auto",
    energy: Energy = "angles",
) -> Solution:
    """Minimise a functional of `meshonet.solvers.energy.hex_functional` over the nodes inside `faces`.

    The optimum on a coarse grid is interpolated to all nodes by splines. If cells fold, they are repaired.

    Parameters
    ----------
    max_cycles : largest number of iterations on the coarse grid.
    coarse : largest number of nodes of the coarse grid per direction; "auto": 33; None: as on the faces.
    energy : ``angles``, for right angles and gradual changes of length, or ``shape``, for cells like cubes.

    Raises InputError if a setting is not positive, an edge has no length, or the faces alone fold a cell.
    """
    begun = time.perf_counter()
    _check(max_cycles, coarse, energy)
    check_corners(faces)
    laws = mean_laws(arc_laws(faces))
    optimum_faces = _coarse_faces(faces, laws, coarse)
    weights = ENERGIES[energy]
    reached("optimum")
    planes, iterations = optimum(optimum_faces, max_cycles, weights)
    solved = time.perf_counter()
    if optimum_faces is not faces:
        reached("evaluation")
        planes = np.ascontiguousarray(refine_volume(planes, optimum_faces, faces, laws))
        keep_first_cells(planes, faces, laws)
    evaluated = time.perf_counter()
    reached("repair")
    folded = repair(planes)
    terms = {} if weights.of_cubes else {"shape": weights.shape, "smoothness": weights.smoothness}
    facts = {"method": "variational", "energy": energy, **terms}
    counts = "x".join(map(str, optimum_faces.counts))
    grid = faces.grid(np.moveaxis(planes, 0, -1), {**facts, "cycles": iterations, "coarse": counts})
    done = time.perf_counter()
    spent = {"optimum": solved - begun, "evaluation": evaluated - solved, "repair": done - evaluated}
    outcome = Outcome.FOLDED if folded else Outcome.DONE
    return Solution(grid, "variational", cycles=iterations, seconds=spent, outcome=outcome)


def optimum(
    faces: SixFaces, most: int | None = None, weights: HexWeights = OPTIMAL
) -> tuple[Floats, int]:  # fmt: skip
    """Return optimal nodes (3, ni, nj, nk) inside `faces`, and the number of iterations on the finest level.

    The faces must have evenly spaced nodes. If the grid cannot be untangled, it is returned folded.
    """
    levels = [faces]
    while max(levels[-1].counts) > COARSEST:
        levels.append(levels[-1].resampled(_halved(levels[-1].counts)))
    last, count = levels[-1], 0
    planes = _interpolated(last)
    for depth in range(len(levels) - 1, -1, -1):
        if levels[depth] is not last:
            finer = levels[depth]
            planes = np.ascontiguousarray(refine_volume(planes, last, finer, uniform_laws(finer.counts)))
            last = finer
        limit = ITERATIONS[max(len(ITERATIONS) - 1 - depth, 0)]
        limit = most if depth == 0 and most is not None else limit
        planes, count = _solved(planes, last, limit, weights)
    return planes, count


def _interpolated(faces: SixFaces) -> Floats:
    return np.ascontiguousarray(np.moveaxis(interpolate(faces, uniform_laws(faces.counts)), -1, 0))


def _solved(planes: Floats, faces: SixFaces, most: int, weights: HexWeights) -> tuple[Floats, int]:
    """Return the minimum from planes, which are overwritten, and the iterations.

    If they stay folded, the iteration starts again from the interpolation if that is less folded.
    """
    count, smallest = _settle(planes, most, weights)
    if smallest <= 0.0:
        plain = _interpolated(faces)
        if PlanesDescent(plain).smallest() > smallest:
            return plain, count + _settle(plain, most, weights)[0]
    return planes, count


def _settle(planes: Floats, most: int, weights: HexWeights) -> tuple[int, float]:
    """Untangle and minimise planes in place; return iterations and smallest Jacobian."""
    if min(planes.shape[1:]) < 3:
        return 0, np.inf
    descent = PlanesDescent(planes, weights.of_cubes)
    smallest = descent.smallest()
    folded = smallest <= 0.0
    if folded:
        repair(planes)
        descent = PlanesDescent(planes, weights.of_cubes)
        smallest = descent.unfold(descent.smallest())
    if 0.0 < smallest < NEARLY and (folded or max(planes.shape) <= FEW):
        descent.open()
    elif 0.0 < smallest < NEARLY:
        open_flat_cells(planes)
        descent = PlanesDescent(planes, weights.of_cubes)
    if smallest > 0.0:
        smallest = descent.run(weights, most)[0]
    return descent.iterations, smallest


def _halved(counts: tuple[int, int, int]) -> tuple[int, int, int]:
    """Return the counts of every second node, in directions with more than `COARSEST`."""
    ni, nj, nk = (n // 2 + 1 if n > COARSEST else n for n in counts)
    return ni, nj, nk


def _coarse_faces(faces: SixFaces, laws: Laws, coarse: int | Literal["auto"] | None) -> SixFaces:
    """Return the faces for the optimisation: `faces` themselves if few and evenly spaced."""
    most = max(faces.counts) if coarse is None else COARSE if coarse == "auto" else coarse
    spare = SPARE if coarse == "auto" else most
    steps = [np.diff(law[0]) for law in laws]
    if max(faces.counts) <= spare and all(step.max() <= EVEN * step.min() for step in steps):
        return faces
    counts = [n if n <= spare else most for n in faces.counts]
    places = [np.linspace(0.0, 1.0, max(n, LEAST)) for n in counts]
    return faces.at([law[0] for law in laws], places)


def _check(max_cycles: int | None, coarse: int | Literal["auto"] | None, energy: str) -> None:
    check_tolerances(None, max_cycles)
    if energy not in ENERGIES:
        raise InputError(f"energy {energy!r}", f"use {' or '.join(ENERGIES)}", parameter="energy")
    if isinstance(coarse, int) and coarse < LEAST:
        raise InputError(f"{coarse} coarse nodes", f"use at least {LEAST}", parameter="coarse")
