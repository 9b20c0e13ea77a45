#!/usr/bin/env python3
"""Measures every marked value of README.md and docs/, and makes the pictures of docs/pictures.

    tools/docs_figures.py --tool build/release/tools/retarget/retarget             # write changed values
    tools/docs_figures.py --tool build/release/tools/retarget/retarget --check     # print changes, exit with 1

Values of LAFAN1 and of other data that may not be distributed are measured if the data are in $RETARGET_SHARED/data,
../shared/data or --data FOLDER (tools/quality_tables.py describes the folder); otherwise they do not change. Marks are
HTML comments, which a rendered page does not show:

    <!-- figure: stance_slip_mean of=get_up scale=1000 format=.1f -->0.7<!-- /figure --> mm/s
    <!-- table: clips method=gmr of=lafan1 -->
    <!-- /table -->
    <!-- speed: bench/compare_peers -->16,500<!-- /speed -->

A figure is a key of a quality report, or `gates` (the number of default gates), `robots` (the number of robots; with
`of=unverified` of those in robots/unverified), `verdict` (`22 of 22 gates passed`, as `evaluate` prints it), `passed` and `motions` (the number of
motions that pass all gates, and of all motions). `of` names clips, separated by commas: walk, samples, lafan1, cuts,
skeletons, walks. `method` is fit (the default), gmr, without-dynamics, as-published or published (Unitree's motions). `robot`
selects another robot than unitree_g1. `take` combines several clips: mean (the default), sum, min, max or range. `scale`
and `format` give the form of the number. No line may begin with the mark of a figure, because Markdown would show it as
text.

Tables are `clips` (one column per clip), `means robot=NAME` and `robots of=samples|walks`. Speeds depend on the machine:
the named program of bench/ measures them, docs/performance.md states them, and this script does not measure them.

Pictures need Chromium and numpy (tools/setup.sh); without them, pictures of pages do not change.
"""
import argparse
import difflib
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import quality_tables as tables  # noqa: E402  (beside this file)

SOURCE = pathlib.Path(__file__).resolve().parents[1]
PICTURES = SOURCE / "docs/pictures"
# Advice of the tests about outdated figures.
AGAIN = "measure them again: tools/docs_figures.py --tool TOOL"
# The gates that the pictures of pages show.
PAGES_FILE = PICTURES / "pages.json"
FIGURE = re.compile(r"<!-- figure: (?P<what>[^>]*?) -->(?P<text>.*?)<!-- /figure -->")
TABLE = re.compile(r"(?P<begin><!-- table: (?P<what>[^>]*?) -->\n)(?P<text>.*?)(?P<end><!-- /table -->)",
                   re.DOTALL)
SPEED = re.compile(r"<!-- speed: (?P<what>[^>]*?) -->(?P<text>.*?)<!-- /speed -->")
ANY_MARK = re.compile(r"<!-- /?(?:figure|table|speed)\b")
# Metrics that runs measure and files do not have, so that `evaluate` omits their gates.
OF_RUNS = ("solver_failures",)
TAKES = {"sum": sum, "min": min, "max": max, "mean": lambda values: sum(values) / len(values)}


class MarkError(ValueError):
    """A mark with an unknown or incomplete request."""


def documents():
    """Returns the files that may have marks."""
    return [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]


def shared_data():
    """Returns the folder of data that may not be distributed, or None if there is none."""
    for place in (os.environ.get("RETARGET_SHARED"), SOURCE.parent / "shared"):
        if place and (pathlib.Path(place) / "data/lafan1").is_dir():
            return pathlib.Path(place) / "data"
    return None


def parsed(what, allowed):
    """Returns the first word of a mark, and its options."""
    word, *rest = what.split()
    options = dict(each.partition("=")[::2] for each in rest)
    unknown = set(options) - set(allowed)
    if unknown:
        raise MarkError(f"{what}: unknown {', '.join(sorted(unknown))}")
    return word, options


class Fresh:
    """Makes texts of marks from new measurements; None if the data are missing."""

    def __init__(self, reports):
        self.reports, self.clips = reports, reports.clips

    def figure(self, what):
        """Returns the text of a figure, or None if its clips are missing."""
        name, options = parsed(what, ("of", "method", "robot", "take", "scale", "format"))
        if name == "gates":
            gates = json.loads((SOURCE / "configs/quality/default.json").read_text())["gates"]
            return str(len(gates))
        if name == "robots":
            folder = "unverified/*" if options.get("of") == "unverified" else "**"
            return str(len({file.parent for file in (SOURCE / "robots").glob(f"{folder}/robot.json")}))
        if "of" not in options:
            raise MarkError(f"{what}: of=CLIPS is missing")
        clips = self.clips.named(options["of"])
        if clips is None:
            return None
        in_dynamics = name in tables.DYNAMICS and name.startswith(("dynamics", "torque"))
        found = [self.reports.get(clip, options.get("robot", "unitree_g1"),
                                  options.get("method", "fit"), in_dynamics) for clip in clips]
        if tables.SKIPPED in found:
            return None
        return self._text(what, name, options, [each for each in found if each is not None])

    def _text(self, what, name, options, found):
        if name == "verdict":
            gates = [gate["passed"] for gate in found[0]["gates"] if gate["metric"] not in OF_RUNS]
            return f"{gates.count(True)} of {len(gates)} gates passed"
        if name in ("passed", "motions"):
            return str(sum(name == "motions" or not tables.missed_gates(each) for each in found))
        values = [tables.value(each, name) for each in found]
        values = [float(options.get("scale", 1)) * each for each in values if each is not None]
        if not values:
            raise MarkError(f"{what}: no motion has this figure")
        form = options.get("format", ".1f")
        if options.get("take") == "range":
            return f"{min(values):{form}} to {max(values):{form}}"
        return f"{TAKES[options.get('take', 'mean')](values):{form}}"

    def table(self, what, old):
        """Returns the lines of a table between its marks."""
        kind, options = parsed(what, ("of", "method", "robot"))
        clips = self.clips.named(options.get("of", "samples"))
        if kind == "means":
            table = tables.means_table(self.reports, options["robot"])
        elif clips is None:
            return old
        elif kind == "robots":
            table = tables.robots_table(self.reports, clips)
        elif kind == "clips":
            if options["method"] == "published":
                clips = [clip for clip in clips if self.clips.published(clip)]
            table = tables.clip_table(self.reports, clips, options["method"])
        else:
            raise MarkError(f"{what}: no such table")
        if all(cell is tables.SKIPPED for row in table.rows.values() for cell in row):
            return old
        lines = table.lines([line for line in old.splitlines() if line.startswith("|")])
        return "\n".join(["", *lines, "", ""])

    def document(self, text):
        """Returns the text with all figures and tables updated."""

        def fresh_figure(mark):
            fresh = self.figure(mark["what"])
            return f"<!-- figure: {mark['what']} -->{mark['text'] if fresh is None else fresh}<!-- /figure -->"

        text = TABLE.sub(lambda mark: mark["begin"] + self.table(mark["what"], mark["text"])
                         + mark["end"], text)
        return FIGURE.sub(fresh_figure, text)


def fresh_documents(tool, data, quick=False, jobs=None):
    """Returns (file, present text, updated text) of each document.

    Args:
        quick: measure robots other than the G1 only on the samples.
    """
    clips = tables.Clips(data)
    samples = set(clips.sets["samples"])
    reports = tables.Reports(tool, clips, jobs, lambda clip, robot: not quick or clip in samples
                             or robot == "unitree_g1")
    fresh = Fresh(reports)
    texts = [(file, file.read_text(encoding="utf-8")) for file in documents()]
    for _, text in texts:
        fresh.document(text)
    reports.measure()
    return [(file, text, fresh.document(text)) for file, text in texts]


def stale_lines(documents_now):
    """Returns, per change, `FILE:LINE:`, the present lines, `->` and the updated ones."""
    found = []
    for file, text, fresh in documents_now:
        if text == fresh:
            continue
        old, new = text.splitlines(), fresh.splitlines()
        for kind, a, b, c, d in difflib.SequenceMatcher(None, old, new, False).get_opcodes():
            if kind != "equal":
                found.append("\n    ".join([f"{file.relative_to(SOURCE)}:{a + 1}:", *old[a:b], "->",
                                           *new[c:d]]))
    return found


def fault_of_marks(text):
    """Returns the error in the marks of a text; empty if they are correct."""
    marks = len(ANY_MARK.findall(text))
    parts = sum(2 * len(each.findall(text)) for each in (FIGURE, TABLE, SPEED))
    if marks != parts:
        return f"{marks} marks, of which {parts} are pairs"
    beginning = re.search(r"^\s*<!-- (?:figure|speed):.*$", text, re.MULTILINE)
    return f"a line begins with a mark: {beginning[0]}" if beginning else ""


def draw_with_tool(tool, folder):
    """Returns the bytes of the pictures that the tool draws, by name."""
    walk = SOURCE / "data/walk.bvh"
    view = ("view", "walk.csv", "--robot", "unitree_g1", "--bvh", walk, "--strip", "9", "-o")
    path = ("edit", "path", walk, "-o", "path.bvh", "--svg")
    for command in ((walk, "unitree_g1", "-o", "walk.csv"), (*view, "walk_strip.svg"),
                    (*view, "walk_strip.png"),
                    (*path, "walk_on_a_circle.svg", "--to", "circle", "--radius", "1.5"),
                    (*path, "walk_on_a_figure8.svg", "--to", "figure8")):
        subprocess.run([tool, *map(str, command), "-q"], cwd=folder, check=True)
    names = ("walk_strip.svg", "walk_strip.png", "walk_on_a_circle.svg", "walk_on_a_figure8.svg")
    return {name: (pathlib.Path(folder) / name).read_bytes() for name in names}


def page_gates(tool, folder):
    """Returns, for each picture of a page, the gates of its motions with three digits, which pictures show."""
    import viewing_pictures  # needs numpy and modules of the tests
    from pages import data_of

    viewing_pictures.make_pages(tool, folder)
    pictures = {}
    for name, (page, *_) in viewing_pictures.SCENES.items():
        header = data_of((pathlib.Path(folder) / page).read_text(encoding="utf-8"))[0]
        pictures[f"{name}.png"] = {
            motion["report"]["file"]: {
                gate["metric"]: f"{gate.get('value', 0.0):.3g} {'passed' if gate['passed'] else 'missed'}"
                for gate in motion["report"]["gates"]}
            for motion in header["motions"]}
    return pictures


def write_pictures(tool):
    """Makes the pictures of docs/pictures and reports those that were skipped."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in draw_with_tool(tool, folder).items():
            (PICTURES / name).write_bytes(content)
        if importlib.util.find_spec("numpy") is None:
            print("pictures of pages are left as they are: there is no numpy", file=sys.stderr)
            return
        import viewing_pictures

        if not viewing_pictures.browser.chromium():
            print("pictures of pages are left as they are: there is no Chromium", file=sys.stderr)
            return
        gates = page_gates(tool, folder)
        known = json.loads(PAGES_FILE.read_text()) if PAGES_FILE.exists() else {}
        if gates != known:
            viewing_pictures.take_pictures(folder)
            PAGES_FILE.write_text(json.dumps(gates, indent=1) + "\n")


def main():
    """Updates or checks all documents."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", required=True, type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("--data", type=pathlib.Path, default=shared_data())
    parser.add_argument("--check", action="store_true", help="write nothing")
    parser.add_argument("--no-pictures", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    args = parser.parse_args()
    now = fresh_documents(args.tool, args.data, jobs=args.jobs)
    stale = stale_lines(now)
    print("\n".join(stale) or "all figures are as they are measured")
    if args.check:
        sys.exit(1 if stale else 0)
    for file, text, fresh in now:
        if text != fresh:
            file.write_text(fresh, encoding="utf-8")
    if not args.no_pictures:
        write_pictures(args.tool)


if __name__ == "__main__":
    main()
