"""
One duct, four methods
======================

Use this script to compare methods on a shape with four sides. With transfinite interpolation, grid lines have
the shape of the walls, including their kinks. Winslow's equations give smooth grid lines. The control
functions of Thomas and Middlecoff also keep the node spacing of the walls. The variational method gives
angles close to 90 degrees.
"""

import matplotlib.pyplot as plt
import numpy as np

import meshonet
from meshonet.geometry.blocks.boundary import Boundary

x = np.linspace(0.0, 2.0, 41)
bump = 0.45 * np.exp(-40.0 * (x - 0.8) ** 2)
south, north = np.stack([x, bump], axis=1), np.stack([x, 1.0 + 0.3 * bump], axis=1)
y = np.linspace(0.0, 1.0, 21)[:, None]
west, east = (south[k] + y * (north[k] - south[k]) for k in (0, -1))
duct = Boundary(south, north, west, east)

figure, panels = plt.subplots(2, 2, figsize=(9, 5.2), layout="constrained")
for method, axes in zip(("tfi", "winslow", "thomas-middlecoff", "variational"), panels.flat, strict=True):
    grid = meshonet.grid(duct, method=method)
    axes.plot(*np.moveaxis(grid.nodes, -1, 0), color="tab:blue", linewidth=0.6)
    axes.plot(*np.moveaxis(grid.nodes.transpose(1, 0, 2), -1, 0), color="tab:blue", linewidth=0.6)
    axes.set_title(f"{method}: largest angle {grid.quality()['max_angle'].max:.0f} degrees", fontsize=10)
    axes.set_aspect("equal")
    axes.set_axis_off()
