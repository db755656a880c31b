"""Dimensions of an aircraft and of its grid, which reveal a wrong unit or file."""

from dataclasses import dataclass
from typing import ClassVar

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.fin import Fin


@dataclass(frozen=True)
class AircraftDimensions:
    """Dimensions of an aircraft and of its grid, in the unit of its file."""

    # length, width, height: extents of the body
    length: float
    width: float
    height: float
    diameter: float  # the larger of width and height
    spans: dict[str, float]  # distance from tip to tip of each wing, by patch
    fins: dict[str, float]  # y of the tip of each fin, by patch
    chord: float  # longest chord of the first wing, the unit of first-cell height and far field
    first_cell: float  # height of the cells at the walls
    far_field: float  # radius of the outer boundary

    kind: ClassVar = "aircraft"

    @property
    def lines(self) -> dict[str, str]:
        """Lines of text for the report, by their heading."""
        spans = "".join(f"; {name} {span:.4g} from tip to tip" for name, span in self.spans.items())
        fins = "".join(f"; {name} up to y={y:.4g}" for name, y in self.fins.items())
        across = f"{self.width:.4g} wide and {self.height:.4g} high"
        if self.width == self.height:
            across = f"{self.diameter:.4g} in diameter"
        body = f"body {self.length:.4g} long and {across}"
        walls = (
            f"first cells {self.first_cell:.4g}, far field {self.far_field:.4g} from the middle of the body"
        )
        return {"aircraft": f"{body}{spans}{fins}; chord {self.chord:.4g}", "lengths": walls}


def aircraft_dimensions(aircraft: Aircraft, first_cell: float, far_field: float) -> AircraftDimensions:
    """Return the dimensions of an aircraft; `first_cell` and `far_field` are in chords of the first wing."""
    chord, body = aircraft.wing.chord, aircraft.body
    wings = [(name, wing) for (name, _), wing in zip(aircraft.patches, aircraft.wings, strict=True)]
    return AircraftDimensions(
        length=body.extent,
        width=body.width,
        height=body.height,
        diameter=max(body.width, body.height),
        spans={name: 2.0 * wing.end[2] for name, wing in wings if not isinstance(wing, Fin)},
        fins={name: wing.end[1] for name, wing in wings if isinstance(wing, Fin)},
        chord=chord,
        first_cell=first_cell * chord,
        far_field=far_field * chord + 0.5 * body.extent,
    )
