"""Builds the site of the documentation: `build.py FOLDER` (see tools/docs_site.sh).

The site has the pages of docs/, the notebooks with the outputs of a new run, and the reference of
the Python package. Every problem is a line on standard error and makes the exit code 1.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import warnings
from pathlib import Path

import api
import links
from pages import Site

ROOT = Path(__file__).resolve().parents[2]


def build(folder: Path) -> list[str]:
    """Writes the site; returns its problems."""
    folder.mkdir()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        site = Site(ROOT, folder)
        site.write()
        api.write(folder / "api")
    return [str(each.message) for each in caught] + site.problems + links.problems(folder)


def main() -> int:
    parser = argparse.ArgumentParser(prog="tools/docs_site.sh", description="Builds the site of the documentation.")
    parser.add_argument("folder", type=Path, help="folder of the site; an earlier site is replaced")
    folder: Path = parser.parse_args().folder
    if folder.exists() and any(folder.iterdir()) and not (folder / "api/retarget.html").exists():
        parser.error(f"{folder} exists and is not an earlier site")
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".site.") as temporary:
        unfinished = Path(temporary) / "site"
        problems = build(unfinished)
        shutil.rmtree(folder, ignore_errors=True)
        unfinished.replace(folder)
    for problem in problems:
        print(f"docs_site: {problem}", file=sys.stderr)
    if problems:
        return 1
    print(f"{len(list(folder.rglob('*.html')))} pages: {folder / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
