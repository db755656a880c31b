"""Seconds until the program answers: fresh processes, the median and the least of many.

``python benchmarks/bench_startup.py [RUNS]``; the machine should have nothing else to do.
"""

import statistics
import subprocess
import sys
import time

LIMITS = {
    "python": (("-c", "pass"), None),
    "import meshonet": (("-c", "import meshonet"), 0.1),
    "meshonet --help": (("-m", "meshonet_cli", "--help"), 0.15),
    "meshonet infer --help": (("-m", "meshonet_cli", "infer", "--help"), None),
    "meshonet models": (("-m", "meshonet_cli", "models"), None),
}
"""What is started, and the seconds that it may take."""


def seconds(arguments: tuple[str, ...], runs: int) -> list[float]:
    """Return how long each of `runs` fresh processes takes, after one that fills the disc's cache."""
    spent = []
    for _ in range(runs + 1):
        begun = time.perf_counter()
        subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True)
        spent.append(time.perf_counter() - begun)
    return spent[1:]


def main() -> None:
    """Print a line for each."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    print(f"{'':24} median    least    limit")
    for name, (arguments, limit) in LIMITS.items():
        spent = seconds(arguments, runs)
        middle, least = statistics.median(spent), min(spent)
        verdict = "" if limit is None else f"{limit:6.3f} s {'' if middle <= limit else 'EXCEEDED'}"
        print(f"{name:24} {middle:.3f} s  {least:.3f} s  {verdict}".rstrip())


if __name__ == "__main__":
    main()
