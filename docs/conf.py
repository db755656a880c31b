"""Settings of the documentation site (Sphinx): make site."""

import os
import shutil
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

import meshonet

os.environ.setdefault("MPLBACKEND", "agg")

project = "meshonet"
author = "the meshonet authors"
copyright = "the meshonet authors, MIT licence"  # noqa: A001 - Sphinx's name
version = release = meshonet.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "numpydoc",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "sphinx-mathjax-offline",
]
exclude_patterns = ["**/README*"]
nitpicky = True
nitpick_ignore_regex = [("py:obj", ".*")]  # `names` in docstrings: links where there is a page
default_role = "autolink"
suppress_warnings = ["config.cache"]  # the scraper below is a function

# --- for readers without the source; made anew each time, and read by tutorials/index.md
with ZipFile(Path(__file__).parent / "examples.zip", "w", ZIP_DEFLATED) as archive:
    examples = Path(__file__).parents[1] / "examples"
    for path in sorted(path for path in examples.rglob("*") if "__pycache__" not in path.parts):
        archive.write(path, path.relative_to(examples.parent))

# --- pages
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 4
highlight_language = "text"
copybutton_prompt_text = "$ "

# --- Python reference, from docstrings
autosummary_generate = True
autodoc_typehints = "none"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
add_module_names = False

# --- how it looks; nothing is loaded from elsewhere
templates_path = ["templates"]
html_theme = "pydata_sphinx_theme"
html_title = "meshonet"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = html_show_sourcelink = False
html_theme_options = {
    "header_links_before_dropdown": 8,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "tango",
    "pygments_dark_style": "monokai",
}


def written_pictures(block: Any, variables: dict[str, Any], settings: dict[str, Any]) -> str:
    """Move the PNG files that a block of an example wrote into the gallery, after matplotlib's figures."""
    from sphinx_gallery.scrapers import figure_rst, matplotlib_scraper

    shown: str = matplotlib_scraper(block, variables, settings)
    names = []
    for path in sorted(
        Path(variables["src_file"]).parent.glob("*.png"), key=lambda each: each.stat().st_mtime
    ):
        names.append(next(variables["image_path_iterator"]))
        shutil.move(path, names[-1])
    return shown + figure_rst(names, settings["src_dir"]) if names else shown


sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery/python",
    "image_scrapers": (written_pictures,),
    "within_subsection_order": "FileNameSortKey",
    "show_memory": False,
    "write_computation_times": False,
    "show_signature": False,
    "download_all_examples": False,
    "copyfile_regex": r".*\.(toml|dat|csv)",
    "min_reported_time": 1000,
    "remove_config_comments": True,
    "abort_on_example_error": True,
}
