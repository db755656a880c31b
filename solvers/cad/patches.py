r"""Structured patches on the faces of a CAD file, which match at their edges, by the faces' corners.

::

    four corners          two corners               no corner
    +---------+           +------                   . - - .        ring of four patches
    |         |    base   |         nodes across    /+----+\       around a core
    |         |           |         the nose        |+----+|
    +---------+           +------                   ` - - '

Nodes inside a face are blended between its edges in the coordinates of its surface, and lie on it exactly.
Nodes of an edge are made once, so that they are bitwise the same in all patches.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, norms, ring_of
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.cad.model import CadFace, CadModel
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.geometry.ties import nearest_whole
from meshonet.solvers.algebraic.tfi import between
from meshonet.solvers.cad.edges import CORNER_DEG, corner_turns, edge_laws, length_of, place_on
from meshonet.solvers.solution import Solution, timed
from meshonet.solvers.whole_numbers import Row, difference, whole_numbers

CELLS = 40  # default number of cells along the longest extent of a file
_CORE = 0.5  # ratio of the size of a disc's core to the size of the disc
_OFF = 1e-8  # largest distance of edges from their faces, divided by the size of the file, without a note
_REFUSED = 5  # faces named in an error
_ACROSS = 8  # smallest number of cells across a base, and across the nose opposite to it
_BASE = 0.7  # largest ratio of the base to the opposite side


class _FaceLine(NamedTuple):
    """Nodes along a side: coordinates (n, 2) on the face, positions (n, 3)."""

    places: Floats
    points: Floats

    def reversed(self) -> "_FaceLine":
        return _FaceLine(self.places[::-1], self.points[::-1])

    def part(self, start: int, stop: int) -> "_FaceLine":
        return _FaceLine(self.places[start : stop + 1], self.points[start : stop + 1])


@timed
def patches_on(model: CadModel, sampling: Sampling) -> Solution:
    """Return the patches on all faces of a CAD file, as a grid of blocks (ni, nj, 3).

    Two fields of `sampling` apply: `ni` is the number of cells along the longest extent (None: 40), and
    `spacing` is as in `edge_laws`.

    Raises InputError, with number and place of the face, if a face cannot become patches, or if cells are
    folded. Raises InputError if other fields of `sampling` are set.
    """
    _check_sampling(sampling)
    plans = _planned(model)
    extent = model.size
    laws = edge_laws(model, extent / (sampling.ni or CELLS), sampling.spacing)
    counts = _cell_counts(model, plans, np.array([law.total for law in laws]))
    nodes = [
        law.nodes(model, edge, int(count)) for law, edge, count in zip(laws, model.edges, counts, strict=True)
    ]
    blocks: list[Block] = []
    notes, off = list(model.notes), 0.0
    for number, (face, plan) in enumerate(zip(model.faces, plans, strict=True), 1):
        lines = [_FaceLine(*nodes[use.edge].along(use)) for use in face.uses]
        sides = [_joined([lines[k] for k in side]) for side in plan.sides]
        off = max(off, *(float(norms(face.points(side.places) - side.points).max()) for side in sides))
        made = _disc(face, sides[0]) if plan.kind == "disc" else [_quad(face, _four(plan, sides))]
        if plan.kind == "disc":
            first = len(blocks)
            notes.append(f"face {number} has no corners and became a core, patch {first}, in a ring of four")
        for patch in made:
            _check(patch, number)
            blocks.append(Block(patch[::-1] if face.inside_out else patch))
    if off > _OFF * extent:
        notes.append(f"edges of the file are up to {off:.2g} off its faces; nodes on edges are on the edges")
    return Solution(Grid(tuple(blocks), (), name=model.name), "patches", notes=tuple(notes))


def _check_sampling(sampling: Sampling) -> None:
    plain = vars(Sampling())
    for name, value in vars(sampling).items():
        if value != plain[name] and name not in ("ni", "nj", "spacing"):
            name = "res" if name == "nk" else name
            raise InputError(f"{{{name}}} is of no use to CAD files", f"drop {{{name}}}", parameter=name)
    if sampling.nj not in (None, sampling.ni):
        problem = f"{{res}} {sampling.ni}x{sampling.nj} for the faces of a CAD file"
        raise InputError(problem, "give one number, of cells along the longest extent", parameter="res")


def _joined(lines: list[_FaceLine]) -> _FaceLine:
    return _FaceLine(
        *(np.concatenate([lines[0][at], *(line[at][1:] for line in lines[1:])]) for at in (0, 1))
    )


def _four(plan: "_FacePlan", sides: list[_FaceLine]) -> list[_FaceLine]:
    """Return the four sides of a face, counter-clockwise; nose and base have equally many cells."""
    if plan.kind == "quad":
        return sides
    base, rest = sides
    across, around = len(base.points) - 1, len(rest.points) - 1
    start = (around - across) // 2
    return [base, rest.part(0, start), rest.part(start, start + across), rest.part(start + across, around)]


def _quad(face: CadFace, sides: list[_FaceLine]) -> Floats:
    """Return the nodes (ni, nj, 3) of a patch between four sides, counter-clockwise."""
    south, east, north, west = sides[0], sides[1], sides[2].reversed(), sides[3].reversed()
    places = between((south.places, north.places, west.places, east.places))
    patch = face.points(places.reshape(-1, 2)).reshape(*places.shape[:2], 3)
    patch[:, 0], patch[:, -1], patch[0], patch[-1] = south.points, north.points, west.points, east.points
    return patch


def _disc(face: CadFace, loop: _FaceLine) -> list[Floats]:
    """Return the core of a face without corners and the four patches of the ring around it."""
    total = len(loop.points) - 1
    one = max(total // 4, 1)
    ends = np.cumsum([0, one, total // 2 - one, one, total // 2 - one])
    arcs = [loop.part(int(a), int(b)) for a, b in pairwise(ends)]
    middle = loop.places[:-1].mean(axis=0)
    corners = [middle + _CORE * (arc.places[0] - middle) for arc in arcs]
    inner = []
    for k, arc in enumerate(arcs):
        part = np.linspace(0.0, 1.0, len(arc.places))[:, None]
        straight = corners[k] + part * (corners[(k + 1) % 4] - corners[k])
        places = 0.5 * (straight + middle + _CORE * (arc.places - middle))
        places[[0, -1]] = corners[k], corners[(k + 1) % 4]
        inner.append(_FaceLine(places, face.points(places)))
    rows = max(2, round(0.3 * total / np.pi * (1.0 - _CORE)))
    spokes = []
    for k, arc in enumerate(arcs):
        part = np.linspace(0.0, 1.0, rows + 1)[:, None]
        places = inner[k].places[0] + part * (arc.places[0] - inner[k].places[0])
        points = face.points(places)
        points[0], points[-1] = inner[k].points[0], arc.points[0]
        spokes.append(_FaceLine(places, points))
    ring = [
        _quad(face, [arc, spokes[(k + 1) % 4].reversed(), inner[k].reversed(), spokes[k]])
        for k, arc in enumerate(arcs)
    ]
    return [_quad(face, inner), *ring]


def _check(patch: Floats, number: int) -> None:
    """Raise InputError if cells of a patch are folded: corners that turn against their cell."""
    a, b, c, d = ring_of(patch)
    normal = np.cross(c - a, d - b)
    folded = np.zeros(normal.shape[:2], dtype=bool)
    for p, q, r in ((a, b, d), (b, c, a), (c, d, b), (d, a, c)):
        folded |= (np.cross(q - p, r - p) * normal).sum(axis=-1) < 0.0
    if folded.any():
        i, j = np.argwhere(folded)[0]
        problem = f"{int(folded.sum())} cells of the patch on face {number} are folded"
        remedy = "split the face in the CAD program, or give a larger {res}"
        raise InputError(problem, remedy, place=place_on(patch[i : i + 1, j]))


@dataclass(frozen=True)
class _FacePlan:
    """Division of a face into patches; a side lists consecutive edges by their positions in the face's loop.

    A ``quad`` has four sides, a ``nose`` a short one and a long one, a ``disc`` a single one with all edges.
    """

    kind: Literal["quad", "nose", "disc"]
    sides: tuple[tuple[int, ...], ...]


def _planned(model: CadModel) -> tuple[_FacePlan, ...]:
    """Return the division of each face into patches. Raises InputError for a face that cannot be divided."""
    plans, problems = [], []
    for number, face in enumerate(model.faces, 1):
        plan = _plan(model, face)
        if isinstance(plan, str):
            middle = [edge.points for use in face.uses if (edge := model.edges[use.edge])]
            points = np.concatenate([each(np.array([0.5])) for each in middle if each is not None])
            problems.append(f"face {number} near {place_on(points)} has {plan}")
        else:
            plans.append(plan)
    if problems:
        more = f" and {len(problems) - _REFUSED} faces more" if len(problems) > _REFUSED else ""
        remedy = "split it there in the CAD program into faces of four sides"
        raise InputError("; ".join(problems[:_REFUSED]) + more, remedy)
    return tuple(plans)


def _plan(model: CadModel, face: CadFace) -> _FacePlan | str:
    """Return the plan of a face, or as text the property that prevents one."""
    if face.holes:
        return "a hole" if face.holes == 1 else f"{face.holes} holes"
    turns = corner_turns(model, face.uses)
    corners = np.flatnonzero(turns > CORNER_DEG)
    if len(face.uses) == 4 and len(corners) >= 3:
        corners = np.arange(4)
    if len(corners) == 4:
        return _FacePlan("quad", _runs(corners, len(face.uses)))
    if len(corners) == 2:
        runs = _runs(corners, len(face.uses))
        lengths = [sum(_length(model, face, k) for k in run) for run in runs]
        short, long = runs if lengths[0] <= lengths[1] else runs[::-1]
        if min(lengths) > _BASE * max(lengths):
            return "two sides that meet in two corners"
        return _FacePlan("nose", (short, long))
    if not len(corners):
        return _FacePlan("disc", (tuple(range(len(face.uses))),))
    words = {1: "one corner", 3: "three sides"}
    return words.get(len(corners), f"{len(corners)} sides")


def _runs(corners: Indices, count: int) -> tuple[tuple[int, ...], ...]:
    """Return the positions of edges in a loop from each corner to the next."""
    ends = [*corners.tolist(), int(corners[0]) + count]
    return tuple(tuple(k % count for k in range(a, b)) for a, b in pairwise(ends))


def _length(model: CadModel, face: CadFace, k: int) -> float:
    points = model.edges[face.uses[k].edge].points
    return 0.0 if points is None else length_of(points)


def _cell_counts(model: CadModel, plans: tuple[_FacePlan, ...], wanted: Floats) -> Indices:
    """Return even numbers of cells (edges,) near `wanted` (edges,) that agree on opposite sides of patches.

    Raises InputError: there are no such numbers.
    """
    rows: list[Row] = []
    for face, plan in zip(model.faces, plans, strict=True):
        runs = [[face.uses[k].edge for k in side] for side in plan.sides]
        if plan.kind == "quad":
            rows += [difference(runs[0], runs[2]), difference(runs[1], runs[3])]
        elif plan.kind == "nose":
            rows.append(difference(runs[0], [], 0.5 * _ACROSS, np.inf))
            rows.append(difference(runs[1], runs[0], 1.0, np.inf))
        else:
            rows.append(difference(runs[0], [], 2.0, np.inf))
    halves = np.maximum(nearest_whole(0.5 * wanted), 1.0)
    try:
        return 2 * whole_numbers(halves, np.ones(len(halves)), [row for row in rows if row[0]])
    except SolverError as error:
        problem = "no numbers of cells agree on opposite sides of all faces"
        raise InputError(problem, "split faces with several edges on a side") from error
