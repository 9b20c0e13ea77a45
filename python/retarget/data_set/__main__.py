"""Statistics of a data set as one page: python -m retarget.data_set out/ statistics.html."""

from __future__ import annotations

import argparse
import sys

from retarget._errors import Error
from retarget.data_set.page import write_page


def main(arguments: list[str] | None = None) -> int:
    """Runs the command; returns its exit code: 0, or 1 after an error, which it prints."""
    parser = argparse.ArgumentParser(prog="python -m retarget.data_set",
                                     description="Writes statistics of a data set as one page.")
    parser.add_argument("folder", help="output folder with a manifest")
    parser.add_argument("page", help="HTML file to write")
    parser.add_argument("--no-near-duplicates", action="store_true",
                        help="do not search for clips that show the same motion")
    given = parser.parse_args(arguments)
    try:
        write_page(given.folder, given.page, near_duplicates=not given.no_near_duplicates)
    except Error as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
