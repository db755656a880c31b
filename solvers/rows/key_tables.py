"""The key sections of a row, from the middle to hub and casing in parallel."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import TypeVar

import numpy as np

from meshonet.geometry.elementary import exp, log
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.rows.frame import UNITS
from meshonet.geometry.rows.row import Row
from meshonet.geometry.threads import run_in_threads, thread_count
from meshonet.solvers.cascade.cascade import SHORTEST
from meshonet.solvers.cascade.passage import NEAR
from meshonet.solvers.energy.quad_problem import Problem
from meshonet.solvers.rows.behind import even_behind
from meshonet.solvers.rows.key_sections import (
    Beginning,
    KeySection,
    LayerColumns,
    NextSections,
    SectionPlan,
    beginning,
    placed,
)
from meshonet.solvers.rows.middle_section import Shared, coarse_section, middle_section
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.span_lines import key_heights

Made = TypeVar("Made")

KEYS = 9
"""Number of sections that are computed as plane cascades."""
_HALVINGS = 3
_SAME = 0.98  # ratio of thicknesses of layers from which on they are the same
_SOME_MORE = 1.05  # than is missing, since m' is a length over the radius, which changes
LEAN = 12.0
"""Largest lean in degrees of lines along the span at the outlet; beyond it they follow wakes in part."""


@dataclass(frozen=True, eq=False)
class KeyTables:
    """Key sections at `key_heights`, from hub to casing, and the beginning from which they are made."""

    begun: Beginning
    sections: tuple[KeySection, ...]

    @property
    def plan(self) -> SectionPlan:
        """Data that all sections share."""
        return self.begun.plan


def begun_sections(row: Row, first: float, growth: float, cells: int) -> Beginning:
    """Return the beginning of the key sections of a row, with about `cells` cells each.

    `first` and `growth` are first-cell height and growth ratio of the layers. Raises InputError: no room for
    layers, inlet or outlet. Raises NoValidGridError: cells are folded.
    """

    def plane_at(height: float) -> SectionPlane:
        return SectionPlane.of(row, height, first, growth)

    planes, whole = _planes(row, first, growth, cells)
    gaps = row.hub_gap > 0.0, row.tip_gap > 0.0
    return beginning(planes, plane_at, whole, _wake(row, planes), gaps)


def key_tables(begun: Beginning) -> KeyTables:
    """Return the key sections of a row. Raises NoValidGridError: cells are folded."""
    try:
        middle = placed(begun)
    except NoValidGridError:  # layers are folded where nodes had to move far
        begun = begun.without_limit()
        middle = placed(begun)
    half = KEYS // 2

    def chain(problem: Problem, others: Sequence[int]) -> list[KeySection]:
        following, sections = NextSections(begun.plan, problem), [middle]
        for k in others:
            plane, columns = begun.planes[k], begun.columns[k]
            sections.append(_reached(following, sections[-1], plane, begun.plane_at, _HALVINGS, columns))
        return sections[1:]

    ways = range(half - 1, -1, -1), range(half + 1, KEYS)
    below, above = run_in_threads(list(map(partial, (chain, chain), begun.problems, ways)))
    return KeyTables(begun, even_behind((*below[::-1], middle, *above), begun.plan.columns))


def _planes(row: Row, first: float, growth: float, cells: int) -> tuple[list[SectionPlane], Layout]:
    """Return the planes of the key sections, and the middle section with about `cells` cells.

    What the middle section needs to know of all sections is mostly the same for those at hub, casing and in
    the middle. With several threads it is made for these three while the other planes are computed, and made
    again if these need more.
    """

    def plane_at(height: float, share: float = 1.0) -> SectionPlane:
        plane = SectionPlane.of(row, height, first, growth, share)
        with _of_section(height):
            _ = plane.cascade.reach, plane.across  # marches the layers
        return plane

    def begun() -> tuple[SectionPlane, Layout | None]:
        plane = _ending(plane_at(heights[half]), (NEAR, NEAR))
        return plane, unless_refused(partial(coarse_section, plane))

    def ahead() -> tuple[
        SectionPlane, SectionPlane, SectionPlane, Layout | None, Shared | None, Layout | None
    ]:
        ends = [partial(plane_at, heights[k]) for k in (0, -1)]
        (plane, coarse), hub, casing = run_in_threads([begun, *ends])
        known = unless_refused(partial(Shared.of, (hub, plane, casing)))
        if alone or coarse is None or known is None or known.near != plane.cascade.near:
            return plane, hub, casing, coarse, known, None
        whole = unless_refused(partial(middle_section, plane, cells, known, coarse))
        return plane, hub, casing, coarse, known, whole

    alone, half, heights = thread_count() < 2, KEYS // 2, key_heights(KEYS).tolist()
    others = [partial(plane_at, heights[k]) for k in range(1, KEYS - 1) if k != half]
    (plane, hub, casing, coarse, known, whole), *made = run_in_threads([ahead, *others])
    planes = [hub, *made[: half - 1], plane, *made[half - 1 :], casing]
    thinner = _even_shares(planes)
    again = run_in_threads([partial(plane_at, planes[k].height, share) for k, share in thinner.items()])
    for k, own in zip(thinner, again, strict=True):
        planes[k] = own
    if half in thinner:
        planes[half], coarse, whole = _ending(planes[half], (NEAR, NEAR)), None, None
    _check_room(row, planes)
    shared = Shared.of(planes)
    if shared.near != planes[half].cascade.near:
        planes[half], coarse = _ending(planes[half], shared.near), None
    if whole is None or shared != known:
        whole = middle_section(planes[half], cells, shared, coarse)
    return planes, whole


def _ending(plane: SectionPlane, near: tuple[float, float]) -> SectionPlane:
    """Return the middle section with straight rows from `near` pitches before and behind the blade."""
    return plane.ending(near, plane.thickest)


def unless_refused(make: Callable[[], Made]) -> Made | None:
    """Return the result of `make`, or None if it fails: once everything else is known, it is clear why."""
    try:
        return make()
    except (InputError, NoValidGridError):
        return None


def _even_shares(planes: Sequence[SectionPlane]) -> dict[int, float]:
    """Return smaller fractions of the thickness of layers by section, with logarithms convex in the height.

    Layers that fold are made thinner section by section, and polynomials would overshoot beside these.
    """
    kept = np.array([plane.cascade.kept for plane in planes])
    x, logs = np.array([plane.height for plane in planes]), log(kept)
    ends = (list(pair) for pair in combinations(range(len(x)), 2))
    below = [np.interp(x, x[pair], logs[pair], left=np.inf, right=np.inf) for pair in ends]
    shares = exp(np.min(below, axis=0))
    return {int(k): float(shares[k]) for k in np.flatnonzero(shares < _SAME * kept)}


def _check_room(row: Row, planes: Sequence[SectionPlane]) -> None:
    """Raise InputError if hub and shroud begin or end too close to the blades."""
    least = SHORTEST * planes[0].cascade.pitch[1]
    heights = np.array([plane.height for plane in planes])
    words = ("begin", "before", "upstream"), ("end", "behind", "downstream")
    for k, (end, side, way) in enumerate(words):
        radii = row.channel.at(np.full(len(planes), float(k)), heights)[:, 1]
        missing = (least - np.array([plane.cascade.reach[k] for plane in planes])) * radii
        worst = int(missing.argmax())
        if missing[worst] > 0.0:
            more, unit = _SOME_MORE * float(missing[worst]) / UNITS.get(row.unit, 1.0), row.unit
            section = f"at {100.0 * heights[worst]:.3g} % of the span"
            problem = f"hub and shroud {end} so near to the blades that {section} no blocks fit {side} them"
            remedy = f"let both {end} {more:.2g}{unit and ' '}{unit} further {way}"
            raise InputError(problem, remedy if unit else f"{remedy}, in the unit of the profiles")


@contextmanager
def _of_section(height: float) -> Iterator[None]:
    """Within the ``with`` block, add the section to the place of input errors."""
    try:
        yield
    except InputError as error:
        if error.place:
            error.place = f"section at {100.0 * height:.3g} % of the span, in m' and theta: {error.place}"
        raise


def _wake(row: Row, planes: Sequence[SectionPlane]) -> tuple[float, float]:
    """Return theta of wakes at the outlet from the trailing edge, at half the height, and its slope.

    They fit the wakes of all sections, with a lean of at most `LEAN` degrees in space.
    """
    off = np.array([plane.height - 0.5 for plane in planes])
    aside = np.array([plane.wake for plane in planes])
    edges = np.array([plane.edges[1, 1] for plane in planes])
    mean = float(aside.mean())
    slope, lean = (float((off * (each - each.mean())).sum() / (off**2).sum()) for each in (aside, edges))
    radius = float(row.channel.at(np.array([1.0]), np.array([0.5]))[0, 1])
    most = math.tan(math.radians(LEAN)) * row.channel.span / radius
    return mean, min(max(lean + slope, -most), most) - lean


def _reached(
    following: NextSections, section: KeySection, plane: SectionPlane,
    plane_at: Callable[[float], SectionPlane], halvings: int, columns: LayerColumns | None = None,
) -> KeySection:  # fmt: skip
    """Return a section from another; if cells stay folded, by way of the section half-way."""
    try:
        return following.of(section, plane, columns)
    except NoValidGridError:
        if not halvings:
            raise
    between = plane_at(0.5 * (section.plane.height + plane.height))
    half = _reached(following, section, between, plane_at, halvings - 1)
    return _reached(following, half, plane, plane_at, halvings - 1)
