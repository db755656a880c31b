"""What all HTML files from here have: a document in one file."""

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
"""The document around a title, a style and a body."""


def document(title: str, style: str, body: str) -> str:
    """Return an HTML document; `style` and `body` are inserted unescaped."""
    return _PAGE.format(title=html.escape(title), style=style, body=body)


def file_text(package: str, name: str) -> str:
    """Return a text file that lies in a package."""
    return (files(package) / name).read_text(encoding="utf-8")
