"""The curve through the nodes of a wall, which keeps kinks between straight parts."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.polygon.corners import find_corners
from meshonet.geometry.polygon.straights import find_kinks


def wall_line(nodes: Floats) -> Curve:
    """Return the open curve through `nodes` (n, 2) of a wall, with corners at slight kinks too (`Curve`)."""
    return Curve(nodes, corners=np.concatenate([find_corners(nodes), find_kinks(nodes, few=0)]))
