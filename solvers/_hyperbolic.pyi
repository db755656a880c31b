from meshonet.geometry.arrays import Floats

def scratch_size(n: int) -> int: ...
def march(
    x: Floats,
    y: Floats,
    steps: Floats,
    dissipation: float,
    even: float,
    tolerated: float,
    bend: float,
    implicit: float,
    volume: float,
    sweeps: int,
    rise: int,
    scratch: Floats,
    ends: Floats | None = None,
    widening: Floats | None = None,
) -> None: ...
