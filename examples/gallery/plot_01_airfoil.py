"""
An O grid around an airfoil
===========================

Use this script for inviscid flow around an airfoil, or for a first look at a shape. Without further
parameters the grid is made by a conformal map.
"""

import meshonet

grid = meshonet.grid("naca:2412", res=(121, 61))
meshonet.plot(grid, "airfoil.png", zoom=(-0.4, 1.4, -0.6, 0.6))

# %%
# Measure the quality of the grid. If a grid has folded cells, ``meshonet.grid`` raises an error.

quality = grid.quality()
print(f"folded cells: {quality.folded}")
print(f"largest angle: {quality['max_angle'].max:.1f} degrees")
print(f"smallest scaled Jacobian: {quality['scaled_jacobian'].min:.3f}")
