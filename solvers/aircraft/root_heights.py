"""Heights at which the lines of a wing leave a body."""

import numpy as np

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.solvers.aircraft.lofts import Loft

_PLACES = 65  # number of heights at which a line is compared with the body in each step

_PASSES = 6  # number of steps; each divides the interval around a crossing


def root_heights(loft: Loft, name: str, body: Body) -> Floats:
    """Return the heights z (n,) at which the lines of a wing's `loft` leave a body.

    Raises InputError: a line that begins outside of the body, or never leaves it.
    """
    begin = loft.begin
    out = body.outside(np.stack([loft.line(k, begin[k : k + 1])[0] for k in range(len(begin))]))
    if out.max() >= 0.0:
        worst = int(out.argmax())
        raise _error(loft, name, worst, float(begin[worst]), body, "begins outside of")
    heights = np.empty(len(begin))
    for k in range(len(heights)):
        low, high = float(begin[k]), loft.tip
        for _ in range(_PASSES):
            z = np.linspace(low, high, _PLACES)
            out = body.outside(loft.line(k, z))
            first = np.flatnonzero(out >= 0.0)
            if not len(first):
                raise _error(loft, name, k, high, body, "does not leave")
            at = int(first[0])
            low, high = float(z[at - 1]), float(z[at])
        heights[k] = low + (high - low) * out[at - 1] / (out[at - 1] - out[at])
    return heights


def _error(loft: Loft, name: str, line: int, z: float, body: Body, what: str) -> InputError:
    """Return the error for a line at the height z, with its place beside the body."""
    x, y, z = point = loft.line(line, np.array([z]))[0]
    nose, tail = body.meridian[0, 0], body.meridian[-1, 0]
    if nose < x < tail:
        where = body.beside(point)
    else:
        where = (
            f"{'ahead of its nose' if x <= nose else 'behind its tail'}: it is from x={nose:g} to {tail:g}"
        )
    problem = f"a line of the {name} {what} the {body.name} at x={x:.6g}, y={y:.6g}, z={z:.6g}, {where}"
    return InputError(problem, loft.remedy, place="wings")
