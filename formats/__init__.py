"""Bytes to boundaries and grids and back, one module a format."""

if __name__ == "formats":
    raise ImportError("import meshonet.formats in place of formats: one file would be two modules")
