"""
Two elements in one far field
=============================

Use this script for an airfoil with a flap, or for several bodies in one far field. ``assemble`` combines the
shapes into one domain.
"""

import numpy as np

import meshonet

main = meshonet.grid("naca:2412", res=(161, 5)).nodes[:-1, 0]
turn = np.radians(-25.0)
matrix = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
flap = 0.3 * main @ matrix + [1.0, -0.05]

grid = meshonet.infer([main, flap], assemble=True, first_cell=1e-3, far_field=10, cells=12000)
meshonet.plot(grid, "elements.png", zoom=(-0.3, 1.6, -0.6, 0.5))
