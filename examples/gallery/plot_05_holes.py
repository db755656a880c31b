"""
A plate with holes
==================

Use this script for domains that need several blocks. The domain is split into blocks with matching nodes, and
all blocks are smoothed together. Thick lines in the picture are the sides of blocks.
"""

import numpy as np

import meshonet

turn = np.linspace(0.0, 2.0 * np.pi, 96, endpoint=False)
circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
plate = np.array([[-2, -1], [2, -1], [2, 1], [-2, 1]], dtype=float)
outlines = [plate, 0.4 * circle + [-0.9, 0.0], 0.3 * circle + [0.9, 0.1]]
names = [["floor", "outlet", "ceiling", "inlet"], "left hole", "right hole"]
domain = meshonet.Domain.of_polygons(outlines, "plate", names)

grid = meshonet.solve_pde(domain, cells=2500)
meshonet.plot(grid, "plate.png")
print(len(grid.blocks), "blocks,", len(grid.connections), "interfaces")
print("patches:", ", ".join(sorted({patch.name for patch in grid.patches})))

# %%
# The same with layers at the walls; the first-cell height is exact:

layers = meshonet.solve_pde(domain, cells=6000, first_cell=2e-3)
meshonet.plot(layers, "layers.png", metric="aspect_ratio", zoom=(-1.5, -0.3, -0.6, 0.6))
