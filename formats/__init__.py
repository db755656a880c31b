"""File formats of boundaries and grids: a module or a folder each."""

if __name__ == "formats":
    raise ImportError("import meshonet.formats in place of formats: one file would be two modules")
