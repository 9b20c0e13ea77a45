#!/usr/bin/env python3
"""The tables of docs/quality.md, measured anew.

    tools/quality_tables.py --tool build/release/tools/retarget/retarget --data FOLDER [--robots A,B]

FOLDER has lafan1/, lafan1_cuts/, dialects/ with BVH files and unitree_g1_csv/ with published motions. Prints
Markdown: the G1's tables, then means by robot and kind of source, `--ik-config published --scale table`
-> default where the robot has a published configuration.

    tools/quality_tables.py --tool ... --dynamics

prints the tables of docs/dynamics.md instead: published motions, the published method, the fit, and the fit with
`--with dynamics`, side by side.

    tools/quality_tables.py --tool ... --all-robots

prints the tables of docs/robots.md, "On the samples" and "On walks": the fits of all robots; the former needs no other data.

FOLDER is $RETARGET_SHARED/data unless it is given. lafan1/ is from
github.com/ubisoft/ubisoft-laforge-animation-dataset, the published motions (`g1/` of them) are the data set
LAFAN1_Retargeting_Dataset that Unitree shares on Hugging Face; neither is part of this repository.
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
           "track_pos_cm": 1, "track_rot_deg": 1, "limb_angle_deg": 1, "trunk_lean_error_deg": 1}
MEANS = ["limb_angle_deg", "trunk_lean_error_deg", "root_jerk_mean", "acc_p99", "contact_slip_mean",
         "self_all_1cm_pct", "body_pen_1cm_pct", "flight_peak_max_cm", "jumps"]
SAMPLES = ["walk", "turn_in_place", "squat", "wave", "get_up"]
WALKS = ["lafan1_cuts/walk1_subject1_walk.bvh", "dialects/cmu_daz_03_03.bvh",
         "dialects/cmu_motionbuilder_12_01_walk.bvh", "dialects/games105_walk60.bvh",
         "dialects/makehuman_walk1.bvh", "dialects/soma_walk_forward_120fps.bvh", "smpl/smpl_walk.npz"]
NO_HUMANS = {"nonhuman_dog", "full_precision_frame_time", "rotation_first_root", "slimevr_hmd_root",
             "geno_stance", "soma_zero_frame0"}
DYNAMICS = {"dynamics_bad_pct": 1, "limb_angle_deg": 2, "track_pos_cm": 2, "com_acc_p99": 1,
            "root_jerk_mean": 0, "stance_slip_mean": 4, "torque_over_pct": 1}
METHODS = {"`--method gmr`": ("--method", "gmr"), "fit": (),
           "fit `--with dynamics`": ("--with", "dynamics")}
AS_PUBLISHED = ("--ik-config", "published", "--scale", "table")


def figures(tool, clip, robot, options=(), motion=None):
    """The report of a run, or of a motion that is there; None where the tool fails."""
    with tempfile.TemporaryDirectory() as folder:
        report = os.path.join(folder, "report.json")
        command = [tool, "--bvh", clip, "--robot", robot, "-o", os.path.join(folder, "out.csv"),
                   "--report", report, "-q", *options]
        if motion:
            command = [tool, "evaluate", motion, "--robot", robot, "--bvh", clip, "--json", report,
                       "--gate", "none", *options]
        result = subprocess.run(command, capture_output=True, check=False, text=True)
        if not os.path.exists(report):
            print(f"{clip}, {robot}: {result.stderr.strip()}", file=sys.stderr)
            return None
        with open(report, encoding="utf-8") as file:
            return json.load(file)["motions"][0]


def dynamics(tool, clip, robot, options):
    """The report with figures of inverse dynamics of a run's motion."""
    with tempfile.TemporaryDirectory() as folder:
        motion = os.path.join(folder, "out.csv")
        subprocess.run([tool, "--bvh", clip, "--robot", robot, "-o", motion, "-q", *options],
                       check=True)
        return figures(tool, clip, robot, ("--dynamics",), motion)


def print_dynamics(tool, pool, robot, clips, published):
    """A table a figure: a row a clip, a column a method."""
    reports = {}
    if robot == "unitree_g1":
        reports["published data"] = [
            figures(tool, clip, robot, ("--dynamics",), published / f"{clip.stem}.csv")
            if (published / f"{clip.stem}.csv").exists() else None for clip in clips]
    for method, options in METHODS.items():
        reports[method] = list(pool.map(lambda clip: dynamics(tool, clip, robot, options), clips))
    for name, digits in DYNAMICS.items():
        print(f"\n`{name}`, {robot}:\n\n| clip | " + " | ".join(reports) + " |")
        print("| --- |" + " --- |" * len(reports))
        for i, clip in enumerate(clips):
            cells = [value(of_method[i], name) for of_method in reports.values()]
            texts = ["" if cell is None else f"{cell:.{digits}f}" for cell in cells]
            print(f"| {clip.stem} | " + " | ".join(texts) + " |")


def value(report, name):
    """The mean of a figure."""
    found = None if report is None else report.get(name)
    return found[0] if isinstance(found, list) else found


def print_table(title, names, reports):
    """One column per clip, one row per figure."""
    print(f"\n{title}\n\n| figure | " + " | ".join(names) + " |")
    print("| --- |" + " --- |" * len(names))
    for name, digits in FIGURES.items():
        cells = [value(report, name) for report in reports]
        if any(cell is not None for cell in cells):
            texts = ["-" if cell is None else f"{cell:.{digits}f}" for cell in cells]
            print(f"| `{name}` | " + " | ".join(texts) + " |")


def short(clip):
    """walk4_subject1 as walk4_s1."""
    return clip.stem.replace("subject", "s")


def print_means(tool, pool, robot, clips):
    """Before -> after, a column a kind of source."""
    rows = {}
    for kind, files in clips.items():
        after = list(pool.map(lambda clip: figures(tool, clip, robot), files))
        before = list(pool.map(lambda clip: figures(tool, clip, robot, AS_PUBLISHED), files))
        for name in MEANS:
            pairs = [(value(a, name), value(b, name)) for a, b in zip(before, after)]
            both = [pair for pair in pairs if None not in pair]
            alone = [b for _, b in pairs if b is not None]
            if both:
                cell = " -> ".join(f"{sum(part) / len(both):.3g}" for part in zip(*both))
            else:
                cell = f"{sum(alone) / len(alone):.3g}" if alone else "-"
            rows.setdefault(name, []).append(cell)
    print(f"\n`{robot}`:\n\n| mean of | " + " | ".join(clips) + " |\n| --- |" + " --- |" * len(clips))
    for name, cells in rows.items():
        print(f"| `{name}` | " + " | ".join(cells) + " |")


def missed_gates(report):
    """Names of the gates that a motion misses."""
    return [gate["metric"] for gate in report["gates"] if gate["passed"] is False]


def print_robots(tool, pool, clips):
    """A row a robot: means over clips, and what gates they miss."""
    listed = subprocess.run([tool, "robots", "list", "--json"], capture_output=True, check=True,
                            text=True)
    robots = [robot["name"] for robot in json.loads(listed.stdout)]
    jobs = [(robot, clip) for robot in robots for clip in clips]
    found = dict(zip(jobs, pool.map(lambda job: figures(tool, job[1], job[0]), jobs)))
    print("| robot | limb angle | trunk lean | missed gates |\n|---|---|---|---|")
    for robot in robots:
        reports = {clip: found[robot, clip] for clip in clips}
        cells = []
        for name in ("limb_angle_deg", "trunk_lean_error_deg"):
            values = [value(report, name) for report in reports.values()]
            values = [number for number in values if number is not None]
            cells.append(f"{sum(values) / len(values):.1f}" if values else "-")
        missed = [f"{clip.stem}: " + ", ".join(f"`{name}`" for name in missed_gates(report))
                  for clip, report in reports.items() if report and missed_gates(report)]
        print(f"| `{robot}` | {cells[0]} | {cells[1]} | {'; '.join(missed) or '-'} |")


def main():
    """Everything, in the order of the page."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", required=True)
    shared = os.environ.get("RETARGET_SHARED")
    parser.add_argument("--data", type=pathlib.Path,
                        default=shared and pathlib.Path(shared) / "data")
    parser.add_argument("--dynamics", action="store_true",
                        help="print the tables of docs/dynamics.md")
    parser.add_argument("--all-robots", action="store_true",
                        help="print the tables of docs/robots.md")
    parser.add_argument("--robots", default="unitree_g1")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    args = parser.parse_args()
    if args.all_robots:
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            print_robots(args.tool, pool, [DATA / f"{name}.bvh" for name in SAMPLES])
            if args.data:
                print()
                print_robots(args.tool, pool, [args.data / name for name in WALKS])
        return
    if args.data is None:
        parser.error("--data FOLDER is needed")
    lafan1 = sorted((args.data / "lafan1").glob("*.bvh"))
    samples = [DATA / f"{name}.bvh" for name in SAMPLES]
    clips = {"LAFAN1": lafan1, "cuts": sorted((args.data / "lafan1_cuts").glob("*.bvh")),
             "other skeletons": [clip for clip in sorted((args.data / "dialects").glob("*.bvh"))
                                 if clip.stem not in NO_HUMANS],
             "samples": samples}
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        if args.dynamics:
            for robot in args.robots.split(","):
                print_dynamics(args.tool, pool, robot, lafan1 + clips["cuts"] + samples,
                               args.data / "unitree_g1_csv")
            return
        for files in (lafan1, samples):
            for title, options in (("Published method, `--method gmr`:", ("--method", "gmr")),
                                   ("Ours, `--method fit`:", ())):
                found = list(pool.map(lambda clip: figures(args.tool, clip, "unitree_g1", options),
                                      files))
                print_table(title, [short(clip) for clip in files], found)
        motions = [clip for clip in lafan1
                   if (args.data / "unitree_g1_csv" / f"{clip.stem}.csv").exists()]
        found = [figures(args.tool, clip, "unitree_g1",
                         motion=args.data / "unitree_g1_csv" / f"{clip.stem}.csv")
                 for clip in motions]
        print_table("Unitree's published motions:", [short(clip) for clip in motions], found)
        for robot in args.robots.split(","):
            print_means(args.tool, pool, robot, clips)


if __name__ == "__main__":
    main()
