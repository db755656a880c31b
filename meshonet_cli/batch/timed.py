"""What all reports of members of a batch have in common: which member, where the result is, and times."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from meshonet_cli.batch.item import Item
from meshonet_cli.text import span

STAGES = ("read", "boundary", "load", "grid", "guard", "quality", "compare", "write")


@dataclass
class Timed:
    """Something done to a member of a batch: which, where the result is, and seconds by stage."""

    item: Item[Any]
    seconds: dict[str, float] = field(init=False)
    output: str | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.seconds = {"read": self.item.seconds}

    @contextlib.contextmanager
    def timed(self, stage: str) -> Iterator[None]:
        """Add the time that the block takes to `stage`."""
        begun = time.perf_counter()
        yield
        self.seconds[stage] = self.seconds.get(stage, 0.0) + time.perf_counter() - begun

    def finished(self, path: str | None) -> None:
        """Note where the result is and add the stages up."""
        self.output = path
        known = [stage for stage in STAGES if stage in self.seconds]
        others = [stage for stage in self.seconds if stage not in STAGES]
        self.seconds = {stage: self.seconds[stage] for stage in known + others}
        self.seconds["total"] = sum(self.seconds.values())

    def member_json(self) -> dict[str, Any]:
        """Return for JSON which member this is, and where its result."""
        return {"input": self.item.source, "name": self.item.what.name, "output": self.output}

    def times(self) -> str:
        """Return the stages for people."""
        stages = [f"{name} {span(spent)}" for name, spent in self.seconds.items() if name != "total"]
        return f"{span(self.seconds['total'])}: {', '.join(stages)}"

    def times_json(self) -> dict[str, float]:
        """Return the stages for JSON, to the microsecond."""
        return {stage: round(spent, 6) for stage, spent in self.seconds.items()}
