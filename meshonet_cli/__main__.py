"""The program ``meshonet``, or ``python -m meshonet_cli``."""

import gc
import sys
from typing import NoReturn

_NEW = 100_000  # objects, twice those of modules, after which cycles are searched: a tenth of short runs


def main() -> NoReturn:
    """Run the command line; an interrupt ends it without a traceback, even while modules are loaded."""
    gc.set_threshold(_NEW)
    try:
        from meshonet_cli.app import main as run

        run()
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        sys.exit(130)
    finally:
        gc.freeze()  # else the interpreter's last search for cycles goes through every module: 0.03 s


if __name__ == "__main__":
    main()
