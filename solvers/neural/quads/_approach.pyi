from meshonet.geometry.arrays import Floats

LINE: int

def approach_all(
    planes: Floats,
    turns: Floats,
    harmonic: bool,
    steps: int,
    share: float,
    growth: float,
    xi: tuple[Floats, Floats, Floats],
    eta: tuple[Floats, Floats, Floats],
    around: bool,
    last: Floats,
) -> None: ...
