from geometry.arrays import Floats
from geometry.lift import Lift

def to_plane(psi_x: Floats, phi_y: Floats, lift: Lift) -> None: ...
