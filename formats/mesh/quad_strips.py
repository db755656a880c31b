"""Straight on across quadrilaterals: the grid line that leaves a boundary node."""

from __future__ import annotations

import numpy as np

from meshonet.formats.mesh.unstructured import Indices


def line_across(quads: Indices, start: int, count: int) -> list[int]:
    """Return the nodes from boundary node `start` straight across to the other boundary, or nothing.

    Straight on means, at a node where four `quads` (m, 4) meet, into the edge that has no cell in common with
    the one come from. Where cells meet otherwise there is no such line. `count` is that of all nodes.
    """
    order = np.argsort(quads.ravel(), kind="stable") // 4
    begin = np.concatenate([[0], np.cumsum(np.bincount(quads.ravel(), minlength=count))])

    def around(node: int) -> list[list[int]]:
        return quads[order[begin[node] : begin[node + 1]]].tolist()

    def beside(node: int, cell: list[int]) -> tuple[int, int]:
        at = cell.index(node)
        return cell[at - 1], cell[(at + 1) % 4]

    line, cells = [start], around(start)
    if len(cells) != 2:
        return []
    shared = set(beside(start, cells[0])) & set(beside(start, cells[1]))
    while len(shared) == 1 and len(line) <= count:
        line.append(shared.pop())
        cells = around(line[-1])
        if len(cells) == 2:
            return line
        ahead = [cell for cell in cells if line[-2] not in cell]
        if len(cells) != 4 or len(ahead) != 2:
            return []
        shared = set(beside(line[-1], ahead[0])) & set(beside(line[-1], ahead[1]))
    return []
