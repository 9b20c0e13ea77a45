"""The notebook runs, and the site of the documentation is complete."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import retarget
from optional import need

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOK = ROOT / "docs/notebooks/training_set.ipynb"
BUILD = Path(retarget.__file__).absolute().parents[2]
pytestmark = [
    pytest.mark.skipif(not NOTEBOOK.is_file(), reason="the documentation is missing"),
    pytest.mark.skipif("LD_PRELOAD" in os.environ, reason="a sanitizer does not start in a kernel"),
]


@pytest.fixture(scope="module")
def sources():
    """Imports tools/docs_site."""
    need("nbclient", folder="docs")
    need("ipykernel", folder="docs")
    need("jsonschema")
    sys.path.insert(0, str(ROOT / "tools/docs_site"))
    yield importlib.import_module
    sys.path.remove(str(ROOT / "tools/docs_site"))


@pytest.fixture(scope="module")
def site(sources, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Builds the site without a problem."""
    need("pyarrow")
    for name in ("pdoc", "markdown_it"):
        need(name, folder="docs")
    folder = tmp_path_factory.mktemp("site") / "site"
    made = build_site(folder)
    assert made.returncode == 0 and not made.stderr, made.stderr
    return folder


def build_site(folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([ROOT / "tools/docs_site.sh", folder, BUILD], text=True, capture_output=True, timeout=400,
                          env={**os.environ, "RETARGET_PYTHON": sys.executable})


def test_the_notebook_is_stored_without_outputs() -> None:
    text = NOTEBOOK.read_text(encoding="utf-8")
    book = json.loads(text)
    assert text == json.dumps(book, indent=1, ensure_ascii=False) + "\n"
    cells = [cell for cell in book["cells"] if cell["cell_type"] == "code"]
    assert len(cells) >= 10
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells)
    assert sorted(book["metadata"]) == ["kernelspec", "language_info"]


def test_the_notebook_makes_a_training_set(sources) -> None:
    need("pyarrow")
    cells = sources("notebook").executed(NOTEBOOK).cells

    def outputs(start: str) -> list:
        return next(cell for cell in cells if start in cell.source).outputs

    assert all(output.get("name") != "stderr" for cell in cells for output in cell.get("outputs", []))
    assert "passed</caption>" in outputs("retarget.evaluate")[0].data["text/html"]
    assert outputs("retarget.view")[0].data["text/html"].startswith("<iframe srcdoc=")
    clips = eval(outputs("retarget.batch")[0].data["text/plain"])
    assert [status for _, status, _, _ in clips] == 5 * ["done"]
    passed = [frames for _, _, frames, missed in clips if not missed]
    shape, lengths = eval(outputs("bincount")[0].data["text/plain"])
    assert shape == (sum(lengths), 36) and sorted(lengths) == sorted(passed) and len(passed) >= 4
    assert "Data set motions" in outputs("write_page")[0].data["text/html"]


def test_every_public_name_is_documented(site: Path, sources) -> None:
    modules = sources("api").MODULES
    package = Path(retarget.__file__).parent
    folders = {f"retarget.{file.parent.name}" for file in package.glob("*/__init__.py")}
    files = {f"retarget.{file.stem}" for file in package.glob("*.py") if not file.stem.startswith("_")}
    assert set(modules) == {"retarget", *folders, *files}
    for name in modules:
        module = importlib.import_module(name)
        page = (site / "api" / f"{name.replace('.', '/')}.html").read_text(encoding="utf-8")
        assert module.__doc__, name
        assert getattr(module, "__all__", None), name
        for public in set(module.__all__) - {"edit"}:
            section = page.partition(f'<section id="{public}">')[2].partition("</section>")[0]
            assert section, f"{name}.{public} is not in the site"
            assert '<div class="docstring">' in section, f"{name}.{public} has no docstring"


def test_pages_have_their_contents(site: Path) -> None:
    names = {file.stem for file in (ROOT / "docs").glob("*.md")} - {"README"} | {"index"}
    assert names == {file.stem for file in site.glob("*.html")}
    index = (site / "index.html").read_text()
    assert 'href="api/retarget.html"' in index and 'href="notebooks/training_set.html"' in index
    assert "<table>" in (site / "data_sets.html").read_text()
    assert "srcdoc=" in (site / "notebooks/training_set.html").read_text()
    to_robot = (site / "api/retarget.html").read_text().partition('<section id="to_robot">')[2].partition("</section>")[0]
    assert "<strong>start</strong> (<code>" in to_robot and 'href="../robots.html"' not in to_robot
    assert 'href="../quality.html"' in (site / "api/retarget.html").read_text()
    assert "retarget" in (site / "api/search.js").read_text()


def test_the_checker_finds_broken_pages(sources, tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(
        '<h1 id="one"><a href="b.html#two">b</a><a href="a.html#one">a</a><a href="#three">3</a>'
        '<a href="https://example.org">web</a><a href="c.html">c</a><img src="data:image/png;base64,AA">'
        '<script src="https://example.org/x.js"></script><link rel=stylesheet href="//example.org/x.css">')
    (tmp_path / "b.html").write_text("<p>")
    (tmp_path / "x.css").write_text("@font-face { src: url('https://example.org/x.woff') }")
    assert sources("links").problems(tmp_path) == [
        "a.html: there is no anchor b.html#two", "a.html: there is no anchor #three", "a.html: there is no c.html",
        "a.html: loads https://example.org/x.js", "a.html: loads //example.org/x.css",
        "x.css: loads https://example.org/x.woff"]


def test_a_link_to_nothing_is_a_problem(sources, tmp_path: Path) -> None:
    docs = tmp_path / "docs"
    docs.mkdir()
    (docs / "README.md").write_text("# Documentation\n\n## How to\n\n* [a.md](a.md): a\n")
    (docs / "a.md").write_text("# A\n\n[b](b.md), [c](../c.txt), [d](d.md#d)\n")
    (docs / "d.md").write_text("# D\n")
    (tmp_path / "c.txt").write_text("text")
    (tmp_path / "site").mkdir()
    site = sources("pages").Site(tmp_path, tmp_path / "site")
    site.write()
    assert site.problems == ["docs/d.md: docs/README.md has no link to it", "docs/a.md: there is no b.md"]
    assert (tmp_path / "site/repository/c.txt.html").is_file()


def test_other_folders_are_not_replaced(site: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert "is not an earlier site" in build_site(tmp_path).stderr
    assert (tmp_path / "mine.txt").read_text() == "mine"
