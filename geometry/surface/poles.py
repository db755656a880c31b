"""Poles of a surface, sides of patches that are a single point, replaced by core patches."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, extent_of, norms
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.surface.merge import TOLERANCE
from meshonet.geometry.surface.pole_core import core_of

TURNS = {"west": 1, "north": 2, "east": -1, "south": 0}
"""Number of quarter turns of a patch's indices (`numpy.rot90`) that make a side the south side, j = 0."""
_LEAST = {1: 2, 2: 4, 4: 8}  # smallest number of cells around a pole, by its right angles


@dataclass(frozen=True)
class _FanPatch:
    """A patch turned (and mirrored): pole at j = 0, i as in the fan; `both`: a pole at its other end too."""

    patch: int
    turns: int
    mirrored: bool
    both: bool

    def turned(self, patches: Sequence[Floats]) -> Floats:
        nodes = np.rot90(patches[self.patch], self.turns, (0, 1))
        return nodes[::-1] if self.mirrored else nodes

    def back(self, nodes: Floats) -> Floats:
        return np.ascontiguousarray(np.rot90(nodes[::-1] if self.mirrored else nodes, -self.turns, (0, 1)))


def without_poles(
    patches: Sequence[Floats], *, replace: bool = True
) -> tuple[list[Floats], list[int], tuple[str, ...]]:
    """Return three results: patches (ni, nj, 3) without poles, for each an index in `patches`, and notes.

    A pole is a side that is a single point. New cells replace those around it. The cells in the middle form a
    new patch, the core, whose index is that of a patch that had the pole. Cores come last. Without `replace`,
    nothing is done. Raises InputError: too few cells around a pole, or an odd number.
    """
    out, owners, notes = list(patches), list(range(len(patches))), []
    while replace and (fan := _next_fan(out)):
        core, note = _replaced(out, fan)
        out.append(core)
        owners.append(owners[fan[0].patch])
        notes.append(note)
    return out, owners, tuple(notes)


def _replaced(patches: list[Floats], fan: list[_FanPatch]) -> tuple[Floats, str]:
    """Return the core in place of a fan's pole, and a note; change its `patches`."""
    turned = [member.turned(patches) for member in fan]
    columns = min(nodes.shape[1] for nodes in turned)
    common = [nodes[:, :columns] for nodes in turned]
    joined = np.concatenate([common[0], *(nodes[1:] for nodes in common[1:])])
    slack = TOLERANCE * extent_of(joined.reshape(-1, 3))
    closed = bool((np.abs(joined[0] - joined[-1]) <= slack).all())
    quarters = 4 if closed else _right_angles(joined)
    cells, place = len(joined) - 1, place_of(joined[0, 0])
    whose = "patch " + ", ".join(str(member.patch) for member in fan)
    if cells < _LEAST[quarters] or (closed and cells % 2):
        problem = f"{cells} cells run around the pole of {whose}, a side that is a single point"
        least = f"{_LEAST[quarters]} or more" + (", an even number," if closed else "")
        raise InputError(problem, f"give {least} or a patch of its own (a core) there", place=place)
    limit = min(
        (nodes.shape[1] - 1) // (2 if member.both else 1) for nodes, member in zip(turned, fan, strict=True)
    )
    if not closed:
        _check_ends(patches, fan, joined, slack)
    core = core_of(joined, quarters, limit)
    start = 0
    for nodes, member in zip(turned, fan, strict=True):
        stop = start + len(nodes)
        patches[member.patch] = member.back(
            np.concatenate([core.rows[:-1, start:stop].swapaxes(0, 1), nodes[:, core.at :]], axis=1)
        )
        start = stop - 1
    a, b = (count - 1 for count in core.nodes.shape[:2])
    return (
        core.nodes,
        f"the pole of {whose} at {place} became a core of {a} x {b} cells, patch {len(patches)}",
    )


def _check_ends(patches: Sequence[Floats], fan: list[_FanPatch], joined: Floats, slack: float) -> None:
    """Raise InputError if an outer curve of an open fan is a seam with another patch."""
    members = {member.patch for member in fan}
    for node in joined[[0, -1], 1]:
        for number, patch in enumerate(patches):
            if number not in members and (np.abs(patch - node) <= slack).all(axis=-1).any():
                whose = ", ".join(map(str, sorted(members)))
                problem = f"the pole of patch {whose} is where a seam with patch {number} ends"
                remedy = "give the patch a side of several cells there, for example beside a core"
                raise InputError(problem, remedy, place=place_of(joined[0, 0]))


def _right_angles(fan: Floats) -> int:
    """Return the angle between first and last curves of an open fan, 1 or 2 right angles."""
    around = np.diff(fan[:, 1], axis=0)[[0, -1]]
    around /= norms(around)[:, None]
    return 2 if float((around[0] * around[1]).sum()) < -0.5 else 1


def _next_fan(patches: Sequence[Floats]) -> list[_FanPatch] | None:
    """Return the patches around one pole, in order and turned alike, or None."""
    slack = TOLERANCE * max(extent_of(patch.reshape(-1, 3)) for patch in patches)
    fans = [member for number, patch in enumerate(patches) for member in _fans(number, patch, slack)]
    if not fans:
        return None
    nodes = [member.turned(patches) for member in fans]
    used, chain = {0}, [fans[0]]
    first, last = nodes[0][0], nodes[0][-1]
    while not _same(first, last, slack):
        # forwards from the last curve of the chain, else backwards from its first
        neighbour: tuple[int, bool, int] | None = None
        for k in (k for k in range(len(fans)) if k not in used):
            for mirrored in (False, True):
                own = nodes[k][::-1] if mirrored else nodes[k]
                if neighbour is None and _same(own[0], last, slack):
                    neighbour, last = (k, mirrored, len(chain)), own[-1]
                elif neighbour is None and _same(own[-1], first, slack):
                    neighbour, first = (k, mirrored, 0), own[0]
        if neighbour is None:
            break
        k, mirrored, at = neighbour
        used.add(k)
        chain.insert(at, _FanPatch(fans[k].patch, fans[k].turns, mirrored, fans[k].both))
    return chain


def _fans(number: int, patch: Floats, slack: float) -> list[_FanPatch]:
    points = {
        name: bool((np.ptp(np.rot90(patch, turns, (0, 1))[:, 0], axis=0) <= slack).all())
        for name, turns in TURNS.items()
    }
    pairs = {"west": "east", "east": "west", "south": "north", "north": "south"}
    return [
        _FanPatch(number, TURNS[name], mirrored=False, both=points[pairs[name]])
        for name, is_pole in points.items()
        if is_pole
    ]


def _same(one: Floats, other: Floats, slack: float) -> bool:
    count = min(len(one), len(other))
    return bool((np.abs(one[:count] - other[:count]) <= slack).all())
