"""How Sphinx renders the site of `make site`, whose pages tools/site.py lays out. All of it works offline."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx import addnodes
from sphinx.ext import autosummary

import stepover

if TYPE_CHECKING:
    from sphinx.application import Sphinx

PACKAGE = Path(stepover.__file__).parent

project, author, version = "stepover", "the stepover authors", stepover.__version__
copyright = author
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon"]
root_doc = "index"
smartquotes = False  # --help is no dash

myst_enable_extensions = ["dollarmath", "html_image"]
myst_heading_anchors = 3
nb_execution_mode = "off"
nb_render_markdown_format = "myst"  # in outputs too: tables, formulas
nb_ipywidgets_js = {}  # would be loaded from a host

highlight_language = "text"
default_role = "code"  # docstrings write `name`
autodoc_default_options = {"members": True, "ignore-module-all": True}
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
napoleon_numpy_docstring = False
napoleon_use_param = False  # "a, b: what both are" stays one line
napoleon_custom_sections = [("Attributes", "params_style")]  # described once, in the docstring of their class
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 100
templates_path = [str(Path(__file__).parent)]  # autosummary takes a relative one from the pages
autosummary.WELL_KNOWN_ABBREVIATIONS += "Sec.", "Secs.", "Fig.", "Figs.", "Eq.", "Eqs."  # end no sentence
autosummary_context = {
    "packages": [".".join(path.parent.relative_to(PACKAGE.parent).parts) for path in PACKAGE.rglob("__init__.py")]
}

html_theme = "furo"
html_title = f"stepover {version}"
html_static_path = ["site.css"]
html_css_files = ["site.css"]
html_copy_source = html_show_sphinx = html_show_copyright = False
html_math_renderer = "mathml"


def _inline(writer: Any, node: nodes.math) -> None:
    """A formula in the text."""
    writer.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.math_block) -> None:
    """A formula on its own."""
    writer.body.append(f"<div>{tex2mathml(node.astext(), as_block=True)}</div>")
    raise nodes.SkipNode


def _link_files(app: Sphinx, doctree: nodes.document) -> None:
    """Open a linked file of the repository where the site has it, a module at its place in the reference."""
    page = Path(app.env.docname).parent
    for node in list(doctree.findall(addnodes.download_reference)):
        file, _ = app.env.relfn2path(node["reftarget"], app.env.docname)
        module = ".".join(Path(file).with_suffix("").parts)
        target = f"api/{module.rpartition('.')[0]}.html#module-{module}" if file.endswith(".py") else file
        node.replace_self(nodes.reference("", "", *node.children, refuri=os.path.relpath(target, page)))


def _keep_colons(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Keep napoleon from taking what stands before a colon in the first line on a value for its type."""
    if what in ("attribute", "data", "property"):
        lines.insert(0, "")


def _skip(app: Sphinx, what: str, name: str, obj: Any, skip: bool, options: Any) -> bool | None:
    """Leave out what Python itself says of the fields of a named tuple; their class says more."""
    return True if str(getattr(obj, "__doc__", "")).startswith("Alias for field number") else None


def setup(app: Sphinx) -> None:
    """Formulas as MathML, which every browser shows by itself; links to files."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.connect("autodoc-skip-member", _skip)
    app.connect("autodoc-process-docstring", _keep_colons, priority=100)
    app.connect("doctree-read", _link_files, priority=100)  # before Sphinx collects downloads
