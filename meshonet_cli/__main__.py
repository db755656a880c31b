"""The program: ``meshonet``, or ``python -m meshonet_cli``."""

import sys
from typing import NoReturn


def main() -> NoReturn:
    """Run the command line; an interrupt while it is being loaded ends it as quietly as a later one."""
    try:
        from meshonet_cli.app import main as run

        run()
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        sys.exit(130)


if __name__ == "__main__":
    main()
