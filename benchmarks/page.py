"""What the scripts that write a page share: the option --page, the writing, the name of the processor."""

import argparse
import platform
from pathlib import Path


def arguments(description: str | None) -> argparse.ArgumentParser:
    """Return a parser with --page, described by the first line of a script's docstring."""
    parser = argparse.ArgumentParser(description=(description or "").partition("\n")[0])
    parser.add_argument("--page", type=Path, help="markdown page to write")
    return parser


def publish(text: str, page: Path | None, *, shown: bool = False) -> None:
    """Print a page, unless its rows were printed as they were measured, and write it to `page`."""
    if not shown:
        print(text)
    if page:
        page.write_text(text, encoding="utf-8")


def processor() -> str:
    """Return the name of the processor."""
    path = Path("/proc/cpuinfo")
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
