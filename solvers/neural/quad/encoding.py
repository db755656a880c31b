"""What the quad network sees and what its answer means: the one copy that training and inference share."""

from __future__ import annotations

LATENT = 33
"""Nodes along xi and eta of the grid the network sees."""

SCALE = 0.1
"""What an answer of 1 means, in the normalised domain's unit."""

HEADS = ("winslow", "variational")
"""The grids a network answers with, in order."""

WINSLOW = 0
"""The number of the first of these, which takes a few steps of `picard.approach` after the network."""
