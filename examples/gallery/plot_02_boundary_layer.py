"""
A boundary layer with y+ 1
==========================

Use this script for viscous flow around an airfoil. The first-cell height is computed from y+, the Reynolds
number and the skin friction of a flat plate. The grid is marched from the wall.
"""

import meshonet

grid = meshonet.grid("naca:2412", res=(250, 90), y_plus=1, reynolds=6e6, topology="c", te="wedge")
meshonet.plot(grid, "trailing-edge.png", zoom=(0.9, 1.1, -0.08, 0.08))

# %%
# The whole grid, coloured by the ratio of the areas of neighbouring cells:

meshonet.plot(grid, "c-grid.png", metric="area_ratio", zoom=(-1.0, 3.0, -1.2, 1.2), every=2)

# %%
# A profile checks the grid against the limits of a flow solver:

for result in meshonet.quality(grid, profile="openfoam").profile.results:
    print(f"{result.check.figure:20} {result.value:10.4g}  {result.verdict}")
