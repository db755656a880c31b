"""
The passage of a blade row
==========================

Use this script for a rotor or a stator. The grid is made from profiles of one blade, hub and shroud. The
guide to blade rows describes files of profiles.
"""

import numpy as np

import meshonet

around = np.linspace(0.0, 2.0 * np.pi, 160, endpoint=False)
along = 0.5 * np.cos(around)
section = np.stack([along, 0.035 * np.sin(around) + 0.05 * (1.0 - 4.0 * along**2)], axis=1)


def profile(radius, chord, stagger):
    """Points x, y, z of the section on a cylinder about the x axis."""
    c, s = np.cos(np.radians(stagger)), np.sin(np.radians(stagger))
    x, arc = chord * (section @ [[c, s], [-s, c]]).T
    return np.stack([x, radius * np.sin(arc / radius), radius * np.cos(arc / radius)], axis=1)


rotor = meshonet.Row(
    profiles=[profile(2.0, 0.5, 30), profile(2.5, 0.5, 42), profile(3.0, 0.48, 52)],
    hub=[[-0.7, 2.0], [1.0, 2.1]],
    shroud=[[-0.7, 3.0], [1.0, 2.95]],
    blades=31,
    tip_gap=0.02,
)
passage = meshonet.stack(rotor, cells=60_000, first_cell=2e-3)
meshonet.plot(passage, "row.png")

# %%
# Sections from blade to blade: near the hub, at half span, and in the gap:

meshonet.plot(passage, "spans.png", span=(0.05, 0.5, 0.99))

# %%
# The meridional channel:

meshonet.plot(passage, "channel.png", meridional=True)
