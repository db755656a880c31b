"""Shipped models as text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def model_text(facts: Mapping[str, Any]) -> str:
    """Return what a model says of itself, for people: its name, then one fact a line.

    >>> print(model_text({"name": "demo", "topology": "o", "recipe": {"shapes": 30, "seed": 1}}))
    demo
      topology  o
      recipe    shapes: 30
                seed: 1
    """
    others = {name: value for name, value in facts.items() if name != "name"}
    width = max(len(name) for name in others)
    lines = [str(facts.get("name", ""))]
    for name, value in others.items():
        text = _lines(value)
        lines.append(f"  {name:<{width}}  {text[0]}")
        lines += [" " * (width + 4) + line for line in text[1:]]
    return "\n".join(lines)


def _lines(value: object) -> list[str]:
    if isinstance(value, Mapping):
        return [f"{key}: {_short(part)}" for key, part in value.items()] or ["-"]
    return [_short(value)]


def _short(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_short(part)}" for key, part in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_short(part) for part in value)
    return str(value)
