"""Elementary functions and matrix products that are bitwise the same on every processor.

NumPy's own depend on its libraries; `docs/reference/reproducibility.md` lists what does not. Arguments are
those of NumPy's functions of the same name. Results are float64, or float32 for float32.
"""

import math
import sys
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.kernels import _native


def _function(name: bytes, x: Any) -> Any:
    values = np.asarray(x)
    if np.iscomplexobj(values):
        return getattr(np, name.decode())(values)
    flat = _doubles(values).reshape(-1)
    out = np.empty(flat.shape)
    if out.size:
        _native.elementary(name, flat, out)
    return _shaped(out, values.shape, values.dtype)


_kernel: Callable[[bytes], Callable[[Any], Any]] = partial(partial, _function)
exp, log, sin, cos = map(_kernel, (b"exp", b"log", b"sin", b"cos"))
"""Functions accurate to 2 units in the last place; angles are in radians."""
expm1, log1p, log2, log10, cbrt = map(_kernel, (b"expm1", b"log1p", b"log2", b"log10", b"cbrt"))
tan, arcsin, arccos, arctan = map(_kernel, (b"tan", b"arcsin", b"arccos", b"arctan"))
sinh, cosh, tanh, arcsinh, arccosh = map(_kernel, (b"sinh", b"cosh", b"tanh", b"arcsinh", b"arccosh"))


def arctan2(y: Any, x: Any) -> Any:
    """Return the angle of the points (x, y) from -pi to pi, to within 2 units in the last place."""
    return _function_of_two(_native.angles_of, y, x)


def angle(z: Any) -> Any:
    """Return the angle of complex numbers from -pi to pi."""
    values = np.asarray(z)
    return arctan2(values.imag, values.real)


def modulus(z: Any) -> Any:
    """Return |z| of complex or real numbers; torch tensors are computed by torch."""
    return np.hypot(z.real, z.imag) if _is_complex(z) else abs(z)


def times(a: Any, b: Any) -> Any:
    """Return the product of complex numbers, with each real product and sum rounded separately.

    Real numbers and tensors are multiplied as usual.
    """
    if not (_is_complex(a) and _is_complex(b)):
        return a * b
    z, w = np.asarray(a), np.asarray(b)
    real = np.asarray(z.real * w.real - z.imag * w.imag)
    out = np.empty(real.shape, np.result_type(z, w))
    out.real, out.imag = real, z.real * w.imag + z.imag * w.real
    return out if out.ndim else out[()]


def _is_complex(values: Any) -> bool:
    if isinstance(values, np.ndarray | np.generic):
        return values.dtype.kind == "c"
    return isinstance(values, complex)


def power(x: Any, exponent: Any) -> Any:
    """Return `x` to the power `exponent`."""
    if np.iscomplexobj(x):
        return np.power(x, exponent)
    return _function_of_two(_native.powers_of, x, exponent)


def geomspace(start: float, stop: float, count: int) -> Floats:
    """Return `count` numbers in geometric progression from `start` to `stop`, both positive."""
    numbers = start * exp(np.linspace(0.0, math.log(stop / start), count))
    numbers[-1:] = stop
    return np.asarray(numbers)


def functions_of(xp: Any) -> Any:
    """Return the elementary functions for arrays of `xp`, as a module: `elementary` for numpy, else torch."""
    return sys.modules[__name__] if xp is np else xp


def product(a: Any, b: Any) -> Any:
    """Return the matrix product ``a @ b`` in double precision, with sums in a fixed order.

    `b` may be a stack of matrices (..., inner, columns), for which `inner` should be small.
    """
    left, right = np.asarray(a), np.asarray(b)
    if left.dtype.kind == "c" or right.dtype.kind == "c":
        real = product(left.real, right.real) - product(left.imag, right.imag)
        return real + 1j * (product(left.real, right.imag) + product(left.imag, right.real))
    left, right = _doubles(left), _doubles(right)
    inner = left.shape[-1]
    if inner != right.shape[-2:][0]:
        raise ValueError(f"a product of arrays of shapes {left.shape} and {right.shape}")
    if right.ndim > 2:
        return _stacked_product(left, right)
    rows, columns = left.shape[:-1], right.shape[1:]
    out = np.zeros((math.prod(rows), math.prod(columns)))
    if out.size and inner:
        _native.matrix_product(left.reshape(-1, inner), right.reshape(inner, -1), out)
    return out.reshape(rows + columns) if rows or columns else out[0, 0]


matmul = product
"""`product` by the name that torch has for it."""


def _stacked_product(left: Floats, right: Floats) -> Floats:
    """Return products of matrices (..., rows, inner), or one row (inner,), and (..., inner, columns)."""
    rows = left if left.ndim > 1 else left[None]
    stack = np.broadcast_shapes(rows.shape[:-2], right.shape[:-2])
    out = np.zeros((*stack, rows.shape[-2], right.shape[-1]))
    for k in range(right.shape[-2]):
        out += rows[..., :, k, None] * right[..., None, k, :]
    return out if left.ndim > 1 else out[..., 0, :]


def _function_of_two(kernel: Any, x: Any, y: Any) -> Any:
    one, two = np.broadcast_arrays(np.asarray(x), np.asarray(y))
    a, b = _doubles(one).reshape(-1), _doubles(two).reshape(-1)
    out = np.empty(a.shape)
    if out.size:
        kernel(a, b, out)
    return _shaped(out, one.shape, np.result_type(x, y))


def _doubles(values: Any) -> Floats:
    answer = np.ascontiguousarray(values, np.float64)
    if answer.dtype.byteorder == "=" and answer.flags.aligned:
        return answer
    copy = np.empty(answer.shape)
    copy[...] = answer
    return copy


def _shaped(out: Floats, shape: tuple[int, ...], of: np.dtype[Any]) -> Any:
    """Return results in `shape`, as float32 if computed from float32."""
    answer = out.reshape(shape)
    answer = answer.astype(np.float32) if of == np.float32 else answer
    return answer if answer.ndim else answer[()]
