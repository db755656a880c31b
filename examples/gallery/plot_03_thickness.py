"""
Quality against thickness
=========================

Use this script as a pattern for studies in which a parameter of the shape varies. Here the largest angle of
the grid is computed for twelve airfoils of different thickness.
"""

import matplotlib.pyplot as plt

import meshonet

thickness = range(6, 30, 2)
worst = [meshonet.grid(f"naca:24{t:02d}", res=(161, 61)).quality()["max_angle"].max for t in thickness]

figure, axes = plt.subplots(figsize=(6, 3.2), layout="constrained")
axes.plot(thickness, worst, "o-")
axes.set_xlabel("thickness, % of the chord")
axes.set_ylabel("largest angle, degrees")
axes.grid(alpha=0.3)
figure.savefig("thickness.png", dpi=150)
plt.close(figure)
