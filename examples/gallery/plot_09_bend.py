"""
A pipe bend
===========

Use this script to sweep a cross-section along a curve: a pipe, a coil, a duct. A circle is divided into five
blocks; a polar grid would have degenerate cells on the axis.
"""

import numpy as np

import meshonet

turn = np.linspace(0.0, np.pi / 2, 20)
arc = np.stack([2.0 * np.sin(turn), 2.0 - 2.0 * np.cos(turn), 0.0 * turn], axis=1)
path = np.concatenate([[[-2.0, 0.0, 0.0]], arc, [[2.0, 4.0, 0.0]]])

grid = meshonet.sweep("circle:0.5", path, around=40, first_cell=0.01)
meshonet.plot(grid, "bend.png")

# %%
# The inlet:

meshonet.plot(grid, "inlet.png", slice="k=0")
