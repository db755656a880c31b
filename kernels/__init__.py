"""Compiled arithmetic: all C of the project, bound by one extension module, ``_native``.

A folder is a subject: its C sources, and a ``.pxi`` file with what Python sees of them. Arrays are checked
there, once; functions fill arrays that their callers made.
"""

if __name__ == "kernels":
    raise ImportError("import meshonet.kernels in place of kernels: one file would be two modules")
