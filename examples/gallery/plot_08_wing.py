"""
A wing from two sections
========================

Use this script for the volume around a wing that is given by sections. The tip is closed, and the volume is
marched from the surface to the far field.
"""

import meshonet
from meshonet.geometry.shapes.airfoil.naca import naca

root = meshonet.Section(naca("2412"), chord=1.0, z=0.0)
tip = meshonet.Section(naca("0012"), chord=0.5, z=2.0, x=0.4, twist=-2.0)
grid = meshonet.stack(meshonet.Stack((root, tip)), around=81, span=25, first_cell=1e-3, far_field=10)
meshonet.plot(grid, "wing.png", up="y", seen_from=(-30, 40))

# %%
# A slice through the volume at half span:

meshonet.plot(grid, "slice.png", slice="z=1", metric="max_angle", zoom=(-0.6, 2.0, -0.9, 0.9))
