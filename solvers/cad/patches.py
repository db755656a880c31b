"""Structured patches on the faces of a CAD file, which match at their edges.

Nodes inside a face are blended between its edges in the coordinates of its surface, and lie on it exactly.
Nodes of an edge are made once, so that they are bitwise the same in all patches.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats, norms, ring_of
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.cad.model import CadFace, CadModel
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.algebraic.tfi import between
from meshonet.solvers.cad.edges import edge_laws, place_on
from meshonet.solvers.cad.sides import FacePlan, cell_counts, planned
from meshonet.solvers.solution import Solution, timed

CELLS = 40  # default number of cells along the longest extent of a file
_CORE = 0.5  # ratio of the size of a disc's core to the size of the disc
_OFF = 1e-8  # largest distance of edges from their faces, divided by the size of the file, without a note


class _FaceLine(NamedTuple):
    """Nodes along a side: coordinates (n, 2) on the face, positions (n, 3)."""

    places: Floats
    points: Floats

    def reversed(self) -> _FaceLine:
        return _FaceLine(self.places[::-1], self.points[::-1])

    def part(self, start: int, stop: int) -> _FaceLine:
        return _FaceLine(self.places[start : stop + 1], self.points[start : stop + 1])


@timed
def patches_on(model: CadModel, sampling: Sampling) -> Solution:
    """Return the patches on all faces of a CAD file, as a grid of blocks (ni, nj, 3).

    Two fields of `sampling` apply: `ni` is the number of cells along the longest extent (None: 40), and
    `spacing` is as in `edge_laws`.

    Raises InputError: a face cannot become patches (with its number, sides and place); cells are folded;
    other fields of `sampling` are set.
    """
    _check_sampling(sampling)
    plans = planned(model)
    extent = model.size
    laws = edge_laws(model, extent / (sampling.ni or CELLS), sampling.spacing)
    counts = cell_counts(model, plans, np.array([law.total for law in laws]))
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


def _four(plan: FacePlan, sides: list[_FaceLine]) -> list[_FaceLine]:
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
