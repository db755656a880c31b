"""Run the tutorials: the blocks of each page in their order; compare what they print with the page.

    python docs/tutorials/run_tutorials.py [PAGE...]             say where a page and its commands differ
    python docs/tutorials/run_tutorials.py --pictures [PAGE...]  and draw its pictures again
    python docs/tutorials/run_tutorials.py --fill [PAGE...]      and write what is printed into empty blocks

A page may hold blocks of `bash` and `python`, which are run; blocks of `text` behind them, which are what is
printed (a line `...` stands for any lines); blocks of `toml` that begin with `# NAME.toml`, which are files.
A comment `<!-- needs: PROGRAM -->` in front of a block names a program or Python package that may be absent;
`<!-- within: 0.02 -->` in front of a block of text says by which part its figures may differ: printed.py.
"""

import argparse
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

from printed import differences

ROOT = Path(__file__).parents[2]
FOLDER = Path(__file__).parent
PAGES = sorted(set(FOLDER.glob("*.md")) - {FOLDER / "index.md"})
WIDTH = 800
_BLOCK = re.compile(
    r"(?:^<!-- (?:needs|within): (\S+) -->\n)?^```(bash|python|text|toml)\n(.*?)^```$",
    re.DOTALL | re.MULTILINE,
)
_SETTING = re.compile(r"^export (\w+)=(\S+)$", re.MULTILINE)


@dataclass(frozen=True)
class Step:
    """A block that is run, and what the page says it prints."""

    language: str
    text: str
    needs: str = ""
    prints: str = ""
    within: float = 0.0


@dataclass(frozen=True)
class Result:
    """A step, what it printed, and its exit status."""

    step: Step
    printed: str
    status: int

    def differences(self) -> list[str]:
        """Return how the page differs from what was printed."""
        return differences(self.step.prints, self.printed, self.step.within)


def steps_of(page: Path) -> list[Step]:
    """Return the steps of a page in their order."""
    steps: list[Step] = []
    for comment, language, text in _BLOCK.findall(page.read_text(encoding="utf-8")):
        if language == "text":
            steps[-1] = replace(steps[-1], prints=text, within=float(comment or 0))
        else:
            steps.append(Step(language, text, comment))
    return steps


def pictures_of(page: Path) -> list[str]:
    """Return the names of the pictures that a page shows."""
    return re.findall(r"!\[[^]]*\]\(img/([\w-]+\.png)\)", page.read_text(encoding="utf-8"))


def is_there(program: str) -> bool:
    """Return whether a program, or a Python package of that name, is installed."""
    return not program or shutil.which(program) is not None or importlib.util.find_spec(program) is not None


def run(
    page: Path, folder: Path, settings: dict[str, str] | None = None, quick: bool = False
) -> list[Result]:
    """Run a page in a folder, with other values for the variables it exports; stop at the first error.

    Quick runs leave out what needs another program, and `meshonet plot`.
    """
    shutil.copytree(ROOT / "examples", folder / "examples", ignore=shutil.ignore_patterns("run-*", "paper"))
    variables = environment(folder, quick)
    results: list[Result] = []
    for step in steps_of(page):
        if quick and step.needs:
            continue
        results.append(_run_step(step, folder, variables, settings or {}))
        if results[-1].status:
            break
    return results


def environment(folder: Path, quick: bool = False) -> dict[str, str]:
    """Return an environment in which `meshonet` and `python` are this project's."""
    programs = folder / ".bin"
    programs.mkdir(exist_ok=True)
    no_plots = 'test "$1" = plot && exit\n' if quick else ""
    for name, words in (("meshonet", "-m meshonet_cli "), ("python", "")):
        text = f'#!/bin/sh\n{no_plots}exec "{sys.executable}" {words}"$@"\n'
        (programs / name).write_text(text, encoding="utf-8")
        (programs / name).chmod(0o755)
    added = {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", "MPLBACKEND": "Agg", "COLUMNS": "100"}
    return {**os.environ, **added, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}


def _run_step(step: Step, folder: Path, environment: dict[str, str], settings: dict[str, str]) -> Result:
    """Run a step; remember what it exports in the environment."""
    if step.language == "toml":
        (folder / _file_name(step)).write_text(step.text, encoding="utf-8")
        return Result(step, "", 0)
    text = _SETTING.sub(lambda hit: f"export {hit[1]}={settings.get(hit[1], hit[2])}", step.text)
    environment.update(_SETTING.findall(text))
    words = ["bash", "-e", "-c", text] if step.language == "bash" else ["python", "-c", text]
    done = subprocess.run(  # noqa: S603
        words, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    return Result(step, done.stdout, done.returncode)


def _file_name(step: Step) -> str:
    name = re.match(r"# ([\w-]+\.toml)\n", step.text)
    if name is None:
        message = f"a block of toml begins with '# NAME.toml', not with {step.text[:40]!r}"
        raise ValueError(message)
    return name[1]


def fill(page: Path, results: list[Result]) -> None:
    """Write what the steps of a page printed into those of its blocks of text that are empty."""
    printed = iter(result.printed for result in results)
    last = ""

    def filled(block: re.Match[str]) -> str:
        nonlocal last
        if block[2] != "text":
            last = next(printed, "")
        elif not block[3] and last.strip():
            return f"```text\n{last.strip(chr(10))}\n```"
        return block[0]

    page.write_text(_BLOCK.sub(filled, page.read_text(encoding="utf-8")), encoding="utf-8")


def keep_pictures(page: Path, folder: Path) -> None:
    """Put the pictures of a page that was run beside it, small."""
    (FOLDER / "img").mkdir(exist_ok=True)
    kept = [shutil.copy(folder / name, FOLDER / "img" / name) for name in pictures_of(page)]
    words = [sys.executable, ROOT / "docs" / "reduce_pictures.py", "--width", str(WIDTH), *kept]
    subprocess.run(words, check=True)  # noqa: S603


def main() -> int:
    """Run pages and report."""
    parser = argparse.ArgumentParser(description="Run tutorials, compare what they print with their pages.")
    parser.add_argument("pages", nargs="*", type=Path, default=PAGES)
    parser.add_argument("--pictures", action="store_true", help="keep the pictures in docs/tutorials/img")
    parser.add_argument("--fill", action="store_true", help="write what is printed into empty blocks of text")
    parser.add_argument("--verbose", action="store_true", help="show all that is printed")
    options = parser.parse_args()
    wrong = 0
    for page in options.pages:
        with tempfile.TemporaryDirectory() as name:
            results = run(page, Path(name))
            wrong += report(page, results, options.verbose)
            if options.fill:
                fill(page, results)
            if options.pictures and not results[-1].status:
                keep_pictures(page, Path(name))
    return min(wrong, 1)


def report(page: Path, results: list[Result], verbose: bool) -> int:
    """Print how a page fared; return the number of its steps that failed or printed something else."""
    wrong = 0
    for result in results:
        unlike = result.differences()
        wrong += bool(unlike or result.status)
        if unlike or result.status or verbose:
            print(f"--- {page.name}: exit {result.status}\n{result.step.text}=== printed\n{result.printed}")
            print("\n".join(f"=== differs\n{each}" for each in unlike))
    print(f"{page.name}: {len(results)} steps, {wrong} wrong")
    return wrong


if __name__ == "__main__":
    sys.exit(main())
