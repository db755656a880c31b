from geometry.arrays import Complexes, Floats
from geometry.lift import Lift

def to_plane(
    psi_x: Floats, phi_y: Floats, lift: Lift, psi_far: float, reach: float, laurent: Complexes
) -> None: ...
