from collections.abc import Callable
from typing import TypeAlias

from meshonet.geometry.arrays import Floats

def workspace(ni: int, nj: int) -> int: ...
def energy(
    z: Floats,
    aspect: float,
    shape: float,
    smoothness: float,
    epsilon: float,
    periodic: bool,
    relief: Floats | None,
    gradient: Floats,
    work: Floats,
) -> tuple[float, float]: ...

class Waves:
    def __init__(self, matrix: Floats) -> None: ...

Modes: TypeAlias = tuple[Waves, Waves]

def newton(z: Floats, aspect: float, shape: float, smoothness: float, most: int, won: float = 0.0) -> int: ...

class Stiffness:
    usable: bool
    def __init__(self, z: Floats, aspect: float, shape: float, smoothness: float) -> None: ...

class Minimiser:
    def __init__(
        self, ni: int, nj: int, periodic: bool, rows: Modes, columns: Modes, scale: Floats, rest: float
    ) -> None: ...
    def steer(self, stiffness: Stiffness, along: Floats, across: Floats) -> None: ...
    def run(
        self,
        z: Floats,
        aspect: float,
        shape: float,
        smoothness: float,
        epsilon: float,
        relief: Floats | None,
        still: float,
        reach: float,
        most: int,
        told: Callable[[int, float, float], None] | None = None,
    ) -> tuple[float, float, int]: ...
