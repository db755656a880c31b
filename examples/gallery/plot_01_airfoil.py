"""
An O grid around an airfoil
===========================

Use this for inviscid flow around an airfoil, or for a first look at its shape. Without further parameters the
grid is made by a conformal map.
"""

import meshonet

grid = meshonet.grid("naca:2412", res=(121, 61))
meshonet.plot(grid, "airfoil.png", zoom=(-0.4, 1.4, -0.6, 0.6))

# %%
# Every grid measures itself. No folded cell is returned without a word: ``grid`` raises an error instead.

quality = grid.quality()
print(f"folded cells: {quality.folded}")
print(f"largest angle: {quality['max_angle'].max:.1f} degrees")
print(f"smallest scaled Jacobian: {quality['scaled_jacobian'].min:.3f}")
