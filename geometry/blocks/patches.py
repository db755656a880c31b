"""Named stretches of a boundary: what flow solvers call patches, markers or boundary conditions."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from meshonet.geometry.arrays import SIDES, Side, Topology
from meshonet.geometry.blocks.block import PLACES, Range, face_counts, sides_of
from meshonet.geometry.errors import InputError

Kind: TypeAlias = Literal[
    "wall", "farfield", "inlet", "outlet", "symmetry", "wedge", "periodic", "interface", "other"
]

_SIGNS: tuple[tuple[Kind, str], ...] = (
    ("farfield", "far"), ("farfield", "freestream"),
    ("inlet", "inlet"), ("inlet", "inflow"),
    ("outlet", "outlet"), ("outlet", "outflow"),
    ("symmetry", "symm"),
    ("wedge", "wedge"),
    ("wall", "wall"), ("wall", "airfoil"), ("wall", "body"), ("wall", "surface"), ("wall", "blade"),
    ("periodic", "periodic"),
    ("interface", "interface"), ("interface", "wake"),
)  # fmt: skip
"""Kinds of boundary with the words that mark them in names of patches; the first kind that matches counts."""


def kind_of(name: str, otherwise: Kind = "other") -> Kind:
    """Return the kind of boundary that the name of a patch suggests, or `otherwise` if it suggests none.

    >>> kind_of("lower wall"), kind_of("slot 3")
    ('wall', 'other')
    """
    low = name.lower()
    for kind, sign in _SIGNS:
        if sign in low:
            return kind
    return otherwise


def may_be_wall(name: str, kind: Kind = "other") -> bool:
    """Return whether a patch may be a wall with layers, judged by its kind and its name.

    >>> [may_be_wall(name) for name in ("wall", "ceiling", "inlet", "axis")]
    [True, True, False, False]
    """
    kind = kind_of(name) if kind == "other" else kind
    return kind == "wall" or (kind == "other" and "axis" not in name.lower())


@dataclass(frozen=True)
class Patch:
    """A named part of a side of a block: nodes `start` to `stop`, both included.

    Nodes are counted along i on south and north, along j on west and east. On sides of volumes, they are
    counted along the side's first direction; `across` is the first and the last node along its second
    direction, or None for all nodes. The default kind of boundary is derived from the name.
    """

    name: str
    side: Side
    start: int
    stop: int
    across: tuple[int, int] | None = field(default=None, repr=False)
    block: int = field(default=0, repr=False)
    kind: Kind = field(default="other", repr=False)

    def __post_init__(self) -> None:
        if self.kind == "other":
            object.__setattr__(self, "kind", kind_of(self.name))

    @property
    def place(self) -> tuple[int, int]:
        """The index that is constant on the side (0 is i, 1 j, 2 k), and its value: 0, or -1 for the last."""
        return PLACES[self.side]

    @property
    def may_be_wall(self) -> bool:
        """Whether the patch may be a wall, judged by its kind and its name."""
        return may_be_wall(self.name, self.kind)

    def range(self, counts: tuple[int, ...]) -> Range:
        """Return the first and last node index along each direction; `counts` are the side's node counts."""
        along: Range = ((self.start, self.stop),)
        return along if len(counts) == 1 else (*along, self.across or (0, counts[1] - 1))


def default_patches(topology: Topology, ni: int, nj: int, wake: int = 0) -> tuple[Patch, ...]:
    """Return the default patches of a block of `topology`.

    A ``quad`` block has its four sides as patches. An ``o`` block has a wall and a far field; west and east
    are its seam. A ``c`` block has a wall between two stretches of `wake` cells, and a far field around them.
    """
    i, j = ni - 1, nj - 1
    if topology == "quad":
        return tuple(Patch(side, side, 0, i if side in ("south", "north") else j) for side in SIDES)
    far = Patch("farfield", "north", 0, i)
    if topology == "o":
        return Patch("wall", "south", 0, i), far
    return (
        Patch("wake", "south", 0, wake),
        Patch("wall", "south", wake, i - wake),
        Patch("wake", "south", i - wake, i),
        far,
        Patch("farfield", "east", 0, j),
        Patch("farfield", "west", 0, j),
    )


def check_patches(patches: Iterable[Patch], counts: Sequence[tuple[int, ...]]) -> None:
    """Raise InputError if a patch has no name, an unknown block or side, or exceeds its side.

    `counts` are the numbers of nodes of each block along its directions.
    """
    for patch in patches:
        what, exists = f"patch {patch.name!r}", 0 <= patch.block < len(counts)
        sides = sides_of(counts[patch.block]) if exists else SIDES
        if not patch.name or patch.side not in sides:
            remedy = "name it and use " + "/".join(sides)
            raise InputError(f"{what} on side {patch.side!r} is not usable", remedy)
        if not exists:
            raise InputError(f"{what} is on block {patch.block} of {len(counts)}", "count blocks from 0")
        side = face_counts(counts[patch.block], patch.side)
        for (start, stop), count in zip(patch.range(side), side, strict=True):
            if not 0 <= start < stop < count:
                remedy = "keep it inside the side and at least one cell long"
                raise InputError(
                    f"{what} runs from node {start} to {stop} of a side with {count} nodes", remedy
                )
