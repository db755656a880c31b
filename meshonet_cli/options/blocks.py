"""Blocks of options: dataclasses whose fields are the options of a command."""

import dataclasses
import functools
import inspect
from collections.abc import Callable, Iterator
from typing import Any, get_type_hints


def expanded(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function` with the fields of its dataclass parameters as parameters of their own.

    The options of a block are declared once, with their defaults, and the function has them by group::

        @expanded
        def tfi(boundary: Boundaries, output: Output, sampling: SamplingOptions, checks: CheckOptions): ...
    """
    hints = get_type_hints(function, include_extras=True)
    blocks: dict[str, Any] = {name: kind for name, kind in hints.items() if dataclasses.is_dataclass(kind)}
    signature = inspect.signature(function)

    def parameters() -> Iterator[inspect.Parameter]:
        for name, parameter in signature.parameters.items():
            if name in blocks:
                yield from inspect.signature(blocks[name], eval_str=True).parameters.values()
            else:
                yield parameter.replace(annotation=hints[name])

    @functools.wraps(function)
    def call(**values: Any) -> Any:
        for name, block in blocks.items():
            names = [field.name for field in dataclasses.fields(block)]
            values[name] = block(**{field: values.pop(field) for field in names})
        return function(**values)

    ordered = sorted(
        (each.replace(kind=inspect.Parameter.KEYWORD_ONLY) for each in parameters()),
        key=lambda each: each.default is not inspect.Parameter.empty,
    )
    call.__signature__ = signature.replace(parameters=ordered)  # type: ignore[attr-defined]
    call.__annotations__ = {each.name: each.annotation for each in ordered}
    return call
