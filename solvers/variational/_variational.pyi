from geometry.arrays import Floats

def workspace(ni: int, nj: int) -> int: ...
def energy(
    z: Floats,
    aspect: float,
    shape: float,
    smoothness: float,
    epsilon: float,
    gradient: Floats,
    work: Floats,
) -> tuple[float, float]: ...
