#!/usr/bin/env python3
"""Rejects unidiomatic wording: the patterns of tools/words.txt.

    tools/check_words.py                  the whole repository
    tools/check_words.py FILE ...         only these files
    tools/check_words.py --new [REF]      only the lines added since REF (default: the merge base
                                          with main, or HEAD~1 on main itself)

It reads comments, docstrings and string literals of C++, Python, JavaScript, CMake and shell, and
the prose of Markdown. A line that contains "words-ok" is exempt: use it to quote something.

Exit code: 0 no hits, 1 hits, 2 wrong usage.
"""

import argparse
import bisect
import collections
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
PATTERNS = ROOT / "tools" / "words.txt"
MARKER = "words-ok"

# Generated files, other people's text, data and history. docs/options.md is generated from the help
# texts in the sources, which are checked.
EXEMPT = re.compile(r"(^|/)(third_party|data|node_modules|build)/|^viewer/dist/|^CHANGELOG\.md$"
                    r"|^docs/options\.md$|(^|/)(LICEN[CS]E|THIRD_PARTY_NOTICES)[^/]*$|^\.git/")

# No pattern matches across this character, which replaces code.
CODE = "\0"

LANGUAGES = {
    ".h": "c", ".cpp": "c", ".inc": "c", ".cpp.in": "c", ".js": "js", ".mjs": "js", ".py": "python",
    ".cmake": "cmake", ".cmake.in": "cmake", ".sh": "shell", ".sbatch": "shell", ".md": "markdown",
}
BY_NAME = {"CMakeLists.txt": "cmake", ".ci/run": "shell"}

# Every alternative consumes one comment or string, or code that could be mistaken for one. Each
# begins with a plain character outside of its group, which makes the search several times faster.
TOKENS = {
    "c": re.compile(r'''
        \#(?P<skip>[ \t]*include[^\n]*)
      | /(?P<comment>/(?:\\\n|[^\n])*)
      | /(?P<block>\*.*?\*/)
      | R(?P<raw>"(?P<fence>[^()\\\s]{0,16})\(.*?\)(?P=fence)")
      | "(?P<string>(?:\\.|[^"\\\n])*")
      | '(?P<character>(?<![0-9a-fA-F]')(?:\\[^\n]{1,10}?|[^'\\\n])')
        ''', re.X | re.S),
    "js": re.compile(r'''
        /(?P<comment>/(?<![:\\]//)[^\n]*)
      | /(?P<block>\*.*?\*/)
      | "(?P<string>(?:\\.|[^"\\\n])*")
      | '(?P<quoted>(?:\\.|[^'\\\n])*')
      | `(?P<template>(?:\\.|[^`\\])*`)
        ''', re.X | re.S),
    "python": re.compile(r'''
        \#(?P<comment>[^\n]*)
      | "(?P<raw>"{2}.*?"{3})
      | '(?P<docstring>'{2}.*?'{3})
      | "(?P<string>(?:\\.|[^"\\\n])*")
      | '(?P<quoted>(?:\\.|[^'\\\n])*')
        ''', re.X | re.S),
    "cmake": re.compile(r'''
        \#(?P<comment>[^\n]*)
      | \[(?P<skip>(?P<fence>=+)\[.*?\](?P=fence)\])
      | "(?P<string>(?:\\.|[^"\\])*")
        ''', re.X | re.S),
    "shell": re.compile(r'''
        \\(?P<skip>.)
      | \#(?P<comment>(?<![^\s;(]\#)[^\n]*)
      | "(?P<string>(?:\\.|[^"\\])*")
      | '(?P<quoted>[^']*')
        ''', re.X | re.S),
}
COMMENT_LEADER = re.compile(r"///?<?!?|\#+!?")
BLOCK_LEADER = re.compile(r"^[ \t]*\*+(?!/)|/\*+|\*+/", re.M)
MARKDOWN_CODE = re.compile(r"""
    ^(?P<indent>[ \t]*(?:[-*>][ \t]+)?)(?P<fence>```+|~~~+)[^\n]*\n.*?
        (?:^[ \t>]*(?P=fence)[`~]*[ \t]*$|\Z)
  | (?P<ticks>`+)(?!`).+?(?<!`)(?P=ticks)(?!`)
  | \]\([^)\s]*\)
  | <!--.*?-->
  | https?://[^\s)>]+
    """, re.X | re.S | re.M)


# A sentence begins after this, as does a comment or a string.
SENTENCE_END = re.compile(r"(^|[\0.:;!?]|\n\s*\n)\s*$|^\s*$")


class Pattern:
    """One entry of tools/words.txt: the pattern, its replacement, an example of both.

    The words are a regular expression over lower-case text. A space matches any white space,
    "^" the beginning of a sentence; only whole words match. `pages_only`: only Markdown is checked."""

    def __init__(self, words, hint, bad, good, pages_only=False):
        self.words, self.hint, self.bad, self.good = words, hint, bad, good
        self.pages_only = pages_only
        self.starts_sentence = words.startswith("^")
        # A leading \b would be slow: find() tests it instead.
        self.regex = re.compile(words.lstrip("^").replace(" ?", r"\s*").replace(" ", r"\s+")
                                + r"(?![\w-])")

    def find(self, text):
        """(start, end) of every match in a lower-case text."""
        for match in self.regex.finditer(text):
            start = match.start()
            if start and (text[start - 1].isalnum() or text[start - 1] in "_-/"):
                continue
            if not self.starts_sentence or SENTENCE_END.search(text, max(0, start - 9), start):
                yield start, match.end()


def read_patterns(path=PATTERNS):
    """The patterns of a file of "avoid", "write", "bad" and "good" lines, in blocks of four.

    "avoid in pages" begins a pattern that is only for Markdown."""
    patterns, block, pages_only = [], {}, False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        key, _, value = line.partition(":")
        expected = ("avoid", "write", "bad", "good")[len(block)]
        if not block:
            pages_only = key == "avoid in pages"
            key = "avoid" if pages_only else key
        if key != expected or not value.strip():
            raise ValueError(f"{path.name}:{number}: expected \"{expected}: ...\"")
        block[key] = value.strip()
        if len(block) == 4:
            patterns.append(Pattern(*block.values(), pages_only))
            block = {}
    if block:
        raise ValueError(f"{path.name}: the last entry is incomplete")
    return patterns


def language(name):
    """Returns the language of a file by its path; None for files that are not checked."""
    if EXEMPT.search(name):
        return None
    base = name.rsplit("/", 1)[-1]
    known = BY_NAME.get(name) or BY_NAME.get(base)
    if known:
        return known
    return next((LANGUAGES[end] for end in sorted(LANGUAGES, key=len, reverse=True)
                 if base.endswith(end)), None)


def blanked(match):
    return " " * len(match[0])


def pieces(text, kind):
    """(start, prose) of the comments and strings of a text, or of the prose of a page.

    Comment leaders and quotes are left out, and a string's "\\n" is a space."""
    if kind == "markdown":
        end = 0
        for match in MARKDOWN_CODE.finditer(text):
            yield end, text[end:match.start()]
            end = match.end()
        yield end, text[end:]
        return
    for match in TOKENS[kind].finditer(text):
        found, start, group = match[0], match.start(), match.lastgroup
        if group == "comment":
            leader = COMMENT_LEADER.match(found).end()
            yield start + leader, found[leader:]
        elif group == "block":
            yield start, BLOCK_LEADER.sub(blanked, found)
        elif group not in ("skip", "character"):
            quote = 3 if group in ("raw", "docstring") else 1
            if found.startswith("R"):
                quote = found.index("(") + 1
            yield start + quote, found[quote:-1].replace("\\n", "  ").replace('"', " ")


def prose(text, kind):
    """The prose of a text in lower case, and [(offset in the prose, offset in the text)] per piece.

    Only space separates the lines of a comment and adjacent literals; CODE separates all others."""
    parts, places, length, end = [], [], 0, 0
    for start, piece in pieces(text, kind):
        gap = text[end:start].strip(" \t\n\"'/<!#")
        parts.append(CODE if gap else " ")
        places.append((length + 1, start))
        lower = piece.lower()
        parts.append(lower if len(lower) == len(piece) else piece)
        length += 1 + len(piece)
        end = start + len(piece)
    return "".join(parts), places


Hit = collections.namedtuple("Hit", "file line column last_line words hint")


def source_place(places, place):
    """Maps an offset in the prose to an offset in the text."""
    there, here = places[bisect.bisect_right(places, (place, sys.maxsize)) - 1]
    return here + place - there


def check_text(name, text, kind, patterns):
    """All hits in one text, in order, overlapping ones once."""
    checked, places = prose(text, kind)
    spans = sorted((start, -end, pattern.hint)
                   for pattern in patterns if kind == "markdown" or not pattern.pages_only
                   for start, end in pattern.find(checked))
    if not spans:
        return []
    line_starts = [0] + [match.end() for match in re.finditer("\n", text)]
    lines = text.splitlines()
    hits, covered = [], -1
    for start, end, hint in spans:
        end = -end
        if start < covered:
            continue
        covered = end
        begin, last = source_place(places, start), source_place(places, end - 1)
        first = bisect.bisect_right(line_starts, begin) - 1
        last = bisect.bisect_right(line_starts, last) - 1
        if any(MARKER in line for line in lines[first:last + 1]):
            continue
        words = " ".join(checked[start:end].split())
        hits.append(Hit(name, first + 1, begin - line_starts[first] + 1, last + 1, words, hint))
    return hits


def git(*arguments):
    """Returns the output of git; None if it fails."""
    done = subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else None


def repository_files():
    """Returns the paths of all checked files; walks the folders of an archive without git."""
    listed = git("ls-files", "--cached", "--others", "--exclude-standard")
    if listed is not None and listed:
        names = listed.splitlines()
    else:
        names = []
        for folder, folders, files in os.walk(ROOT):
            folders[:] = [each for each in folders if each not in ("build", ".git", "node_modules")]
            here = pathlib.Path(folder).relative_to(ROOT)
            names += [(here / each).as_posix() for each in files]
    return sorted(name for name in set(names) if language(name) and (ROOT / name).is_file())


def check_files(names, patterns):
    hits = []
    for name in names:
        text = (ROOT / name).read_text(encoding="utf-8", errors="replace")
        hits += check_text(name, text, language(name) or "markdown", patterns)
    return hits


def added_lines(ref):
    """Returns {file: line numbers} added since a commit, including uncommitted changes."""
    diff = git("diff", "-U0", "--no-color", "--no-ext-diff", ref, "--")
    if diff is None:
        raise ValueError(f"--new: git has no commit \"{ref}\"")
    added, name = collections.defaultdict(set), None
    for line in diff.splitlines():
        if line.startswith("+++ "):
            name = line[6:] if line.startswith("+++ b/") else None
        match = re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", line)
        if match and name:
            first, count = int(match[1]), int(match[2] or 1)
            added[name].update(range(first, first + count))
    return added


def default_ref():
    """Returns the merge base of this branch and main; on main, the previous commit."""
    head = (git("rev-parse", "HEAD") or "").strip()
    for main in ("origin/main", "main"):
        base = (git("merge-base", "HEAD", main) or "").strip()
        if base and base != head:
            return base
    return "HEAD~1"


def show(hits):
    for hit in hits:
        print(f"{hit.file}:{hit.line}:{hit.column}: \"{hit.words}\": write {hit.hint}")


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", metavar="FILE", help="check these files")
    parser.add_argument("--new", nargs="?", const="", metavar="REF",
                        help="only lines added since REF")
    options = parser.parse_args(arguments)
    try:
        patterns = read_patterns()
        if options.new is not None:
            added = added_lines(options.new or default_ref())
            hits = [hit for hit in check_files([name for name in added if language(name)
                                                and (ROOT / name).is_file()], patterns)
                    if added[hit.file].intersection(range(hit.line, hit.last_line + 1))]
        elif options.files:
            names = [os.path.relpath(os.path.abspath(name), ROOT) for name in options.files]
            hits = check_files(names, patterns)
        else:
            hits = check_files(repository_files(), patterns)
    except (OSError, ValueError) as error:
        print(f"words: {error}", file=sys.stderr)
        return 2
    show(hits)
    print(f"words: {len(hits)} hits" if hits else "words: clean")
    return 1 if hits else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
