"""Layers for NumPy and torch, named ``name/0/weight`` (in, out) and ``name/0/bias`` (out,) from 0 up."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Arrays: TypeAlias = dict[str, NDArray[Any]]
Weights: TypeAlias = Mapping[str, Any]
Shapes: TypeAlias = dict[str, tuple[int, ...]]


def dense_shapes(name: str, sizes: Sequence[int], stacked: int | None = None) -> Shapes:
    """Return the array shapes of dense layers of widths `sizes`, or of `stacked` copies of the layers."""
    shapes: Shapes = {}
    lead = () if stacked is None else (stacked,)
    for k, (a, b) in enumerate(pairwise(sizes)):
        shapes[f"{name}/{k}/weight"] = (*lead, a, b)
        shapes[f"{name}/{k}/bias"] = (*lead, *(() if stacked is None else (1,)), b)
    return shapes


def dense(xp: Any, w: Weights, name: str, h: Any, *, last: bool = False) -> Any:
    """Return the output of the dense layers called `name` for inputs `h` (.., in).

    tanh follows each layer except the last; with `last` it follows the last layer too.
    """
    k = 0
    while f"{name}/{k}/weight" in w:
        weight, bias = w[f"{name}/{k}/weight"], w[f"{name}/{k}/bias"]
        plain = xp is np or weight.ndim > 2  # torch has one operation, which saves a pass over memory
        h = h @ weight + bias if plain else xp.nn.functional.linear(h, weight.T, bias)
        k += 1
        if last or f"{name}/{k}/weight" in w:
            h = xp.tanh(h)
    return h


def products(trunk: Any, branches: Any) -> Any:
    """Return the inner products (batch, p, 2) of features `trunk` (p, k) and `branches` (batch, 2, k)."""
    batch, two, k = branches.shape
    return (trunk @ branches.reshape(batch * two, k).T).reshape(-1, batch, two).swapaxes(0, 1)


def initial(shapes: Shapes, rng: np.random.Generator) -> Arrays:
    """Return random initial parameters by name; `shapes` has the shape for each name.

    Names that end with ``bias`` get 0, with ``spectral`` normal numbers of standard deviation 1/inputs, with
    ``poles`` uniform numbers. Others get uniform numbers after Glorot & Bengio, AISTATS 2010.
    """
    arrays: Arrays = {}
    for name, shape in shapes.items():
        if name.endswith("bias"):
            arrays[name] = np.zeros(shape)
        elif name.endswith("spectral"):
            arrays[name] = rng.standard_normal(shape) / shape[-3]
        elif name.endswith("poles"):
            arrays[name] = rng.uniform([np.log(0.5), -8.0], [np.log(20.0), 8.0], shape)
        else:
            limit = float(np.sqrt(6.0 / (shape[-2] + shape[-1])))
            arrays[name] = rng.uniform(-limit, limit, shape)
    return arrays


def gelu(xp: Any, x: Any) -> Any:
    """Return the Gaussian error linear unit in its tanh form. Hendrycks & Gimpel, arXiv 1606.08415."""
    if xp is not np:  # one pass over memory, and one for the gradient
        return xp.nn.functional.gelu(x, approximate="tanh")
    return 0.5 * x * (1.0 + xp.tanh(0.7978845608028654 * (x + 0.044715 * x * x * x)))
