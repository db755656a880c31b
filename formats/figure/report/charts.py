"""Histograms as drawings for a page (SVG)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshonet.formats.figure.page.cells import BARS, Scale, histogram
from meshonet.geometry.arrays import Floats

_WIDTH, _HEIGHT, _FOOT = 240, 64, 16
"""Size of a histogram and the room for numbers below it, pixels."""
_TINY = 1e-300
"""Keeps a division by a scale without extent finite."""


def histogram_svg(values: Floats, scale: Scale, limits: Sequence[float] = ()) -> str:
    """Return a drawing of how values (n,) are distributed; `limits` are marked where they are on the scale.

    Heights grow with the square root of the count, so that a few bad cells can be seen.
    """
    counts = np.array(histogram(values, scale), dtype=float)
    heights = np.sqrt(counts / max(counts.max(), 1.0)) * _HEIGHT
    width = _WIDTH / BARS
    bars = "".join(
        f'<rect x="{k * width:.1f}" y="{_HEIGHT - max(h, 1):.1f}" width="{0.88 * width:.2f}" '
        f'height="{max(h, 1):.1f}"/>'
        for k, h in enumerate(heights)
        if h > 0
    )
    marks = "".join(
        f'<line x1="{x:.1f}" x2="{x:.1f}" y1="0" y2="{_HEIGHT}"/>'
        for limit in limits
        if 0 <= (x := _WIDTH * _shown_part(limit, scale)) <= _WIDTH
    )
    ends = (
        f'<text x="0" y="{_HEIGHT + 12}">{scale.start:.4g}</text>'
        f'<text x="{_WIDTH}" y="{_HEIGHT + 12}" class="end">{scale.stop:.4g}</text>'
    )
    box = f'viewBox="0 0 {_WIDTH} {_HEIGHT + _FOOT}"'
    return f'<svg class="histogram" {box} role="img">{bars}{marks}{ends}</svg>'


def _shown_part(value: float, scale: Scale) -> float:
    """Return where a value is between the ends that are shown, 0 to 1; beyond them less or more."""
    if scale.log and value <= 0:
        return -1.0
    part, first, last = scale.parts(np.array([value, scale.start, scale.stop]))
    return float((part - first) / max(last - first, _TINY))
