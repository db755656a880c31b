"""Compiled arithmetic: all C of the project, bound by one extension module, ``_native``.

Each subject has a folder with its C sources and a ``.pxi`` file, which declares what Python can call and
checks all arrays. The functions write their results into arrays that the caller has made.
"""

if __name__ == "kernels":
    raise ImportError("import meshonet.kernels in place of kernels: one file would be two modules")
