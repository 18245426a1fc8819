"""Check the links of a site: missing targets, and anything that a page would load from the network."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LINKS = {"a": "href", "area": "href", "form": "action"}
"""Attributes of links that a reader may follow, by tag. All other addresses are loaded with the page."""
LOADED = {"src", "href", "poster", "data", "srcset", "background"}
NAVIGATION = {"next", "prev", "search", "index", "author", "license", "canonical", "alternate", "genindex"}
"""Relations of a <link> that load nothing."""
IN_STYLE = re.compile(r"""url\(\s*["']?([^"')]+)|@import\s+["']([^"']+)""")


@dataclass
class _Page(HTMLParser):
    """The links of a page, and its anchors.

    Attributes:
        ids: its anchors.
        links: addresses that a reader may follow.
        loaded: addresses that the page loads.
    """

    ids: set[str] = field(default_factory=set)
    links: list[str] = field(default_factory=list)
    loaded: list[str] = field(default_factory=list)
    _style: bool = False

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Sort the addresses of a tag."""
        found = {name: value or "" for name, value in attrs}
        self._style = tag == "style"
        self.ids |= {found[name] for name in ("id", "name") if found.get(name) and (name == "id" or tag == "a")}
        self.loaded += in_style(found.get("style", ""))
        goes = tag in LINKS or (tag == "link" and set(found.get("rel", "").split()) <= NAVIGATION)
        for name in LOADED | {LINKS.get(tag, "href")}:
            if name in found:
                one = [part.split()[0] for part in found[name].split(",") if part.split()]
                (self.links if goes else self.loaded).extend(one if name == "srcset" else [found[name]])

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Like an opening tag, but without content."""
        self.handle_starttag(tag, attrs)
        self._style = False

    def handle_endtag(self, tag: str) -> None:
        """Leave a style."""
        self._style = False

    def handle_data(self, data: str) -> None:
        """Addresses in a style."""
        if self._style:
            self.loaded += in_style(data)


def in_style(text: str) -> list[str]:
    """Addresses that a style sheet loads."""
    return [one or two for one, two in IN_STYLE.findall(text)]


def faults(site: Path) -> list[str]:
    """Every broken link and every resource from the network, one line each, as "page: fault"; none if all is well."""
    pages = {path.resolve(): _read(path) for path in sorted(site.rglob("*.html"))}
    if not pages:
        return [f"{site}: no pages"]
    found: list[str] = []
    for path, page in pages.items():
        found += [
            f"{path.relative_to(site.resolve())}: {fault}" for fault in _faults(path, page, pages, site.resolve())
        ]
    for sheet in sorted(site.rglob("*.css")):
        wrong = (_fault(address, True, sheet.resolve(), {}, site.resolve()) for address in in_style(sheet.read_text()))
        found += [f"{sheet.relative_to(site)}: {fault}" for fault in wrong if fault]
    return found


def _read(path: Path) -> _Page:
    """A page, parsed."""
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    page.close()
    return page


def _faults(path: Path, page: _Page, pages: dict[Path, _Page], site: Path) -> Iterator[str]:
    """The faults of a page, each address once."""
    for addresses, loaded in ((page.links, False), (page.loaded, True)):
        for address in dict.fromkeys(addresses):
            fault = _fault(address, loaded, path, pages, site)
            if fault:
                yield fault


def _fault(address: str, loaded: bool, path: Path, pages: dict[Path, _Page], site: Path) -> str:
    """The fault of an address in a file; "" if there is none."""
    parts = urlsplit(address)
    if parts.scheme == "data" or (not loaded and parts.scheme in ("http", "https", "mailto")):
        return ""
    if parts.scheme or parts.netloc:
        return f"loads {address}" if loaded else f"leads to {address}"
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if target.is_dir():
        return f"leads to the folder {address}"
    if not target.is_file() or not target.is_relative_to(site):
        return f"{address} is not there"
    anchor = unquote(parts.fragment)
    if anchor and target in pages and anchor not in pages[target].ids:
        return f"{address} has no such anchor"
    return ""
