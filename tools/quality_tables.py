#!/usr/bin/env python3
"""Measures motions and prints tables of their metrics in Markdown.

    tools/quality_tables.py --tool build/release/tools/retarget/retarget --data FOLDER [--robots A,B]

prints the tables of docs/quality.md for your own copy of the data: first those of the G1, then means by robot and kind
of source. For robots with a published configuration these are `--ik-config published --scale table` -> default.

    tools/quality_tables.py --tool ... --dynamics

prints the tables of docs/dynamics.md instead: published motions, the published method, the fit `--without dynamics`, and
the fit, side by side.

    tools/quality_tables.py --tool ... --dynamics --side-by-side --robots A,B --seconds 40

prints those of several robots side by side: the fit `--without dynamics` -> the fit, of the first 40 seconds of each clip.

    tools/quality_tables.py --tool ... --all-robots

prints the tables of docs/robots.md, "On the samples" and "On walks": the fits of all robots. The former needs no
other data.

    tools/quality_tables.py --tool ... --before OLD --robots A,B

prints one table per robot of all clips: the fit of the program OLD -> the fit of --tool, both measured by the latter.

FOLDER has lafan1/, lafan1_cuts/ and dialects/ with BVH files, smpl/, and unitree_g1_csv/ with published motions. The
default is $RETARGET_SHARED/data. lafan1/ is from github.com/ubisoft/ubisoft-laforge-animation-dataset. The published
motions are `g1/` of the data set LAFAN1_Retargeting_Dataset that Unitree shares on Hugging Face. Neither is part of this
repository. tools/docs_figures.py writes the same tables into the documents.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys
import tempfile

DATA = pathlib.Path(__file__).resolve().parent.parent / "data"
FIGURES = {"jumps": 0, "joint_at_limit_pct": 1, "fast_3pi_pct": 1, "speed_limit_pct": 2, "acc_p99": 0,
           "root_jerk_mean": 0, "foot_pen_1cm_pct": 1, "body_pen_1cm_pct": 1, "float_planted_pct": 1,
           "contact_slip_mean": 4, "contact_drift_p95_cm": 2, "contact_height_p50_cm": 2,
           "contact_agreement_pct": 1, "self_1cm_pct": 1, "flights": 0, "flight_peak_max_cm": 1,
           "track_pos_cm": 1, "track_rot_deg": 1, "limb_angle_deg": 1, "fast_arm_pct": 0, "fast_leg_pct": 0,
           "root_bounce_pct": 0, "arm_jolts": 0, "trunk_lean_error_deg": 1}
MEANS = ["limb_angle_deg", "trunk_lean_error_deg", "root_jerk_mean", "acc_p99", "contact_slip_mean",
         "self_all_1cm_pct", "body_pen_1cm_pct", "flight_peak_max_cm", "jumps"]
SAMPLES = ["walk", "turn_in_place", "squat", "wave", "get_up"]
WALKS = {"lafan1_cuts/walk1_subject1_walk.bvh": "LAFAN1", "dialects/cmu_daz_03_03.bvh": "CMU 03_03",
         "dialects/cmu_motionbuilder_12_01_walk.bvh": "CMU 12_01",
         "dialects/games105_walk60.bvh": "GAMES-105", "dialects/makehuman_walk1.bvh": "MakeHuman",
         "dialects/soma_walk_forward_120fps.bvh": "SOMA", "smpl/smpl_walk.npz": "SMPL"}
NO_HUMANS = {"nonhuman_dog", "full_precision_frame_time", "rotation_first_root", "slimevr_hmd_root",
             "geno_stance", "soma_zero_frame0"}
SMPL = {".npz", ".npy", ".pt", ".pkl"}
DYNAMICS = {"dynamics_bad_pct": 1, "limb_angle_deg": 2, "track_pos_cm": 2, "com_acc_p99": 1,
            "root_jerk_mean": 0, "stance_slip_mean": 4, "torque_over_pct": 1}
SIDE_BY_SIDE = ["dynamics_bad_pct", "torque_over_pct"]
BEFORE = {"limb_angle_deg": 2, "fast_arm_pct": 0, "fast_leg_pct": 0, "root_bounce_pct": 0, "root_jerk_mean": 1,
          "acc_p99": 0, "arm_jolts": 0, "joint_at_limit_pct": 1, "dynamics_bad_pct": 1, "torque_over_pct": 1,
          "stance_slip_mean": 4, "stance_drift_p95_cm": 2, "support_slip_mean": 3, "support_height_p95_cm": 1}
# Methods and the options that run them. None: Unitree's published motion of the clip; the fit of an earlier program.
METHODS = {"fit": (), "gmr": ("--method", "gmr"), "without-dynamics": ("--without", "dynamics"),
           "as-published": ("--ik-config", "published", "--scale", "table"), "published": None, "before": None}
METHOD_TITLES = {"published": "published data", "gmr": "`--method gmr`",
                 "without-dynamics": "fit `--without dynamics`", "fit": "fit"}
# Marks a value that was not measured.
SKIPPED = object()


def short(clip):
    """Shortens walk4_subject1 to walk4_s1."""
    return clip.stem.replace("subject", "s")


def value(report, name):
    """Returns the mean of a metric, or None if it was not measured."""
    found = None if report is None else report.get(name)
    return found[0] if isinstance(found, list) else found


def missed_gates(report):
    """Returns the names of the gates that a motion misses."""
    return [gate["metric"] for gate in report["gates"] if gate["passed"] is False]


class Clips:
    """Clips of data/ and, if given, of a folder with other data."""

    def __init__(self, folder=None):
        self.folder = folder
        found = {"samples": [DATA / f"{name}.bvh" for name in SAMPLES], "lafan1": [], "cuts": [],
                 "skeletons": [], "walks": [], "smpl": []}
        if folder:
            found["lafan1"] = sorted((folder / "lafan1").glob("*.bvh"))
            found["cuts"] = sorted((folder / "lafan1_cuts").glob("*.bvh"))
            found["skeletons"] = [clip for clip in sorted((folder / "dialects").glob("*.bvh"))
                                  if clip.stem not in NO_HUMANS]
            found["smpl"] = [clip for clip in sorted((folder / "smpl").glob("*")) if clip.suffix in SMPL]
            found["walks"] = [folder / name for name in WALKS if (folder / name).exists()]
        self.sets = found

    def named(self, names):
        """Returns clips of sets and single names, separated by commas; None if some are missing."""
        clips = []
        for name in names.split(","):
            known = self.sets.get(
                name, [clip for each in self.sets.values() for clip in each if clip.stem == name][:1])
            if not known:
                return None
            clips += known
        return clips

    def published(self, clip):
        """Returns Unitree's motion of a clip, or None if there is none."""
        motion = self.folder / "unitree_g1_csv" / f"{clip.stem}.csv" if self.folder else None
        return motion if motion and motion.exists() else None


class Reports:
    """Reports of motions, each measured once. `measure` measures the reports requested since its last call."""

    def __init__(self, tool, clips, jobs=None, may_measure=lambda clip, robot: True, seconds=None,
                 before=None):
        self.tool, self.clips, self.jobs, self.may_measure = tool, clips, jobs, may_measure
        self.before = before
        self.part = ["--end", str(seconds)] if seconds else []
        self.known, self.wanted = {}, set()

    def get(self, clip, robot="unitree_g1", method="fit", dynamics=False):
        """Returns a report; None if the tool fails or the motion is missing; SKIPPED if it is not measured."""
        job = (clip, robot, method, dynamics)
        if job not in self.known and self.may_measure(clip, robot):
            self.wanted.add(job)
        return self.known.get(job, SKIPPED)

    def measure(self):
        """Measures the requested reports. Returns whether there were any."""
        wanted = sorted(self.wanted, key=str)
        self.wanted.clear()
        with concurrent.futures.ThreadPoolExecutor(self.jobs or os.cpu_count()) as pool:
            self.known.update(zip(wanted, pool.map(self._report, wanted)))
        return bool(wanted)

    def _report(self, job):
        clip, robot, method, dynamics = job
        options = ["--dynamics"] if dynamics else []
        with tempfile.TemporaryDirectory() as folder:
            report, motion = os.path.join(folder, "report.json"), os.path.join(folder, "out.csv")
            evaluation = ["--robot", robot, "--bvh", clip, "--json", report, *self.part, *options]
            if method == "published":
                motion = self.clips.published(clip)
                if motion is None:
                    return None
                command = [self.tool, "evaluate", motion, *evaluation, "--gate", "none"]
            elif method == "before":
                subprocess.run([self.before, clip, robot, "-o", motion, "-q", *self.part],
                               capture_output=True, check=False)
                if not os.path.exists(motion):
                    return None
                command = [self.tool, "evaluate", motion, *evaluation]
            else:
                command = [self.tool, clip, robot, "-o", motion, "--report", report, "-q",
                           *METHODS[method], *self.part, *options]
            done = subprocess.run(command, capture_output=True, check=False, text=True)
            if not os.path.exists(report):
                if method != "as-published":
                    print(f"{clip}, {robot}: {done.stderr.strip()}", file=sys.stderr)
                return None
            with open(report, encoding="utf-8") as file:
                return json.load(file)["motions"][0]


class Table:
    """Cells by rows and columns; SKIPPED cells were not measured."""

    def __init__(self, corner, columns, line="---"):
        self.corner, self.columns, self.line = corner, columns, line
        self.rows = {}

    def lines(self, old=()):
        """Returns Markdown lines; cells that were not measured keep their value in the old lines."""
        cells = {}
        parted = [[cell.strip() for cell in line.strip().strip("|").split(" | ")] for line in old]
        for row in parted[2:]:
            cells.update({(row[0], name): cell for name, cell in zip(parted[0][1:], row[1:])})
        texts = [[self.corner, *self.columns]]
        texts += [[name, *(cells.get((name, column), "") if cell is SKIPPED else cell
                           for column, cell in zip(self.columns, row))]
                  for name, row in self.rows.items()]
        lines = ["| " + " | ".join(row) + " |" for row in texts]
        return [lines[0], "|" + "|".join([f" {self.line} "] * len(texts[0])) + "|", *lines[1:]]


def clip_table(reports, clips, method):
    """Returns a table with one column per clip and one row per metric that any of them has."""
    found = [reports.get(clip, method=method) for clip in clips]
    table = Table("metric", [short(clip) for clip in clips])
    for name, digits in FIGURES.items():
        cells = [report if report is SKIPPED else value(report, name) for report in found]
        if any(cell is not None for cell in cells):
            table.rows[f"`{name}`"] = [cell if cell is SKIPPED else "-" if cell is None
                                       else f"{cell:.{digits}f}" for cell in cells]
    return table


def mean_cell(pairs, name):
    """Returns `before -> after` of the clips with both, otherwise the mean of the existing values."""
    both = [(value(a, name), value(b, name)) for a, b in pairs]
    both = [pair for pair in both if None not in pair]
    if both:
        return " -> ".join(f"{sum(part) / len(both):.3g}" for part in zip(*both))
    alone = [value(b, name) for _, b in pairs if value(b, name) is not None]
    return f"{sum(alone) / len(alone):.3g}" if alone else "-"


def means_table(reports, robot):
    """Returns a table of published configuration -> default, one column per kind of source."""
    kinds = {"LAFAN1": "lafan1", "excerpts": "cuts", "other skeletons": "skeletons", "samples": "samples"}
    table = Table("mean of", list(kinds))
    table.rows = {f"`{name}`": [] for name in MEANS}
    for kind in kinds.values():
        pairs = [(reports.get(clip, robot, "as-published"), reports.get(clip, robot))
                 for clip in reports.clips.sets[kind]]
        known = pairs and not any(SKIPPED in pair for pair in pairs)
        for name in MEANS:
            table.rows[f"`{name}`"].append(mean_cell(pairs, name) if known else SKIPPED)
    return table


def robot_names(tool):
    """Returns all robots that the tool lists."""
    listed = subprocess.run([tool, "robots", "list", "--json"], capture_output=True, check=True,
                            text=True)
    return [robot["name"] for robot in json.loads(listed.stdout)]


def robots_table(reports, clips):
    """Returns a table with one row per robot: means over clips, and missed gates."""
    table = Table("robot", ["limb angle", "trunk lean", "missed gates"])
    names = {pathlib.Path(path).stem: name for path, name in WALKS.items()}
    for robot in robot_names(reports.tool):
        found = {clip: reports.get(clip, robot) for clip in clips}
        if SKIPPED in found.values():
            table.rows[f"`{robot}`"] = [SKIPPED] * 3
            continue
        cells = []
        for name in ("limb_angle_deg", "trunk_lean_error_deg"):
            values = [value(report, name) for report in found.values()]
            values = [number for number in values if number is not None]
            cells.append(f"{sum(values) / len(values):.1f}" if values else "-")
        missed = [f"{names.get(clip.stem, clip.stem)}: "
                  + ", ".join(f"`{name}`" for name in missed_gates(report))
                  for clip, report in found.items() if report and missed_gates(report)]
        table.rows[f"`{robot}`"] = [*cells, "; ".join(missed) or "-"]
    return table


def pair_cell(pair, name, digits):
    """Returns `before -> after` of two reports; - if one has no value."""
    if SKIPPED in pair:
        return SKIPPED
    numbers = [value(report, name) for report in pair]
    return "-" if None in numbers else " -> ".join(f"{number:.{digits}f}" for number in numbers)


def dynamics_table(reports, robot, clips, name):
    """Returns a table with one row per clip and one column per method."""
    methods = [each for each in METHOD_TITLES if each != "published" or robot == "unitree_g1"]
    table = Table("clip", [METHOD_TITLES[each] for each in methods])
    for clip in clips:
        cells = [reports.get(clip, robot, each, True) for each in methods]
        cells = [cell if cell is SKIPPED else value(cell, name) for cell in cells]
        table.rows[clip.stem] = [cell if cell is SKIPPED else "" if cell is None
                                 else f"{cell:.{DYNAMICS[name]}f}" for cell in cells]
    return table


def side_by_side_table(reports, robots, clips, name):
    """Returns a table with one row per clip and one column per robot: without -> with dynamics."""
    table = Table("clip", [f"`{robot}`" for robot in robots])
    for clip in clips:
        pairs = [[reports.get(clip, robot, method, True) for method in ("without-dynamics", "fit")]
                 for robot in robots]
        table.rows[clip.stem] = [pair_cell(pair, name, DYNAMICS[name]) for pair in pairs]
    return table


def before_table(reports, robot):
    """Returns a table of the earlier program -> --tool: one row per clip, and a row of means."""
    table = Table("clip", [*(f"`{name}`" for name in BEFORE), "missed gates"])
    pairs = {clip: [reports.get(clip, robot, method, True) for method in ("before", "fit")]
             for clips in reports.clips.sets.values() for clip in clips}
    pairs = {clip: pair for clip, pair in pairs.items() if None not in pair}
    if any(SKIPPED in pair for pair in pairs.values()):
        return table
    for clip, pair in pairs.items():
        missed = [", ".join(missed_gates(report)) or "none" for report in pair]
        table.rows[clip.stem] = [*(pair_cell(pair, name, digits) for name, digits in BEFORE.items()),
                                 " -> ".join(dict.fromkeys(missed))]
    counts = [sum(len(missed_gates(report)) for report in each) for each in zip(*pairs.values())]
    table.rows["mean"] = [*(mean_cell(pairs.values(), name) for name in BEFORE),
                          " -> ".join(map(str, counts))]
    return table


def tables_of(reports, args):
    """Returns (title, table) of the requested tables, in the order of the page."""
    clips = reports.clips.sets
    robots = args.robots.split(",")
    if args.all_robots:
        return [("On the samples:", robots_table(reports, clips["samples"])),
                *([("On walks:", robots_table(reports, clips["walks"]))] if clips["walks"] else [])]
    if args.before:
        return [(f"`{robot}`:", before_table(reports, robot)) for robot in robots]
    if args.dynamics:
        whole = clips["lafan1"] + clips["cuts"] + clips["samples"]
        if args.side_by_side:
            return [(f"`{name}`:", side_by_side_table(reports, robots, whole, name))
                    for name in SIDE_BY_SIDE]
        return [(f"`{name}`, {robot}:", dynamics_table(reports, robot, whole, name))
                for robot in robots for name in DYNAMICS]
    published = [clip for clip in clips["lafan1"] if reports.clips.published(clip)]
    titles = {"gmr": "Published method, `--method gmr`:", "fit": "Ours, `--method fit`:"}
    return [*((title, clip_table(reports, clips[kind], method)) for kind in ("lafan1", "samples")
              for method, title in titles.items()),
            ("Unitree's published motions:", clip_table(reports, published, "published")),
            *((f"`{robot}`:", means_table(reports, robot)) for robot in robots)]


def main():
    """Prints tables."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", required=True)
    shared = os.environ.get("RETARGET_SHARED")
    parser.add_argument("--data", type=pathlib.Path,
                        default=shared and pathlib.Path(shared) / "data")
    parser.add_argument("--dynamics", action="store_true",
                        help="print the tables of docs/dynamics.md")
    parser.add_argument("--side-by-side", action="store_true",
                        help="with --dynamics: a column for each robot")
    parser.add_argument("--seconds", type=float, help="measure only the first seconds of each clip")
    parser.add_argument("--all-robots", action="store_true",
                        help="print the tables of docs/robots.md")
    parser.add_argument("--before", metavar="OLD",
                        help="print all clips, with this earlier program -> with --tool")
    parser.add_argument("--robots", default="unitree_g1")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    args = parser.parse_args()
    if args.data is None and not args.all_robots:
        parser.error("--data FOLDER is needed")
    reports = Reports(args.tool, Clips(args.data), args.jobs, seconds=args.seconds,
                      before=args.before)
    tables_of(reports, args)
    reports.measure()
    for title, table in tables_of(reports, args):
        print("\n".join(["", title, "", *table.lines()]))


if __name__ == "__main__":
    main()
