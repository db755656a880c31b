"""The key sections of a row, from the middle to hub and casing in parallel."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import combinations

import numpy as np

from meshonet.geometry.elementary import exp, log
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.rows.frame import UNITS
from meshonet.geometry.rows.row import Row
from meshonet.geometry.threads import run_in_threads
from meshonet.solvers.cascade.cascade import SHORTEST
from meshonet.solvers.cascade.passage import INLET, NEAR, OUTLET
from meshonet.solvers.rows.behind import even_behind
from meshonet.solvers.rows.gap_blocks import GapEnds, gap_ends
from meshonet.solvers.rows.key_sections import (
    KeySection,
    LayerColumns,
    NextSections,
    SectionPlan,
    beginning,
    planned,
)
from meshonet.solvers.rows.middle_section import coarse_section
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.span_lines import key_heights
from meshonet.solvers.rows.zones import Zone

KEYS = 9  # number of sections that are computed as plane cascades
_PART = 0.6  # of the least room before or behind the blade that is left to blocks
_HALVINGS = 3
_SAME = 0.98  # ratio of thicknesses of layers from which on they are the same
_SOME_MORE = 1.05  # than is missing, since m' is a length over the radius, which changes
LEAN = 12.0
"""Largest lean in degrees of lines along the span at the outlet; beyond it they follow wakes in part."""


@dataclass(frozen=True, eq=False)
class KeyTables:
    """Sections of a blade row at `key_heights` from hub to casing; between them, nodes are interpolated."""

    plan: SectionPlan
    sections: tuple[KeySection, ...]
    gaps: tuple[GapEnds, ...]  # nodes inside the blade's outline at the ends of each gap, the hub's first


def key_tables(row: Row, first: float, growth: float, cells: int, zones: Sequence[Zone] = ()) -> KeyTables:
    """Return grids of some sections of a row, with about `cells` cells each; others are interpolated later.

    `first` is the first-cell height, `growth` the growth ratio of the layers. Zones that are gaps also get
    nodes inside the blade's outline. Raises InputError if there is no room for layers, inlet or outlet, and
    NoValidGridError if cells are folded.
    """
    planes, coarse = _planes(row, first, growth)
    gaps = row.hub_gap > 0.0, row.tip_gap > 0.0
    section, plans = planned(planes, coarse, cells, _longest(planes), _wake(row, planes), gaps)

    def tables(plan: SectionPlan) -> KeyTables:
        inside = [partial(gap_ends, row, plan.places, zone, first, growth) for zone in zones if zone.gap]
        made = partial(_sections, row, plan, planes, section, first, growth)
        sections, *ends = run_in_threads([made, *inside])
        return KeyTables(plan, sections, tuple(ends))

    try:
        return tables(plans[0])
    except NoValidGridError:  # layers are folded where nodes had to move far
        return tables(plans[1])


def _sections(
    row: Row, plan: SectionPlan, planes: Sequence[SectionPlane], section: KeySection, first: float,
    growth: float,
) -> tuple[KeySection, ...]:  # fmt: skip
    """Return all sections for a plan, from the first middle one."""
    half = KEYS // 2
    begun = beginning(plan, planes, section)

    def chain(following: NextSections, others: Sequence[int]) -> list[KeySection]:
        sections = [begun.middle]
        for k in others:
            section = _reached(following, sections[-1], planes[k], plane_at, _HALVINGS, begun.columns[k])
            sections.append(section)
        return sections[1:]

    def plane_at(height: float) -> SectionPlane:
        return SectionPlane.of(row, height, first, growth)

    ways = range(half - 1, -1, -1), range(half + 1, KEYS)
    below, above = run_in_threads(list(map(partial, (chain, chain), begun.following, ways)))
    return even_behind((*below[::-1], begun.middle, *above), plan.columns)


def _planes(row: Row, first: float, growth: float) -> tuple[list[SectionPlane], Layout | None]:
    """Return the key sections, and the coarse blocks of the middle one, if known yet."""

    def plane_at(height: float, share: float = 1.0) -> SectionPlane:
        plane = SectionPlane.of(row, height, first, growth, share)
        with _of_section(height):
            _ = plane.cascade.reach  # marches the layers
        return plane

    def begun(height: float) -> tuple[SectionPlane, Layout | None]:
        middle = plane_at(height)
        plane = middle.ending((NEAR, NEAR), middle.thickest)
        try:
            return plane, coarse_section(plane)
        except (InputError, NoValidGridError):  # once the others are known it is clear why
            return plane, None

    half, heights = KEYS // 2, key_heights(KEYS).tolist()
    others = [partial(plane_at, height) for k, height in enumerate(heights) if k != half]
    (plane, coarse), *made = run_in_threads([partial(begun, heights[half]), *others])
    planes = [*made[:half], plane, *made[half:]]
    thinner = _even_shares(planes)
    again = run_in_threads([partial(plane_at, planes[k].height, share) for k, share in thinner.items()])
    for k, own in zip(thinner, again, strict=True):
        planes[k] = own
    if half in thinner:
        plane, coarse = planes[half].ending((NEAR, NEAR), planes[half].thickest), None
        planes[half] = plane
    _check_room(row, planes)
    near = tuple(min(NEAR, _PART * min(plane.room[k] for plane in planes)) for k in (0, 1))
    if near != plane.cascade.near:
        planes[half], coarse = plane.ending(near, plane.thickest), None
    return planes, coarse


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


def _longest(planes: Sequence[SectionPlane]) -> dict[int, float]:
    """Return the largest lengths of the rows to inlet and outlet, by loop."""
    near = planes[len(planes) // 2].cascade.near
    rows = [[max(room - part, 0.0) for room, part in zip(plane.room, near, strict=True)] for plane in planes]
    pitch = planes[0].cascade.pitch[1]
    return {number: pitch * max(row[k] for row in rows) for k, number in enumerate((INLET, OUTLET))}


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
