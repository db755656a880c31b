"""Where the lines of a wing along its span leave a body."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.stack import Stack

_PLACES = 65
"""Heights at which a line is compared with the body at a time."""
_PASSES = 6
"""Times that the interval around a crossing is divided into `_PLACES` parts."""


def root_heights(stack: Stack, name: str, unit: Floats, body: Body) -> Floats:
    """Return the heights z (n,) at which lines along the span of a wing leave a body.

    `unit` (sections, n, 2) are the nodes around the sections, the first of them inside the body.

    Raises InputError: a line that begins outside of the body, or never leaves it.
    """
    out = body.outside(stack.lofted(unit, stack.z[:1])[0])
    if out.max() >= 0.0:
        raise _error(stack, name, unit[:, int(out.argmax())], float(stack.z[0]), body, "begins outside of")
    heights = np.empty(unit.shape[1])
    for k in range(len(heights)):
        low, high = float(stack.z[0]), float(stack.z[-1])
        for _ in range(_PASSES):
            z = np.linspace(low, high, _PLACES)
            out = body.outside(stack.lofted(unit[:, k : k + 1], z)[:, 0])
            first = np.flatnonzero(out >= 0.0)
            if not len(first):
                raise _error(stack, name, unit[:, k], high, body, "does not leave")
            at = int(first[0])
            low, high = float(z[at - 1]), float(z[at])
        heights[k] = low + (high - low) * out[at - 1] / (out[at - 1] - out[at])
    return heights


def _error(stack: Stack, name: str, unit: Floats, z: float, body: Body, what: str) -> InputError:
    """Return the error for a line at the height z, with its place in relation to the body."""
    x, y, z = stack.lofted(unit[:, None], np.array([z]))[0, 0]
    nose, tail = body.meridian[0, 0], body.meridian[-1, 0]
    if nose < x < tail:
        radius = float(np.interp(x, *body.meridian.T))
        where = f"{np.hypot(y - body.y, z):.4g} from its axis, where its radius is {radius:.4g}"
    else:
        where = (
            f"{'ahead of its nose' if x <= nose else 'behind its tail'}: it is from x={nose:g} to {tail:g}"
        )
    problem = f"a line of the {name} {what} the {body.name} at x={x:.6g}, y={y:.6g}, z={z:.6g}, {where}"
    remedy = "give a first section inside the body, such as in z = 0, and a last one outside"
    return InputError(problem, remedy, place="wings")
