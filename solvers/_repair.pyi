from meshonet.geometry.arrays import Floats

def energy(
    x: Floats, y: Floats, width: Floats, height: Floats, periodic: bool, shape: float, epsilon: float
) -> tuple[float, Floats, Floats, float]: ...
def minimise(
    x: Floats,
    y: Floats,
    width: Floats,
    height: Floats,
    periodic: bool,
    shape: float,
    epsilon: float,
    most: int,
    still: float,
    until_valid: float = 0.0,
) -> tuple[int, float, float]: ...
