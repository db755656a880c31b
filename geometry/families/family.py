"""What a family is, and the list of them."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass

from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError

FAMILIES = ("arch", "hexagon", "wrench", "semicircle", "airfoil", "hole")
"""Names of the families, each a module of this folder that ends in its `FAMILY`."""


@dataclass(frozen=True)
class Family:
    """A shape that one number varies.

    Parameters
    ----------
    name : of the family.
    parameter : what the number is, with its unit.
    low, high : the range it is drawn from when none is given.
    least, most : outside these there is no such shape.
    topology : of the boundaries.
    make : parameter, ni, nj to a boundary.
    to_low : extrapolation goes from high values of the parameter to low ones.
    """

    name: str
    parameter: str
    low: float
    high: float
    least: float
    most: float
    topology: Topology
    make: Callable[[float, int, int], Boundary]
    to_low: bool = False

    def boundary(self, parameter: float, ni: int, nj: int) -> Boundary:
        """Return the member at `parameter` with ni by nj nodes, called after both.

        Raises InputError: the parameter is out of `least` to `most`, or the nodes are too few for the
        corners.
        """
        if not self.least <= parameter <= self.most:
            raise InputError(
                f"{self.name} with {self.parameter} {parameter:g}", f"use {self.least:g} to {self.most:g}"
            )
        return self.make(parameter, ni, nj)


def family(name: str) -> Family:
    """Return the family of a name.

    Raises InputError: no such family.

    >>> family("arch").boundary(0.25, 41, 21).north[20].tolist()
    [0.5, 1.25]
    """
    if name not in FAMILIES:
        raise InputError(f"family {name!r} is not known", "use one of " + ", ".join(FAMILIES))
    member: Family = importlib.import_module(f"meshonet.geometry.families.{name}").FAMILY
    return member
