"""`meshonet.models`."""

from typing import Any

from meshonet.solvers.neural.registry import described, shipped

_USES = {
    "airfoil-o": ("Winslow's O grids around airfoils", "10 ms at 800 x 800"),
    "hole-o": ("variational O grids around bodies with corners", "3 ms at 129 x 65"),
    "hole-winslow": ("Winslow's O grids around bodies with corners", "3 ms at 129 x 65"),
    "quad-general": ("variational grids of four-sided domains", "2 ms at 65 x 65"),
    "quad-winslow": ("Winslow's grids of four-sided domains", "2 ms at 65 x 65"),
}
"""Uses, and approximate times per grid on one core, without reading and writing (docs/benchmarks)."""
_HEADS = {"variational": "relative L2 from variational grids", "winslow": "relative L2 from Winslow's grids"}
_FIRST_HEAD = ("hole-o", "quad-general")


def models(name: str | None = None) -> list[dict[str, Any]]:
    """Return descriptions of the neural operators that are part of meshonet.

    Parameters
    ----------
    name : str, optional
        Name of a single operator; None for all.

    Returns
    -------
    list of dict
        Name, use, topology, training parameters and held-out errors of each operator.

    Raises
    ------
    InputError
        No operator has this name.

    Examples
    --------
    >>> sorted(model["name"] for model in models())
    ['airfoil-o', 'hole-o', 'hole-winslow', 'quad-general', 'quad-winslow']
    >>> models("quad-general")[0]["use"]
    'variational grids of four-sided domains'
    """
    names = shipped() if name is None else (name,)
    return [_facts(each) for each in names]


def _facts(name: str) -> dict[str, Any]:
    facts, (use, speed) = dict(described(name)), _USES.get(name, ("", ""))
    own = {"name": facts.pop("name"), "use": use, "speed": speed, "error": _error(name, facts)}
    return own | facts


def _error(name: str, facts: dict[str, Any]) -> str:
    """Return the median error over held-out domains as text, if the file has it."""
    figures = facts.get("figures", {})
    if "strips" in figures:
        return f"{figures['network']['median']:.1e} rad of the lift, {figures['strips']} airfoils held out"
    head = "variational" if name in _FIRST_HEAD else "winslow"
    if head not in figures:
        return ""
    median = figures[head]["relative_l2"]["median"]
    return f"{median:.1e} {_HEADS[head]}, {figures['domains']} domains held out"
