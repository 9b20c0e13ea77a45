"""Links of a site: all lead to existing pages and anchors, and no page loads anything from the web."""

from __future__ import annotations

import os
import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

_WEB = re.compile(r"[a-z][a-z0-9+.-]*:|//", re.I)
# Attributes whose URL a browser opens only on a click.
_CLICKED = frozenset({("a", "href"), ("form", "action")})
_URLS = frozenset({"href", "src", "srcset", "data", "poster", "action"})


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[tuple[str, str, str]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for key, value in attrs:
            if key in ("id", "name") and value:
                self.anchors.add(value)
            if key in _URLS and value is not None:
                self.links.append((tag, key, value))


def problems(folder: Path) -> list[str]:
    """Returns a line per broken link and per file from the web."""
    pages: dict[str, _Reader] = {}
    for file in sorted(folder.rglob("*.html")):
        reader = pages[os.path.relpath(file, folder)] = _Reader()
        reader.feed(file.read_text(encoding="utf-8"))
    found = []
    for page, reader in pages.items():
        for tag, key, link in reader.links:
            if _WEB.match(link):
                if (tag, key) not in _CLICKED and not link.startswith("data:"):
                    found.append(f"{page}: loads {link}")
                continue
            path, _, anchor = link.partition("#")
            path = path.partition("?")[0]
            target = os.path.normpath(os.path.join(os.path.dirname(page), unquote(path))) if path else page
            if not (folder / target).is_file():
                found.append(f"{page}: there is no {link}")
            elif anchor and target in pages and unquote(anchor) not in pages[target].anchors:
                found.append(f"{page}: there is no anchor {link}")
    for style in sorted(folder.rglob("*.css")):
        found += [f"{style.name}: loads {url}" for url in re.findall(
            r"url\(\s*[\"']?((?:https?:)?//[^)\"']*)", style.read_text(encoding="utf-8"))]
    return found
