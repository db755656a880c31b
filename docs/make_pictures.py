"""Draw the pictures of commands and families in docs/img: python docs/make_pictures.py (make pictures).

A picture that looks as it did is not written again.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from reduce_pictures import place

from meshonet.geometry.families.family import FAMILIES

DOCS = Path(__file__).parent
NACA = ("infer", "naca:2412", "--res", "161x81")
EDGE = ("infer", "naca:2412", "--te", "wedge", "--wall-spacing", "1e-5", "--res", "250x100")


def main() -> None:
    """Draw all of them."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        grid = folder / "grid.vts"
        meshonet(*NACA, "-o", grid)
        draw(grid, "naca2412", "--zoom=-0.35,1.35,-0.5,0.5")
        meshonet(*EDGE, "-o", grid)
        draw(grid, "c-grid-edge", "--zoom=0.96,1.06,-0.03,0.03")
        run(
            sys.executable,
            str(DOCS.parent / "examples" / "shape-optimisation" / "throat.py"),
            "-o",
            str(grid),
        )
        draw(grid, "throat")
        for family in FAMILIES:
            boundary = folder / f"{family}.h5"
            meshonet("sample-boundary", "--family", family, "--count", "1", "--res", "61x41", "-o", boundary)
            meshonet("solve-pde", boundary, "-o", grid)
            draw(grid, family, *(["--zoom=-0.6,1.6,-0.8,0.8"] if family == "airfoil" else []))


def draw(grid: Path, name: str, *words: str) -> None:
    """Draw a grid as docs/img/NAME.png."""
    picture = grid.with_name(f"{name}.png")
    meshonet("plot", grid, *words, "-o", picture)
    place(picture, DOCS / "img" / picture.name)


def meshonet(*words: object) -> None:
    """Run the command line quietly."""
    run(sys.executable, "-m", "meshonet_cli", *(str(word) for word in words), "--quiet")


def run(*words: str) -> None:
    """Run a program; stop when it fails."""
    subprocess.run(words, check=True)  # noqa: S603 - our own program


if __name__ == "__main__":
    main()
