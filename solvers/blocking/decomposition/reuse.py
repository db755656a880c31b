"""Transfers a layout to another domain of the same kind, for families of shapes with one topology.

Nodes on a loop keep their fraction of arc length between corners. Interior nodes are moved by the affine map
that best fits the nodes on loops, then by a harmonic displacement (Helenbrook, Int. J. Numer. Meth. Engng 56
(2003) 1007-1021).
"""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.places_on_loops import arc_at, place_at
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.linear import least_squares
from meshonet.solvers.sparse import SparsePattern

OFFSETS = 128  # number of points around a loop without corners at which it is compared with another loop


def carried_over(layout: Layout, domain: Domain) -> Layout:
    """Return the layout transferred to another domain; its cells may be folded.

    Raises InputError if the two domains differ in the number of loops, or of corners on a loop.
    """
    mesh = layout.mesh
    pairs = _pairs(mesh.domain.loops, domain.loops)
    places = mesh.places
    loop, arc, nodes = places.loop.copy(), places.arc.copy(), mesh.nodes.copy()
    for old, new in pairs.items():
        on = np.flatnonzero(places.loop == old)
        arc[on] = _carried(mesh.domain.loops[old], domain.loops[new], places.arc[on])
        loop[on] = new
        nodes[on] = domain.loops[new].at(arc[on])
    on_loops = places.loop >= 0
    nodes[~on_loops] = _moved_along(mesh, nodes, on_loops)
    carried = QuadMesh(domain, nodes, mesh.quads, replace(places, loop=loop, arc=arc))
    return replace(layout, mesh=carried, fronts=tuple(sorted(pairs[k] for k in layout.fronts)))


def _pairs(old: tuple[Loop, ...], new: tuple[Loop, ...]) -> dict[int, int]:
    """Return the new loop of each old one: holes by their names if these are unique, else by their order."""
    if len(old) != len(new):
        counts = [f"{len(loops) - 1} hole{'' if len(loops) == 2 else 's'}" for loops in (old, new)]
        problem = f"the layout is of a domain with {counts[0]}, this one has {counts[1]}"
        raise InputError(problem, "give a layout of the same kind", parameter="layout")
    named = [_by_name(loops[1:]) for loops in (old, new)]
    if named[0] and named[0].keys() == named[1].keys():
        pairs = {0: 0} | {k: named[1][name] for name, k in named[0].items()}
    else:
        pairs = {k: k for k in range(len(old))}
    for k, new_loop in pairs.items():
        own, others = len(old[k].corners), len(new[new_loop].corners)
        if own != others:
            what = f"loop {new_loop} ({', '.join(dict.fromkeys(new[new_loop].names))})"
            problem = f"{what} has {others} corner{'' if others == 1 else 's'}, in the layout it has {own}"
            raise InputError(problem, "give a layout of the same kind", parameter="layout")
    return pairs


def _by_name(holes: tuple[Loop, ...]) -> dict[tuple[str, ...], int]:
    """Return the index of each hole by its names; empty if several holes share names."""
    numbers = {tuple(sorted(set(loop.names))): k for k, loop in enumerate(holes, start=1)}
    return numbers if len(numbers) == len(holes) else {}


def _carried(old: Loop, new: Loop, arc: Floats) -> Floats:
    """Return the arc lengths (n,) on the new loop that correspond to `arc` (n,) on the old one."""
    shift = _corner_shift(old, new) if old.corners else _begin(old, new)
    return arc_at(new, place_at(old, arc) + shift)


def _corner_shift(old: Loop, new: Loop) -> int:
    """Return the index of the new corner that corresponds to the first corner of the old loop.

    The names of stretches should agree, then the angles of corners and their places in the bounding boxes.
    """
    ours, theirs = (_in_box(loop.curve.points[list(loop.corners)], loop) for loop in (old, new))
    our_names, their_names = (np.array(loop.names) for loop in (old, new))
    named = len(our_names) > 1 and sorted(our_names) == sorted(their_names)
    costs = []
    for k in range(len(theirs)):
        cost = float(((np.roll(theirs, -k, axis=0) - ours) ** 2).sum())
        cost += float(np.abs(np.roll(new.corner_angles, -k) - old.corner_angles).sum()) / 180.0
        differ = int((np.roll(their_names, -k) != our_names).sum()) if named else 0
        costs.append(cost + 1e3 * differ)
    return int(np.argmin(costs))


def _begin(old: Loop, new: Loop) -> float:
    """Return the fraction of the new loop's length at which a point corresponds to the old loop's first."""
    steps = np.linspace(0.0, 1.0, OFFSETS, endpoint=False)
    ours, theirs = (_in_box(loop.at(steps * loop.length), loop) for loop in (old, new))
    costs = [float(((np.roll(theirs, -k, axis=0) - ours) ** 2).sum()) for k in range(OFFSETS)]
    return float(steps[int(np.argmin(costs))])


def _in_box(points: Floats, loop: Loop) -> Floats:
    """Return points (n, 2) relative to the centre of the box of a loop, scaled by half its longer side."""
    every = loop.curve.points
    low, high = every.min(axis=0), every.max(axis=0)
    return np.asarray((points - 0.5 * (low + high)) / (0.5 * float((high - low).max())))


def _moved_along(mesh: QuadMesh, nodes: Floats, fixed: Bools) -> Floats:
    """Return the new positions of nodes that are not `fixed` (n,), if the others move to `nodes` (n, 2)."""
    old = np.column_stack([mesh.nodes, np.ones(len(mesh.nodes))])
    base = product(old, least_squares(old[fixed], nodes[fixed]))
    moved = _harmonic(mesh, np.where(fixed[:, None], nodes - base, 0.0), fixed)
    return np.asarray((base + moved)[~fixed])


def _harmonic(mesh: QuadMesh, values: Floats, fixed: Bools) -> Floats:
    """Return `values` (n, 2); values that are not `fixed` become the mean over the ends of their edges."""
    number, free = np.cumsum(~fixed) - 1, np.flatnonzero(~fixed)
    inner = ~fixed[mesh.edges]
    first, second = number[mesh.edges[inner.all(axis=1)]].T
    each = np.arange(len(free))
    count = np.bincount(mesh.edges.ravel(), minlength=len(fixed))[free]
    pattern = SparsePattern(len(free), np.concatenate([first, each]), np.concatenate([second, each]))
    right = np.zeros_like(values)
    for here, there in (mesh.edges.T, mesh.edges[:, ::-1].T):
        np.add.at(right, here, values[there] * fixed[there, None])
    values = values.copy()
    values[free] = pattern.factor(np.append(np.full(len(first), -1.0), count)).solve(right[free])
    return values
