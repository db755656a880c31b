"""Inputs of the strip network and scaling of its output; `xp` is the module of the arrays."""

from typing import Any

import numpy as np

from meshonet.geometry.arrays import array_like
from meshonet.geometry.elementary import functions_of, modulus, times
from meshonet.solvers.conformal.strip import decay, from_columns, to_columns, wavenumbers

DEPTHS = np.array([0.0, 0.03, 0.08, 0.16, 0.32, 0.6, 1.0])  # eta of the harmonic base in the network's input

CHANNELS = 4 * len(DEPTHS)  # real and imaginary parts of value and slope
SCALARS = 3  # log size, height and shear of the strip

SLOPE = 0.3  # factor of slopes, which are larger than values by about their wave number


def encode(wall: Any, far: Any, xp: Any = np) -> tuple[Any, Any, Any]:
    """Return the network's inputs for strips whose walls have the Fourier modes `wall` and `far`.

    A strip is the conformal image of the region around a body, with period 2 pi along theta. `wall` (body)
    and `far` (far field) have the shape (batch, 2 MODES + 1). The inputs are three arrays:

    - channels (batch, CHANNELS, COLUMNS): the harmonic extension of the walls at the fractions `DEPTHS` of
      the height, and its derivative along theta, both divided by `size`;
    - scalars (batch, SCALARS): log(size), strip height, and the mean shift of `far` from `wall` along theta;
    - size (batch,): the root mean square deviation of the walls from straight lines.
    """
    mean = (far - wall)[:, 0]
    a, b = (xp.concatenate([xp.zeros_like(side[:, :1]), side[:, 1:]], 1) for side in (wall, far))
    size = xp.sqrt(xp.clip((modulus(a) ** 2 + modulus(b) ** 2).sum(1), 1e-24, None))
    k = wavenumbers(wall, xp)
    near, away = decay(k, mean.real[:, None, None], array_like(DEPTHS, wall, xp), xp)
    h = (a[:, :, None] * near + b[:, :, None] * away).swapaxes(1, 2) / size[:, None, None]
    value, slope = to_columns(h, xp), SLOPE * to_columns(times(1j * k, h), xp)
    channels = xp.stack([value.real, value.imag, slope.real, slope.imag], 2)
    scalars = xp.stack([functions_of(xp).log(size) + 2.5, mean.real - 4.0, mean.imag], 1)
    return channels.reshape(len(wall), CHANNELS, -1), scalars, size


def decode(coefficients: Any, basis: Any, scale: float, size: Any, xp: Any = np) -> Any:
    """Return Fourier modes (batch, 2 MODES + 1, LEVELS) of Winslow's solution minus the harmonic extension.

    Both are functions on the periodic strip to which the region around a body is mapped. At each point along
    the strip, the difference is a sum of Q functions across the strip, each with its own complex factor.
    `basis` (Q, LEVELS - 2) has the functions' values at inner Chebyshev points. `coefficients` (batch, 2 Q,
    COLUMNS) are the network's outputs at equal steps along the strip: Q real parts, then Q imaginary parts.
    Factors are these times ``scale * size**2``, with `scale` from `StripTargets` and `size` from `encode`.
    """
    q = len(basis)
    c = from_columns(coefficients[:, :q] + 1j * coefficients[:, q:], xp)
    inner = functions_of(xp).matmul(c.swapaxes(1, 2), basis + 0j) * (scale * size**2)[:, None, None]
    edge = xp.zeros_like(inner[..., :1])
    return xp.concatenate([edge, inner, edge], -1)
