"""Task of `layout`."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from meshonet.formats.registry import read_shapes
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.blocks import make_layout
from meshonet.solvers.pipeline.request import GridRequest
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import Batch, BatchTask, each
from meshonet_cli.report.delivered import Delivered


def write_layouts(
    batch: Batch, parameters: Mapping[str, Any], far_field: float | None, *, assemble: bool = False
) -> int:
    """Write how each input, or with `assemble` their union, is split into blocks; return the exit code."""
    sampling = Sampling(far_field=far_field)
    read = partial(read_shapes, fmt=batch.files.from_format)
    make = each(_split, request=GridRequest(sampling, **parameters))
    batch = replace(batch, files=replace(batch.files, to_format="layout"))
    return batch.run(BatchTask(read, make, "layouts", assembled=sampling if assemble else None))


def _split(item: Item[Shape], request: GridRequest) -> tuple[Layout, Delivered]:
    layout, stages = make_layout(item.what, request)
    mesh = layout.mesh
    facts = {
        "blocks": len(layout.blocks), "cells": layout.cells,
        "irregular": int(np.count_nonzero(mesh.irregular & ~mesh.wall_nodes)),
    }  # fmt: skip
    text = ", ".join(f"{count} {name}" for name, count in facts.items())
    report = Delivered(item, {**facts, "notes": []}, text, notes=mesh.domain.notes)
    report.seconds |= stages
    return layout, report
