"""A quad model's file: the weights of one network with two answers, and what the file says of itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from meshonet.geometry.arrays import Topology
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.quads.encoding import HEADS, KIND, VERSION
from meshonet.solvers.neural.quads.network import Network, Reals, shapes
from meshonet.solvers.neural.weights import read_tensors

ANSWERS = ("quad-winslow", "quad-general")
"""Names of the two as models, in the order of `encoding.HEADS`."""

ANSWERS_AROUND = ("hole-winslow", "hole-o")
"""The same of a network that makes O grids."""

MOST_LEVELS, MOST_SETS, MOST_BLOCKS = 5, 64, 8  # five levels are 33, 17, 9, 5 and 3 nodes


@dataclass(frozen=True)
class QuadModel:
    """A network for four-sided domains, or for what is between a body and its far field.

    Parameters
    ----------
    name : of the file.
    widths, blocks : of the network.
    weights : its arrays, as `network.shapes` has them.
    topology : of its grids, ``quad`` or ``o``.
    header : what the file says of itself: recipe and held-out figures.
    """

    name: str
    widths: tuple[int, ...]
    blocks: tuple[int, ...]
    weights: Mapping[str, Reals]
    topology: Topology = "quad"
    header: Mapping[str, Any] = field(default_factory=dict)
    _made: dict[str, Network] = field(default_factory=dict, repr=False, compare=False)

    def network(self, dtype: str = "float64") -> Network:
        """Return the network in ``float64`` or ``float32`` arithmetic."""
        if dtype not in self._made:
            self._made[dtype] = Network(self.weights, self.blocks, dtype, around=self.topology == "o")
        return self._made[dtype]


def head_of(model: str, topology: Topology) -> int:
    """Return the number of the answer that `model` names; of the path of a file it is the variational one."""
    known = ANSWERS if topology == "quad" else ANSWERS_AROUND
    return known.index(model) if model in known else len(known) - 1


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
    if header.get("kind") != KIND or header.get("encoding") != VERSION:
        told = f"it holds {str(header.get('kind'))[:60]!r}, encoding {str(header.get('encoding'))[:20]}"
        raise InputError(told, f"use a quad model of encoding {VERSION} or train one", source=source)
    try:
        widths, blocks = sizes(tensors)
    except ValueError as error:
        told = f"its arrays do not fit ({error})"
        raise InputError(told, "use a file made by meshonet train", source=source) from None
    name = header.get("name")
    called = name if isinstance(name, str) and name.isprintable() else path.stem
    topology: Topology = "o" if header.get("topology") == "o" else "quad"
    return QuadModel(called, widths, blocks, tensors, topology, header)


def sizes(tensors: Mapping[str, Reals]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return widths and blocks of the network that `tensors` are of, as their names and shapes tell them.

    Raises
    ------
    ValueError
        of no network.
    """
    if not {"lift", "project"} <= set(tensors):
        raise ValueError("no lift, or no project")
    widths = [tensors["lift"].shape[0] if tensors["lift"].ndim else 0]
    while f"down.{len(widths) - 1}.weight" in tensors and len(widths) <= MOST_LEVELS:
        layer = tensors[f"down.{len(widths) - 1}.weight"]
        widths.append(layer.shape[0] if layer.ndim else 0)
    levels = range(len(widths))
    blocks = [sum(f"before.{level}.{k}.a.weight" in tensors for k in range(MOST_BLOCKS)) for level in levels]
    if not 2 <= len(widths) <= MOST_LEVELS or not 1 <= min(widths) <= max(widths) <= MOST_SETS:
        raise ValueError(f"widths {widths}")
    if {key: array.shape for key, array in tensors.items()} != shapes(widths, blocks, len(HEADS)):
        raise ValueError("names or shapes of arrays")
    return tuple(widths), tuple(blocks)
