from geometry.arrays import Floats

WIDTH: int

def approach_all(
    planes: Floats,
    turns: Floats,
    harmonic: bool,
    steps: int,
    share: float,
    growth: float,
    left: Floats,
    slow: Floats,
    right: Floats,
    fast: Floats,
    around: bool,
    last: Floats,
) -> None: ...
