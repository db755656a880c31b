"""The command line: from words to function calls."""

import os

# The matrix products on the command line's paths are too small to share out: on a busy machine OpenBLAS's
# threads wait for each other and a grid takes ten times as long. Set before numpy is imported; the user's
# own setting stands.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
