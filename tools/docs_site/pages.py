"""Pages of Markdown and of source files, with links from page to page."""

from __future__ import annotations

import html
import os
import re
import shutil
from collections import Counter
from pathlib import Path
from urllib.parse import unquote

import pygments
from markdown_it import MarkdownIt
from markdown_it.token import Token
from pygments.formatters import HtmlFormatter
from pygments.lexers import TextLexer, get_lexer_by_name, get_lexer_for_filename
from pygments.util import ClassNotFound

import notebook

_STYLE = Path(__file__).with_name("style.css")
_PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} - retarget</title>
<link rel="stylesheet" href="{up}style.css">
<body>
<nav>
<p class="home"><a href="{up}index.html">retarget</a></p>
{contents}
</nav>
<main>
{body}
</main>
</body>
</html>
"""


def highlighted(code: str, language: str) -> str:
    """Returns HTML of code."""
    try:
        lexer = get_lexer_by_name(language)
    except ClassNotFound:
        lexer = TextLexer()
    return pygments.highlight(code, lexer, HtmlFormatter(nowrap=True))


def slug(heading: str) -> str:
    """Returns the anchor that GitHub and GitLab give to a heading."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


class Site:
    """Pages of docs/, and of all files of the repository that they link to."""

    def __init__(self, root: Path, folder: Path) -> None:
        self._root = root
        self._folder = folder
        self._markdown = MarkdownIt("commonmark", {
            "html": False,
            "highlight": lambda code, language, _: highlighted(code, language)})
        self._markdown.enable(["table", "strikethrough"])
        self.problems: list[str] = []
        """Links to nothing, and pages without a link in docs/README.md."""

    def write(self) -> None:
        """Writes all pages."""
        documents = sorted((self._root / "docs").glob("*.md"))
        waiting = [*documents, *sorted((self._root / "docs").glob("notebooks/*.ipynb"))]
        contents = self._contents()
        for file in waiting:
            if file.name != "README.md" and file not in [each for _, each in contents]:
                self.problems.append(f"{self._name(file)}: docs/README.md has no link to it")
        seen = set(waiting)
        while waiting:
            file = waiting.pop()
            body, targets = self._body(file)
            if body:
                self._write_page(file, body, contents)
            waiting += sorted(targets - seen)
            seen |= targets
        style = _STYLE.read_text() + HtmlFormatter().get_style_defs("code") + "\n"
        (self._folder / "style.css").write_text(style)

    def place(self, file: Path) -> Path:
        """Returns the path of a file's page, relative to the site."""
        name = self._name(file)
        if file.is_dir():
            return Path("repository") / name / "index.html"
        if name.parts[0] != "docs":
            return Path("repository") / name.with_name(f"{name.name}.html")
        inner = Path(*name.parts[1:])
        if inner == Path("README.md"):
            return Path("index.html")
        return inner.with_suffix(".html") if inner.suffix in (".md", ".ipynb") else inner

    def _name(self, file: Path) -> Path:
        return file.relative_to(self._root)

    def _body(self, file: Path) -> tuple[str, set[Path]]:
        """Returns the contents of a page and the files that it links to; "": copied as it is."""
        targets: set[Path] = set()
        if file.is_dir():
            targets = {each for each in file.iterdir() if not each.name.startswith("__")}
            items = (f'<li><a href="{self._link(each, file)}">{html.escape(each.name)}</a></li>'
                     for each in sorted(targets))
            return f"<h1>{html.escape(str(self._name(file)))}</h1><ul>{''.join(items)}</ul>", targets
        if file.suffix == ".md":
            return self._rendered(file.read_text(encoding="utf-8"), file, targets), targets
        if file.suffix == ".ipynb":
            cells = notebook.executed(file).cells
            return "\n".join(
                self._rendered(cell.source, file, targets) if cell.cell_type == "markdown"
                else notebook.cell_html(cell, highlighted(cell.source, "python"))
                for cell in cells), targets
        if self._name(file).parts[0] == "docs":
            copy = self._folder / self.place(file)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, copy)
            return "", targets
        return self._source(file), targets

    def _source(self, file: Path) -> str:
        code = file.read_text(encoding="utf-8")
        try:
            lexer = get_lexer_for_filename(file.name)
        except ClassNotFound:
            lexer = get_lexer_by_name("bash") if code.startswith("#!") else TextLexer()
        text = pygments.highlight(code, lexer, HtmlFormatter(nowrap=True))
        return f"<h1>{html.escape(str(self._name(file)))}</h1><pre><code>{text}</code></pre>"

    def _rendered(self, text: str, file: Path, targets: set[Path]) -> str:
        tokens = self._markdown.parse(text)
        anchors: Counter[str] = Counter()
        for heading, inline in zip(tokens, tokens[1:]):
            if heading.type == "heading_open":
                anchor = slug("".join(each.content for each in inline.children or []))
                again = f"-{anchors[anchor]}" if anchors[anchor] else ""
                heading.attrSet("id", anchor + again)
                anchors[anchor] += 1
        for token in [each for inline in tokens for each in inline.children or []]:
            for key in ("href", "src"):
                link = token.attrGet(key)
                if isinstance(link, str) and not re.match(r"[a-z]+:|#", link):
                    token.attrSet(key, self._followed(link, file, targets))
        return self._markdown.renderer.render(tokens, self._markdown.options, {})

    def _followed(self, link: str, file: Path, targets: set[Path]) -> str:
        """Returns the link between the pages of two files, and adds the target to `targets`."""
        path, hash_sign, anchor = link.partition("#")
        target = Path(os.path.normpath(file.parent / unquote(path)))
        if not target.exists() or not target.is_relative_to(self._root):
            self.problems.append(f"{self._name(file)}: there is no {link}")
            return link
        targets.add(target)
        return self._link(target, file) + hash_sign + anchor

    def _link(self, target: Path, file: Path) -> str:
        return os.path.relpath(self.place(target), self.place(file).parent)

    def _contents(self) -> list[tuple[str, Path | None]]:
        """Returns headings of docs/README.md (without a file) and the titles of its links."""
        index = self._root / "docs/README.md"
        rows: list[tuple[str, Path | None]] = []
        tokens = self._markdown.parse(index.read_text(encoding="utf-8"))
        for opening, inline in zip(tokens, tokens[1:]):
            if opening.type == "heading_open" and opening.tag == "h2":
                rows.append((inline.content, None))
            if opening.type == "paragraph_open":
                rows += [(self._title(file), file) for file in self._linked(inline, index)]
        return rows

    def _linked(self, inline: Token, index: Path) -> list[Path]:
        files = [index.parent / str(token.attrGet("href")) for token in inline.children or []
                 if token.type == "link_open"]
        return [file for file in files if file.exists()]

    def _title(self, file: Path) -> str:
        text = notebook.read(file).cells[0].source if file.suffix == ".ipynb" else file.read_text()
        found = re.search(r"^# (.*)", text, re.M)
        return found[1].replace("`", "") if found else file.stem

    def _write_page(self, file: Path, body: str, contents: list[tuple[str, Path | None]]) -> None:
        place = self.place(file)
        up = "../" * (len(place.parts) - 1)
        lines = []
        for title, target in contents:
            if target is None:
                lines.append(f"<h2>{html.escape(title)}</h2>")
                if title == "Reference":
                    lines.append(f'<a href="{up}api/retarget.html">Python API</a>')
            else:
                here = ' class="here"' if target == file else ""
                lines.append(f'<a{here} href="{self._link(target, file)}">{html.escape(title)}</a>')
        title = re.search(r"<h1[^>]*>(.*?)</h1>", body)
        target_file = self._folder / place
        target_file.parent.mkdir(parents=True, exist_ok=True)
        target_file.write_text(_PAGE.format(
            title=re.sub("<[^>]*>", "", title[1]) if title else place.stem, up=up,
            contents="\n".join(lines), body=body), encoding="utf-8")
