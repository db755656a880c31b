"""``meshonet models``."""

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from meshonet_cli import options as o
from meshonet_cli.terminal.text import aligned

EXAMPLES = ("meshonet models", "meshonet models quad-general", "meshonet models --json")


def models(
    name: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME",
            show_default=False,
            help="Model to describe: its training parameters and held-out errors. [default: one line for "
            "each model]",
        ),
    ] = None,
    as_json: o.AsJson = False,
    debug: o.Debug = False,
) -> int:
    """List the neural operators that are part of meshonet."""
    from meshonet.api.models import models as described
    from meshonet_cli.terminal.session import Session

    session = Session(as_json=as_json, debug=debug)
    facts = [model for each in name for model in described(each)] if name else described()
    if as_json:
        for model in facts:
            session.result(model)
    else:
        session.print("\n".join(map(model_text, facts)) if name else models_table(facts))
    return session.finish()


def models_table(models: list[dict[str, Any]]) -> str:
    """Return a text with a line for each model: its use, time and error."""
    rows = [["model", "for", "takes", "median error"]]
    rows += [[model["name"], model["use"], model["speed"], model["error"]] for model in models]
    more = "meshonet models NAME tells all of one; meshonet infer --model NAME makes grids by it"
    return f"{aligned(rows, left=4)}\n\n{more}"


def model_text(facts: Mapping[str, Any]) -> str:
    """Return the description of a model: its name, then a line for each fact.

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
