"""Keep pictures of the documentation small: python docs/reduce_pictures.py [--width PIXELS] PNG..."""

import argparse
from pathlib import Path

from PIL import Image, ImageChops

COLOURS = 32
"""Colours that are kept: a picture of lines and a colour bar looks the same, in a tenth of the bytes."""


def reduce(path: Path, width: int = 900, colours: int = COLOURS) -> None:
    """Rewrite a picture with at most `width` pixels a row, in few colours."""
    picture = Image.open(path).convert("RGB")
    picture.thumbnail((width, picture.height), Image.Resampling.LANCZOS)
    few = picture.quantize(colours, Image.Quantize.MAXCOVERAGE, kmeans=5, dither=Image.Dither.NONE)
    few.putpalette([255 if value > 247 else value for value in few.getpalette() or ()])  # white stays white
    few.save(path, optimize=True)


def place(drawn: Path, target: Path, width: int = 900, colours: int = COLOURS) -> None:
    """Reduce a picture and put it in its place, unless the one there looks the same."""
    reduce(drawn, width, colours)
    if not target.exists() or not same(drawn, target):
        target.write_bytes(drawn.read_bytes())


def same(one: Path, other: Path) -> bool:
    """Return whether two pictures have the same pixels."""
    first, second = (Image.open(path).convert("RGB") for path in (one, other))
    return first.size == second.size and ImageChops.difference(first, second).getbbox() is None


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Rewrite pictures with few pixels and colours.")
    parser.add_argument("pictures", nargs="+", type=Path)
    parser.add_argument("--width", type=int, default=900, help="pixels a row at the most")
    options = parser.parse_args()
    for each in options.pictures:
        reduce(each, options.width)
