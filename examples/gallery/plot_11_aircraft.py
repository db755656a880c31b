"""
A fuselage with wing and tail plane
===================================

Use this script for the volume around a body of revolution with wings. Each wing begins inside the body. The
program computes the line in which wing and body meet, and blocks match there.
"""

import meshonet
from meshonet import Section, Stack
from meshonet.geometry.shapes.airfoil.naca import naca

body = meshonet.Body([[0, 0], [0.1, 0.26], [0.8, 0.57], [3, 0.6], [7, 0.6], [9, 0.45], [10.5, 0.16], [11, 0]])
wing = Stack((Section(naca("2415"), 2.2, 0.0, x=3.6, y=-0.2), Section(naca("2412"), 0.9, 6.0, x=6.3, y=0.2)))
tail = Stack((Section(naca("0010"), 1.1, 0.0, x=8.9), Section(naca("0010"), 0.6, 2.2, x=9.9)), name="tail")
jet = meshonet.Aircraft(body, wing, others=(tail,))
grid = meshonet.stack(jet, around=49, span=9, first_cell=5e-3, growth=1.35, far_field=8)
meshonet.plot(grid, "jet.png", up="y", seen_from=(-40, 25))

# %%
# Each wing is a wall with its own name, for boundary conditions and forces:

print(sorted({patch.name for patch in grid.patches}))
