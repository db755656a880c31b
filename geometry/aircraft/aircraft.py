"""A body with a wing, half of it: what the grid of an aircraft is made from."""

from __future__ import annotations

from dataclasses import dataclass

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.stack import Stack


@dataclass(frozen=True, eq=False)
class Aircraft:
    """The half z >= 0 of a body of revolution and a wing that begins inside of it.

    Parameters
    ----------
    body : Body
        The fuselage.
    wing : Stack
        Sections from the inside of the body to the tip.
    name : str, optional
        Of the aircraft.

    Raises
    ------
    InputError
        A stack that is no wing.
    """

    body: Body
    wing: Stack
    name: str = "aircraft"

    def __post_init__(self) -> None:
        if self.wing.kind != "wing" or self.wing.tip == "open":
            raise InputError("a wing of an aircraft has a tip", "make it round or flat", place="tip")
