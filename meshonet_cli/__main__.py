"""Run the command line as ``python -m meshonet_cli``."""

from meshonet_cli.app import main

if __name__ == "__main__":
    main()
