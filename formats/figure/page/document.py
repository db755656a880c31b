"""HTML documents that consist of a single file."""

import html
from importlib.resources import files

_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{style}
</style>
</head>
<body>
{body}
</body>
</html>
"""
"""Template of a document with title, style and body."""


def document(title: str, style: str, body: str) -> str:
    """Return an HTML document; `style` and `body` are inserted unescaped."""
    return _PAGE.format(title=html.escape(title), style=style, body=body)


def file_text(package: str, name: str) -> str:
    """Return the content of a text file in a package."""
    return (files(package) / name).read_text(encoding="utf-8")
