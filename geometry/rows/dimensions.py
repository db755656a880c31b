"""Dimensions of a row of blades, and notes on those that are probably wrong."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshonet.geometry.arrays import norms
from meshonet.geometry.rows.frame import UNITS, axis_name
from meshonet.geometry.rows.row import Row

USUAL_GAPS = 0.0002, 0.1
"""Usual range of gaps in spans: 0.005 to 0.03 in compressors and turbines, up to 0.1 in small impellers."""
USUAL_SOLIDITIES = 0.3, 4.0
"""Usual range of the solidity: 0.4 to 2.2 in compressors (NASA SP-36), up to 3.5 in inducers."""
USUAL_RADII = 0.001, 10.0
"""Usual range of casing radii in metres, from micro gas turbines to the largest water turbines."""
_AXIAL = 0.2  # largest relative change of the radius along a blade whose solidity is judged


@dataclass(frozen=True)
class RowDimensions:
    """Dimensions of a row of blades, with lengths in the unit of its files."""

    blades: int  # number of blades
    pitch: float  # angle in degrees from blade to blade
    unit: str  # name of the unit; empty if none was given
    axis: str  # name of the axis from inlet to outlet, such as ``-z``; ``axis`` for another direction
    chord: float  # chord at mid-span
    longest_chord: float  # longest chord, the unit of first-cell heights and Reynolds numbers
    solidity: float  # chord over the distance of neighbouring blades, at mid-span
    span: float  # mean distance from hub to shroud at leading and trailing edge
    # tip_gap, hub_gap: widths of the gaps
    tip_gap: float
    hub_gap: float
    # leading_edge, trailing_edge: ends (x, r) of the edge, by ``hub`` and ``shroud``
    leading_edge: dict[str, tuple[float, float]]
    trailing_edge: dict[str, tuple[float, float]]

    kind: ClassVar = "row"

    @property
    def lines(self) -> dict[str, str]:
        """Lines of text for the report, by their heading."""
        unit = f" {self.unit}" if self.unit else ""
        gaps = "".join(
            f", {name} gap {gap:.4g}{unit} ({100.0 * gap / self.span:.3g} %)"
            for name, gap in (("tip", self.tip_gap), ("hub", self.hub_gap)) if gap
        )  # fmt: skip
        chord = f"chord {self.chord:.4g}{unit} at mid-span, {self.longest_chord:.4g} in the longest profile"
        size = (
            f"{self.blades} blades, {self.pitch:.4g} degrees apart; {chord}; solidity {self.solidity:.3g}; "
            f"span {self.span:.4g}{unit}{gaps or ', no gap'}"
        )
        ends = (self.leading_edge, self.trailing_edge)
        digits = 3 - math.floor(math.log10(self.chord))
        first, last = (
            [f"({', '.join(f'{round(x, digits):g}' for x in each[end])})" for end in ("hub", "shroud")]
            for each in ends
        )
        edges = f"leading {first[0]} at the hub, {first[1]} at the shroud; trailing {last[0]}, {last[1]}"
        return {"row": size, "edges": f"({self.axis}, r){' in' + unit if unit else ''}: {edges}"}


def row_dimensions(row: Row) -> RowDimensions:
    """Return the dimensions of a row of blades."""
    size = UNITS[row.unit] if row.unit else 1.0
    channel, edges = row.channel, np.array([0.0, 0.5])
    heights = channel.foot, 0.5 * (channel.foot + channel.tip), channel.tip
    values = np.stack([row.surface.section(h, edges) for h in heights])
    levels = np.broadcast_to(np.array(heights)[:, None, None], (3, 2, 1))
    points = channel.in_space(np.concatenate([values, levels], axis=-1)) / size
    places = np.stack([points[..., 0], np.hypot(points[..., 1], points[..., 2])], axis=-1)
    chord = float(norms(points[1, 1] - points[1, 0]))
    walls = channel.at(np.broadcast_to(values[1, :, 0], (2, 2)), np.array([[0.0, 0.0], [1.0, 1.0]])) / size
    leading, trailing = (
        {
            name: (float(places[k, edge, 0]), float(places[k, edge, 1]))
            for name, k in (("hub", 0), ("shroud", 2))
        }
        for edge in (0, 1)
    )
    return RowDimensions(
        row.blades, float(np.degrees(row.pitch)), row.unit, axis_name(row.frame), chord, row.chord / size,
        chord / (row.pitch * float(places[1, :, 1].mean())), float(norms(walls[1] - walls[0]).mean()),
        row.tip_gap / size, row.hub_gap / size, leading, trailing,
    )  # fmt: skip


def doubts(dimensions: RowDimensions) -> tuple[str, ...]:
    """Return notes on gaps, numbers of blades and units that are probably wrong."""
    notes, unit = [], dimensions.unit or "the unit of the profiles"
    for name in ("tip_gap", "hub_gap"):
        part = getattr(dimensions, name) / dimensions.span
        low, high = USUAL_GAPS
        if part and not low <= part <= high:
            usual = f"{100.0 * low:g} to {100.0 * high:g} %"
            notes.append(f"{name} is {100.0 * part:.3g} % of the span, usual are {usual}: is it in {unit}?")
    radii = [
        each[1] for ends in (dimensions.leading_edge, dimensions.trailing_edge) for each in ends.values()
    ]
    turned = sum(radii[:2]) - sum(radii[2:])
    axial, (low, high) = abs(turned) < _AXIAL * 0.5 * sum(radii), USUAL_SOLIDITIES
    if axial and not low <= dimensions.solidity <= high:
        what = f"{dimensions.blades} blades have a solidity of {dimensions.solidity:.3g} at mid-span"
        notes.append(f"{what}, usual are {low:g} to {high:g}: is this the number of blades?")
    if dimensions.unit:
        metres = UNITS[dimensions.unit] * max(radii)
        if not USUAL_RADII[0] <= metres <= USUAL_RADII[1]:
            what = f"the blade reaches a radius of {max(radii):.4g} {dimensions.unit}"
            notes.append(f"{what}: if that is not the unit of the files, give unit")
    return tuple(notes)
