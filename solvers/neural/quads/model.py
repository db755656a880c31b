"""A quad model's file: the weights of one network with two answers, and what the file says of itself."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from geometry.errors import InputError
from solvers.neural.quads.network import Network, Reals, shapes
from solvers.neural.weights import HEADER, QUADS, read_tensors

ENCODING = 1
"""Of the features and of what the network's answer means."""

ANSWERS = ("quad-winslow", "quad-general")
"""The network's heads: Winslow's grid, and the variational one."""

NODES = 33
"""Nodes along each axis of the grid that the network answers on; that of `ENCODING` 1."""

SCALE = 0.1
"""Displacement that an answer of 1 stands for, in the root of the domain's area."""

MOST_LEVELS, MOST_SETS, MOST_BLOCKS = 5, 64, 8  # five levels are 33, 17, 9, 5 and 3 nodes


@dataclass(frozen=True)
class QuadModel:
    """A network for four-sided domains.

    Parameters
    ----------
    name : of the file.
    blocks : of the network.
    weights : its arrays, as `network.shapes` has them.
    header : what the file says of itself: recipe and held-out figures.
    """

    name: str
    blocks: tuple[int, ...]
    weights: Mapping[str, Reals]
    header: Mapping[str, Any] = field(default_factory=dict)
    _made: dict[str, Network] = field(default_factory=dict, repr=False, compare=False)

    def network(self, dtype: str = "float64") -> Network:
        """Return the network in ``float64`` or ``float32`` arithmetic."""
        if dtype not in self._made:
            self._made[dtype] = Network(self.weights, self.blocks, dtype)
        return self._made[dtype]


@lru_cache(maxsize=4)
def load_quads(path: Path) -> QuadModel:
    """Return the model of a file.

    Raises
    ------
    InputError
        a file of another kind or encoding, or whose arrays are not those of the network it describes.
    """
    header, tensors = read_tensors(path)
    source = str(path)
    if header.get("kind") != QUADS or header.get("encoding") != ENCODING:
        told = f"it holds {str(header.get('kind'))[:60]!r}, encoding {str(header.get('encoding'))[:20]}"
        raise InputError(told, f"use a quad model of encoding {ENCODING} or train one", source=source)
    try:
        widths, blocks = (_counts(header["settings"][key]) for key in ("widths", "blocks"))
        levels = len(widths)
        if not 2 <= levels <= MOST_LEVELS or len(blocks) != levels:
            raise ValueError(f"{levels} levels")
        if not 1 <= min(widths) <= max(widths) <= MOST_SETS or max(blocks) > MOST_BLOCKS:
            raise ValueError(f"widths {widths} or blocks {blocks}")
        wanted = shapes(widths, blocks, len(ANSWERS))
        if {key: array.shape for key, array in tensors.items()} != wanted:
            raise ValueError("other names or shapes of arrays")
    except (KeyError, ValueError, TypeError) as error:
        raise InputError(
            f"its header or arrays do not fit ({str(error)[:80]})",
            "use a file made by meshonet train",
            source=source,
        ) from None
    name = header.get("name")
    called = name if isinstance(name, str) and name.isprintable() else path.stem
    return QuadModel(called, blocks, tensors, header)


def write_quads(
    path: Path,
    weights: Mapping[str, Reals],
    *,
    widths: Sequence[int],
    blocks: Sequence[int],
    name: str,
    recipe: Mapping[str, Any],
    figures: Mapping[str, Any],
) -> None:
    """Write a model file: float32 weights and the header that `load_quads` checks."""
    from safetensors.numpy import save

    header = {
        "kind": QUADS,
        "encoding": ENCODING,
        "name": name,
        "topology": "quad",
        "settings": {"widths": list(widths), "blocks": list(blocks)},
        "recipe": dict(recipe),
        "figures": dict(figures),
    }
    arrays = {key: np.ascontiguousarray(value, dtype=np.float32) for key, value in weights.items()}
    part = path.with_name(path.name + ".part")
    part.write_bytes(save(arrays, metadata={HEADER: json.dumps(header, sort_keys=True)}))
    part.replace(path)


def _counts(value: object) -> tuple[int, ...]:
    if not isinstance(value, list) or not all(type(one) is int and one >= 0 for one in value):
        raise ValueError(f"{value!r:.40} in place of counts")
    return tuple(value)
