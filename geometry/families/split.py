"""Which members of a family train an operator, and which test it: Xiao et al., arXiv 2501.11937, IV."""

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

from meshonet.geometry.errors import InputError

Way = Literal["interpolation", "extrapolation", "random"]
WAYS: tuple[str, ...] = get_args(Way)
SHARE = 1 / 6  # fraction of test members: 6 of 36 in the settings of the paper's authors


def split(
    parameters: Sequence[float], way: str, *, seed: int = 0, share: float = SHARE, low: bool = False
) -> tuple[str, ...]:
    """Return ``train`` or ``test`` for each of `parameters`; `way` is one of `WAYS`.

    Test members have the middle values for ``interpolation``, and the highest values (with `low`, the lowest)
    for ``extrapolation``; for ``random`` they are drawn. `share` is the fraction of test members. At least 1
    member is for tests, and at least 2 for training. Raises InputError: an unknown way; fewer than three
    members; equal parameters, unless the way is random.

    >>> split([0.3, 0.1, 0.2], "extrapolation")
    ('test', 'train', 'train')
    """
    if way not in WAYS:
        raise InputError(f"split {way!r} is not known", "use " + ", ".join(WAYS))
    n = len(parameters)
    values = np.asarray(parameters, dtype=np.float64)
    if n < 3:
        raise InputError(f"{n} members cannot be split", "give at least 3")
    if way != "random" and (np.ptp(values) == 0 or not np.isfinite(values).all()):
        raise InputError(f"members without different parameters have no {way}", "split them at random")
    count = min(max(1, round(share * n)), n - 2)
    order = np.argsort(values, kind="stable")
    if way == "random":
        tested = np.random.default_rng(seed).choice(n, count, replace=False)
    elif way == "interpolation":
        first = (n - count + 1) // 2
        tested = order[first : first + count]
    else:
        tested = order[:count] if low else order[n - count :]
    return tuple("test" if k in tested else "train" for k in range(n))
