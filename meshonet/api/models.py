"""`meshonet.models`."""

from typing import Any

from meshonet.solvers.neural.registry import described, shipped


def models() -> list[dict[str, Any]]:
    """Return what each shipped operator says of itself: name, topology, training, held-out figures.

    Returns
    -------
    list of dict
        What each shipped operator says of itself: name, topology, training, held-out figures.

    Examples
    --------
    >>> sorted(model["name"] for model in models())
    ['airfoil-o', 'hole-o', 'hole-winslow', 'quad-general', 'quad-winslow']
    """
    return [dict(described(name)) for name in shipped()]
