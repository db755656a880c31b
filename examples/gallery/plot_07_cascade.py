"""
The passage of a cascade
========================

Use this script for a plane row of blades. The nodes of the periodic sides match, so a flow solver needs no
interpolation there.
"""

import numpy as np

import meshonet

section = meshonet.grid("naca:4412", res=(161, 5)).nodes[:-1, 0]
turn = np.radians(30.0)
blade = section @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])

passage = meshonet.infer(blade, pitch=(0.0, 0.8), first_cell=1e-3, cells=8000)
meshonet.plot(passage, "passage.png", zoom=(-0.9, 1.9, -0.7, 1.5))
