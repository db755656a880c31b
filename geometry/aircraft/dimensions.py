"""Dimensions of an aircraft and of its grid by which a reader recognises both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshonet.geometry.aircraft.aircraft import Aircraft


@dataclass(frozen=True)
class AircraftDimensions:
    """Dimensions of an aircraft and of its grid, in the unit of its file.

    Parameters
    ----------
    length, diameter : of the body, along and across its axis.
    spans : distance from tip to tip of each wing, both halves together, by the name of its patch.
    chord : the longest of the first wing, in which heights of cells and distances are given.
    first_cell : height of the cells at the walls.
    far_field : radius of the outer boundary.
    """

    length: float
    diameter: float
    spans: dict[str, float]
    chord: float
    first_cell: float
    far_field: float

    kind: ClassVar = "aircraft"

    @property
    def lines(self) -> dict[str, str]:
        """Lines of text by their headings."""
        spans = "".join(f"; {name} {span:.4g} from tip to tip" for name, span in self.spans.items())
        body = f"body {self.length:.4g} long and {self.diameter:.4g} in diameter"
        walls = (
            f"first cells {self.first_cell:.4g}, far field {self.far_field:.4g} from the middle of the body"
        )
        return {"aircraft": f"{body}{spans}; chord {self.chord:.4g}", "lengths": walls}


def aircraft_dimensions(aircraft: Aircraft, first_cell: float, far_field: float) -> AircraftDimensions:
    """Return the dimensions of an aircraft and of its grid, both lengths in longest chords of the wing."""
    chord, radii = aircraft.wing.chord, aircraft.body.meridian[:, 1]
    names = (name for name, _ in aircraft.patches)
    return AircraftDimensions(
        length=aircraft.body.extent,
        diameter=2.0 * float(np.max(radii)),
        spans={name: 2.0 * wing.end[2] for name, wing in zip(names, aircraft.wings, strict=True)},
        chord=chord,
        first_cell=first_cell * chord,
        far_field=far_field * chord + 0.5 * aircraft.body.extent,
    )
