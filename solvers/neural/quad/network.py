"""The quad network's forward pass: an equivariant U-Net (Ronneberger et al., MICCAI 2015)."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import pairwise, product
from typing import Any, Generic, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Complexes, Floats, read_only
from meshonet.kernels._native import LayerProgram, activate, convolve, grid_features, upsample
from meshonet.solvers.neural.quad import symmetry
from meshonet.solvers.neural.quad.encoding import FEATURES, HEADS, features, planes_of
from meshonet.solvers.neural.quad.symmetry import ELEMENTS, ORDER, SEEN

Reals: TypeAlias = NDArray[Any]
Field = TypeVar("Field")  # channels on a level: a NumPy array, or a tensor
Shapes: TypeAlias = dict[str, tuple[int, ...]]

CHUNK = 16  # domains per call of a layer: their channels and its weights fit in the cache
MOST_LEVELS, MOST_SETS, MOST_BLOCKS = 5, 64, 8  # limits for files; five levels have 33 to 3 nodes
LINE = 64  # bytes that a row of weights is rounded up to


def shapes(widths: Sequence[int], blocks: Sequence[int], heads: int) -> Shapes:
    """Return the names and shapes of the weights of a network.

    `widths` has for each level, the finest first, the number of channels divided by 8. `blocks` has the
    number of residual blocks of each level. `heads` is the number of displacement fields in the output.
    """
    arrays: Shapes = {"lift": (widths[0], FEATURES), "lift_bias": (widths[0],)}

    def layer(name: str, into: int, out: int, size: int = 3) -> None:
        arrays[f"{name}.weight"], arrays[f"{name}.bias"] = (out, into, ORDER, size, size), (out,)

    for level, (fine, coarse) in enumerate(pairwise(widths)):
        layer(f"down.{level}", fine, coarse)
        layer(f"up.{level}", coarse, fine, 1)
    for level, width in enumerate(widths):
        for part in ("before", "after")[: 1 if level == len(widths) - 1 else 2]:
            for k, half in product(range(blocks[level]), "ab"):
                layer(f"{part}.{level}.{k}.{half}", width, width)
    arrays["project"] = (heads, 2, widths[0])
    return arrays


def sizes(tensors: Mapping[str, Reals]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return `widths` and `blocks` (see `shapes`) of the network that has the weights `tensors`.

    Raises ValueError if they are not the weights of such a network.
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


@lru_cache(maxsize=4)
def rim_factor(m: int, n: int, around: bool) -> Floats:
    """Return the factor (m, n) by which displacements are multiplied; it is 0 on the boundary.

    The factor is the product of d / (d + 2) along xi and along eta, where d is the number of nodes to the
    boundary. With `around` it depends on eta only.
    """
    along, across = (np.minimum(np.arange(k), np.arange(k)[::-1]).astype(np.float64) for k in (m, n))
    rise = np.multiply.outer(np.ones(m) if around else along / (along + 2.0), across / (across + 2.0))
    return read_only(rise)


class UNet(Generic[Field]):
    """Base class that defines the sequence of layers; subclasses define `layer`, `silu` and `finer`."""

    def layer(self, name: str, x: Field, stride: int = 1, add: Field | None = None, room: str = "") -> Field:
        """Return the convolution of `x` with the weights of layer `name`, plus `add`.

        Results of calls with the same `room` may share memory.
        """
        raise NotImplementedError

    def silu(self, x: Field, pad: int = 1) -> Field:
        """Return x / (1 + exp(-x)), padded by `pad` nodes."""
        raise NotImplementedError

    def finer(self, low: Field, skip: Field) -> Field:
        """Interpolate `low` linearly to the finer level, and return its sum with `skip`."""
        raise NotImplementedError

    def through(self, h: Field, blocks: Sequence[int]) -> Field:
        """Return the output for features `h`; `blocks` has the number of residual blocks of each level."""
        h = self.layer("lift", h)
        skips: list[Field] = []
        coarsest = len(blocks) - 1
        for level in range(coarsest):
            h = self._blocks(f"before.{level}", blocks[level], h)
            skips.append(h)
            h = self.layer(f"down.{level}", self.silu(h), stride=2)
        h = self._blocks(f"before.{coarsest}", blocks[-1], h)
        for level in range(coarsest - 1, -1, -1):
            h = self.finer(self.layer(f"up.{level}", h), skips[level])
            h = self._blocks(f"after.{level}", blocks[level], h)
        return self.layer("project", self.silu(h, pad=0))

    def _blocks(self, part: str, count: int, x: Field) -> Field:
        for k in range(count):
            inner = self.layer(f"{part}.{k}.a", self.silu(x), room="inner")
            x = self.layer(f"{part}.{k}.b", self.silu(inner), add=x, room=f"sum {k % 2}")
        return x


class Network:
    """The U-Net with one set of weights, evaluated by compiled code.

    `weights`, `blocks`: see `shapes`. `dtype` is the arithmetic, float32 or float64. With `around`, grids are
    O grids, unrolled to strips that are periodic along xi. Levels have 33, 17, 9 and 5 nodes::

        h = lift(features)
        h = blocks(h);  h = down(silu(h))     on each level but the coarsest
        h = blocks(h)                         on the coarsest level
        h = blocks(skip + finer(up(h)))       on each finer level; finer interpolates linearly
        d = m · project(silu(h))              displacements, x and y for each kind of grid in `HEADS`

    A block is h + b(silu(a(silu(h)))), and skip is h before down. Layers a, b and down have 3 x 3 kernels.
    The factor m is 0 on the boundary (see `rim_factor`).
    """

    def __init__(
        self,
        weights: Mapping[str, Reals],
        blocks: Sequence[int],
        dtype: Any = np.float64,
        around: bool = False,
    ) -> None:
        self.dtype, self.blocks, self.around = np.dtype(dtype), tuple(blocks), around
        exact = {name: np.asarray(value, np.float64) for name, value in weights.items()}
        self._layers = {
            "lift": _packed(symmetry.lift(exact["lift"], SEEN), exact["lift_bias"], self.dtype),
            "project": _packed(symmetry.projection(exact["project"], ELEMENTS, np), None, self.dtype),
        }
        for name in exact:
            layer, _, rest = name.rpartition(".")
            if rest == "weight":
                kernel = symmetry.convolution(exact[name], symmetry.table(exact[name].shape[-1]), np)
                self._layers[layer] = _packed(kernel, exact[f"{layer}.bias"], self.dtype)
        self._idle: dict[tuple[int, int], list[LayerProgram]] = {}  # of no thread at the time
        self.heads = len(exact["project"])

    def __call__(self, seen: Reals, head: int | None = None) -> Complexes:
        """Return displacements (batch, heads, m, n), or one `head`'s, for `seen` (batch, m, n, FEATURES)."""
        batch, m, n = seen.shape[:3]
        seen = np.ascontiguousarray(seen, self.dtype)
        answer = np.empty((batch, m, n, 2 * self.heads), self.dtype)
        idle = self._idle.setdefault((m, n), [])
        try:
            program = idle.pop()
        except IndexError:
            work = _ProgramRecorder(self._layers, self.around)
            work.through(np.empty((CHUNK, m, n, FEATURES), self.dtype), self.blocks)
            program = work.program
        for k in range(0, batch, CHUNK):
            program.run(seen[k : k + CHUNK], answer[k : k + CHUNK])
        idle.append(program)
        pairs = answer.reshape(batch, m, n, self.heads, 2)
        pairs = np.moveaxis(pairs, 3, 1) if head is None else pairs[..., head, :]
        moved = np.multiply(pairs, rim_factor(m, n, self.around)[..., None], order="C")
        return np.asarray(moved.view(np.complex128)[..., 0])

    def moves(self, near: Complexes, step: Complexes, head: int) -> Complexes:
        """Return displacements (batch, m, n) of grids `near`, from the network's output with index `head`.

        `step` is the last Picard step, which led to `near`.
        """
        if self.around:
            return self(features(near, step, np, around=True), head)
        seen = np.empty((*near.shape, FEATURES), self.dtype)
        grid_features(planes_of(near), planes_of(step), seen)
        return self(seen, head)


class _ProgramRecorder(UNet[Reals]):
    """Records layers by name in a program, on arrays of `CHUNK` domains."""

    def __init__(self, layers: Mapping[str, tuple[Reals, Reals, int]], around: bool) -> None:
        self.program = LayerProgram()
        self._layers, self._around = layers, around
        self._rooms: dict[Any, Reals] = {}

    def layer(self, name: str, x: Reals, stride: int = 1, add: Reals | None = None, room: str = "") -> Reals:
        weight, bias, outputs = self._layers[name]
        size = 1 if len(weight) == x.shape[3] else 3
        m, n = ((count - size) // stride + 1 for count in x.shape[1:3])
        out = self._room(room or name, (len(x), m, n, outputs), x.dtype)
        convolve(x, weight, bias, size, stride, add, out, self.program)
        return out

    def finer(self, low: Reals, skip: Reals) -> Reals:
        out = self._room("finer", skip.shape, skip.dtype)
        upsample(low, skip, out, self._around, self.program)
        return out

    def silu(self, x: Reals, pad: int = 1) -> Reals:
        batch, m, n, channels = x.shape
        out = self._room("active", (batch, m + 2 * pad, n + 2 * pad, channels), x.dtype)
        activate(x, out, self._around, self.program)
        return out

    def _room(self, name: str, shape: tuple[int, ...], dtype: Any) -> Reals:
        if (name, shape) not in self._rooms:
            self._rooms[name, shape] = _aligned(shape, dtype)
        return self._rooms[name, shape]


def _packed(kernel: Floats, bias: Floats | None, dtype: np.dtype[Any]) -> tuple[Reals, Reals, int]:
    """Return a kernel as a matrix (size² in, out rounded up), its biases, and the count of outputs."""
    outputs = len(kernel)
    rows = np.moveaxis(kernel, (0, 1), (-1, -2)).reshape(-1, outputs)
    per = LINE // dtype.itemsize
    wide = -(-outputs // per) * per
    weight, biases = _aligned((len(rows), wide), dtype), _aligned((wide,), dtype)
    weight[:, :outputs] = rows
    if bias is not None:
        biases[:outputs] = np.repeat(bias, ORDER)
    return weight, biases, outputs


def _aligned(shape: tuple[int, ...], dtype: np.dtype[Any]) -> Reals:
    count = int(np.prod(shape)) * dtype.itemsize
    raw = np.zeros(count + LINE, np.uint8)
    begin = -raw.ctypes.data % LINE
    return raw[begin : begin + count].view(dtype).reshape(shape)
