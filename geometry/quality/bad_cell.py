"""A folded cell, as errors and reports name it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class BadCell:
    """A folded cell: the indices of its lower-left node, its centre and, in a multi-block grid, its block.

    k is None for grids of surfaces and of the plane, z is None for grids of the plane.
    """

    i: int
    j: int
    x: float
    y: float
    block: int | None = None
    k: int | None = None
    z: float | None = None

    @property
    def indices(self) -> str:
        """``block=2, i=3, j=4, k=5``, without those that are None."""
        places = {"block": self.block, "i": self.i, "j": self.j, "k": self.k}
        return ", ".join(f"{name}={value}" for name, value in places.items() if value is not None)

    @property
    def centre(self) -> str:
        """``x=0.1, y=0.2, z=0.3``, without those that are None."""
        places = {"x": self.x, "y": self.y, "z": self.z}
        return ", ".join(f"{name}={value:.6g}" for name, value in places.items() if value is not None)

    def __str__(self) -> str:
        return f"{self.indices}, {self.centre}"
