#!/usr/bin/env python3
"""Fits configs/quality/tracking_predictor.json: the probability that a controller tracks five seconds of a
motion, from the metrics of its report (docs/certificate.md).

    tools/fit_tracking_predictor.py --tool build/release/tools/retarget/retarget --data FOLDER \\
        --windows windows.jsonl -o configs/quality/tracking_predictor.json

Every clip in the folders (BVH) is cut into windows, retargeted in several ways, measured and simulated with
`retarget certify`; the results are appended to --windows, and windows in that file are not repeated. The
model is then fitted on all of them. For the AUC and the calibration, every clip is predicted by a model that
was fitted on the others. Without --data, it only fits; the tool must be the one that made the windows. Needs
numpy.
"""

import argparse
import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

import numpy as np

WINDOW_S = 5.0
SHORTEST_S = 1.5
ROBOTS = ["unitree_g1", "engineai_pm01", "booster_t1", "fourier_n1", "unitree_h1"]
# Name, options of the run, speed of playback, lean in degrees.
VARIANTS = [
    ("fit", [], 1.0, 0.0),
    ("slow", [], 0.75, 0.0),
    ("without dynamics", ["--without", "dynamics"], 1.0, 0.0),
    ("gmr", ["--method", "gmr"], 1.0, 0.0),
    ("fast", [], 1.3, 0.0),
    ("lean", [], 1.0, None),
]
LEANS = [-12.0, -8.0, -5.0, 5.0, 8.0, 12.0]
# The demands of inverse dynamics: force and torque of the contacts, torque of the joints. A selection among many
# figures by cross-validation generalises worse. Metric, 95th percentile, and number of square roots, which bring
# shares and rare large values to one scale.
FIGURES = [
    ("unexplained_force_pct", False, 2),
    ("unexplained_torque_cm", False, 2),
    ("torque_p99_ratio", False, 2),
]
RIDGE = 1.0
BINS = 5
# Motions of the G1 whose metrics are stored with the model, and one of them whose tracking error is stored as well. A
# test compares them with those of the current tool: if they differ, the metrics or the controller have changed, and
# the model needs a new fit.
REFERENCES = ["tests/golden/walk.csv", "tests/golden/squat.csv", "tests/golden/get_up.csv"]
SIMULATED = "tests/golden/squat.csv"
ROOT = pathlib.Path(__file__).resolve().parent.parent


def value_of(figures, metric, p95):
    """Returns a metric; NaN if the report lacks it."""
    return figures.get(metric + ".p95" if p95 else metric, float("nan"))


def seconds_of(bvh):
    text = bvh.read_text(errors="replace")
    frames = int(re.search(r"Frames:\s*(\d+)", text).group(1))
    return frames * float(re.search(r"Frame Time:\s*(\S+)", text).group(1))


def window_starts(seconds, count):
    if seconds < 2 * WINDOW_S:
        return [0.0]
    return [round(seconds * (i + 0.5) / count - WINDOW_S / 2, 1) for i in range(count)]


def leaned(path, degrees):
    """Rotates the root in every frame of a CSV about its own lateral axis."""
    rows = np.loadtxt(path, delimiter=",")
    half = np.radians(degrees) / 2
    x, y, z, w = rows[:, 3:7].T
    s, c = np.sin(half), np.cos(half)
    rows[:, 3:7] = np.stack([x * c - z * s, y * c + w * s, z * c + x * s, w * c - y * s], axis=1)
    np.savetxt(path, rows, delimiter=",", fmt="%.6f")


def make_window(tool, clip, robot, variant, start, lean, folder):
    """Measures and simulates one window; None if the clip cannot be retargeted."""
    name, options, speed, _ = variant
    motion, certificate = folder / "window.csv", folder / "certificate.json"
    run = [tool, clip, robot, "-o", motion, "--quiet", "--fps", "30", "--start", str(start), "--end",
           str(round(start + WINDOW_S * speed, 2)), *options]
    if subprocess.run(run, stderr=subprocess.DEVNULL, check=False).returncode:
        return None
    if lean:
        leaned(motion, lean)
    certify = [tool, "certify", motion, "--robot", robot, "-o", certificate, "--quiet", "--source-fps",
               str(30 * speed), "--csv-quat", "xyzw", "--source-angles", "rad", "--source-unit", "m"]
    certificate.unlink(missing_ok=True)
    subprocess.run(certify, stderr=subprocess.DEVNULL, check=False)
    if not certificate.exists():
        return None
    data = json.loads(certificate.read_text())
    figures = {}
    for metric, value in data["quality"].items():
        if isinstance(value, list) and len(value) == 2 and all(isinstance(v, float) for v in value):
            figures[metric], figures[metric + ".p95"] = value
        elif isinstance(value, (int, float)):
            figures[metric] = value
    simulation = data["simulation"]
    seconds = (simulation["frames"] - 1) / simulation["fps"]
    return {"clip": clip.stem, "robot": robot, "variant": name, "window": f"{start:.1f}",
            "fell": int(simulation["fell"]), "seconds": round(seconds, 2),
            "fell_after_s": simulation["fall_time_s"] if simulation["fell"] else None,
            "root_error_cm": simulation["root_error_cm"]["mean"], "figures": figures}


def reference_values(tool):
    """Returns the inputs of the model for the reference motions, and the tracking error of one of them."""
    values = {}
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.json"

        def read_report(*command):
            subprocess.run([tool, *command, "--robot", "unitree_g1"], capture_output=True, check=True)
            return json.loads(report.read_text())

        for name in REFERENCES:
            motion = read_report("evaluate", ROOT / name, "--dynamics", "--gate", "none", "--json", report)["motions"][0]
            values[name] = {metric: motion[metric][0] if isinstance(motion[metric], list) else motion[metric]
                            for metric, _, _ in FIGURES}
        simulation = read_report("simulate", ROOT / SIMULATED, "--report", report)
        values[SIMULATED]["root_error_cm"] = simulation["root_error_cm"]["mean"]
    return values


def make_windows(arguments):
    known = {(w["clip"], w["robot"], w["variant"], w["window"]) for w in read_windows(arguments.windows)}
    rng = random.Random(43)
    parts = []
    for clip in sorted(path for folder in arguments.data for path in pathlib.Path(folder).rglob("*.bvh")):
        try:
            seconds = seconds_of(clip)
        except (AttributeError, ValueError):
            continue  # A truncated file.
        if seconds < SHORTEST_S:
            continue
        starts = window_starts(seconds, arguments.per_clip)
        for start in starts:
            of_part = [(clip, robot, variant, start, rng.choice(LEANS))
                       for robot in arguments.robots for variant in VARIANTS]
            rng.shuffle(of_part)
            parts.append(of_part)
    # Parts alternate, so that a run that ends early has windows of all of them.
    rng.shuffle(parts)
    jobs = [job for turn in zip(*parts) for job in turn]
    end = time.monotonic() + 60.0 * arguments.minutes
    with tempfile.TemporaryDirectory() as folder, open(arguments.windows, "a", encoding="utf-8") as out:
        for clip, robot, variant, start, lean in jobs:
            if (clip.stem, robot, variant[0], f"{start:.1f}") in known:
                continue
            if time.monotonic() > end:
                break
            window = make_window(arguments.tool, clip, robot, variant, start,
                                 lean if variant[3] is None else 0.0, pathlib.Path(folder))
            if window:
                out.write(json.dumps(window) + "\n")
                out.flush()


def read_windows(path):
    file = pathlib.Path(path)
    return [json.loads(line) for line in file.read_text().splitlines() if line] if file.exists() else []


class Windows:
    """Returns metrics, outcomes and clips of windows, as arrays."""

    def __init__(self, windows):
        self.raw = np.array([[value_of(w["figures"], metric, p95) for metric, p95, _ in FIGURES]
                             for w in windows])
        self.success = np.array([1.0 - w["fell"] for w in windows])
        self.clips = np.array([w["clip"] for w in windows])
        self.robots = np.array([w["robot"] for w in windows])
        self.variants = np.array([w["variant"] for w in windows])


class Model:
    """Fits a ridge logistic regression to standardised metrics, by Newton's method."""

    def __init__(self, raw, success):
        # The range without the outermost values: beyond it, the predictor does not extrapolate.
        self.least = np.percentile(raw, 1, axis=0)
        self.most = np.percentile(raw, 99, axis=0)
        shaped = self.shape(raw)
        self.middle = shaped.mean(axis=0)
        self.spread = np.maximum(shaped.std(axis=0), 1e-9)
        x = np.column_stack([np.ones(len(raw)), (shaped - self.middle) / self.spread])
        ridge = np.full(x.shape[1], RIDGE)
        ridge[0] = 1e-9
        self.beta = np.zeros(x.shape[1])
        for _ in range(50):
            p = 1.0 / (1.0 + np.exp(-x @ self.beta))
            gradient = x.T @ (success - p) - ridge * self.beta
            hessian = (x * (p * (1.0 - p))[:, None]).T @ x + np.diag(ridge)
            step = np.linalg.solve(hessian, gradient)
            self.beta += step
            if np.abs(step).max() < 1e-10:
                break

    def shape(self, raw):
        shaped = np.clip(raw, self.least, self.most)
        for i, (_, _, roots) in enumerate(FIGURES):
            for _ in range(roots):
                shaped[:, i] = np.sqrt(shaped[:, i])
        return shaped

    def probability(self, raw):
        x = (self.shape(raw) - self.middle) / self.spread
        return 1.0 / (1.0 + np.exp(-(self.beta[0] + x @ self.beta[1:])))


def left_out(windows, groups):
    """Returns the probability of every window by a model that was fitted without its group."""
    probability = np.zeros(len(groups))
    for group in sorted(set(groups)):
        inside = groups == group
        model = Model(windows.raw[~inside], windows.success[~inside])
        probability[inside] = model.probability(windows.raw[inside])
    return probability


def auc_of(probability, success):
    """Returns the share of pairs of a success and a failure in the correct order; ties count half."""
    good, bad = probability[success == 1], probability[success == 0]
    if not len(good) or not len(bad):
        return float("nan")
    return float(np.mean((good[:, None] > bad[None, :]) + 0.5 * (good[:, None] == bad[None, :])))


def interval_of(probability, windows):
    """Returns a 95 % bootstrap interval of the AUC over clips."""
    rng = np.random.default_rng(43)
    names = sorted(set(windows.clips))
    rows = {name: np.flatnonzero(windows.clips == name) for name in names}
    drawn = []
    for _ in range(1000):
        at = np.concatenate([rows[names[i]] for i in rng.integers(len(names), size=len(names))])
        drawn.append(auc_of(probability[at], windows.success[at]))
    return [round(float(x), 3) for x in np.nanpercentile(drawn, [2.5, 97.5])]


def calibration_of(probability, success):
    order = np.argsort(probability, kind="stable")
    return [{"predicted": round(float(probability[part].mean()), 4),
             "observed": round(float(success[part].mean()), 4), "windows": len(part)}
            for part in np.array_split(order, BINS)]


def by_group(probability, success, groups):
    return {str(group): {"windows": int(sum(mine)), "tracked": int(success[mine].sum()),
                         "auc": round(auc_of(probability[mine], success[mine]), 3)}
            for group in sorted(set(groups)) for mine in [groups == group]}


def fit(windows):
    held_out = left_out(windows, windows.clips)
    model = Model(windows.raw, windows.success)
    table = []
    for i, (metric, p95, roots) in enumerate(FIGURES):
        numbers = {"least": model.least, "most": model.most, "middle": model.middle,
                   "spread": model.spread, "coefficient": model.beta[1:]}
        table.append({"metric": metric, "p95": p95, "roots": roots,
                      **{name: float(f"{values[i]:.6g}") for name, values in numbers.items()}})
    return {
        "description": f"Probability that the controller of retarget simulate tracks {WINDOW_S:g} seconds of "
                       "a motion without a fall; docs/certificate.md. Fitted by "
                       "tools/fit_tracking_predictor.py; auc and calibration are on clips that were left "
                       "out.",
        "window_s": WINDOW_S,
        "intercept": float(f"{model.beta[0]:.6g}"),
        "figures": table,
        "auc": round(auc_of(held_out, windows.success), 4),
        "auc_interval": interval_of(held_out, windows),
        "auc_of_left_out_robots": round(auc_of(left_out(windows, windows.robots), windows.success), 4),
        "brier": round(float(np.mean((held_out - windows.success) ** 2)), 4),
        "calibration": calibration_of(held_out, windows.success),
        "windows": len(windows.success),
        "tracked": int(windows.success.sum()),
        "clips": len(set(windows.clips)),
        "robots": by_group(held_out, windows.success, windows.robots),
        "variants": by_group(held_out, windows.success, windows.variants),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", default="retarget")
    parser.add_argument("--data", nargs="*", default=[], help="folders with BVH clips")
    parser.add_argument("--robots", nargs="*", default=ROBOTS)
    parser.add_argument("--per-clip", type=int, default=5, help="windows of a long clip")
    parser.add_argument("--minutes", type=float, default=1e6, help="time in which windows are made")
    parser.add_argument("--windows", required=True, help="results by window, JSON lines")
    parser.add_argument("-o", "--output", required=True)
    arguments = parser.parse_args()
    if arguments.data:
        make_windows(arguments)
    read = read_windows(arguments.windows)
    read.sort(key=lambda w: (w["clip"], w["robot"], w["variant"], float(w["window"])))
    complete = np.isfinite(Windows(read).raw).all(axis=1)
    windows = Windows([w for w, is_complete in zip(read, complete) if is_complete])
    if len(set(windows.success)) < 2:
        sys.exit("the windows need both falls and successes")
    result = {**fit(windows), "references": reference_values(arguments.tool)}
    pathlib.Path(arguments.output).write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    names = ("auc", "auc_interval", "auc_of_left_out_robots", "brier", "windows", "tracked", "clips")
    print(json.dumps({key: result[key] for key in names}))


if __name__ == "__main__":
    main()
