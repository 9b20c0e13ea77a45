#!/usr/bin/env python3
"""Fits configs/quality/tracking_predictor.json: the probability that a controller tracks ten seconds of a
motion, from the figures of its report (docs/certificate.md).

    tools/fit_tracking_predictor.py --tool build/release/tools/retarget/retarget --data FOLDER \\
        --windows windows.jsonl -o configs/quality/tracking_predictor.json

Every clip in the folders (BVH) is cut into windows, retargeted in several ways, measured and simulated with
`retarget certify`; the results are appended to --windows, and windows that it has are not made again. The
model is then fitted on all of them and cross-validated by clip. Without --data, it only fits. Needs numpy.
"""

import argparse
import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile

import numpy as np

WINDOW_S = 10.0
ROBOTS = ["unitree_g1", "engineai_pm01", "booster_t1", "fourier_n1"]
# Name, options of the run, speed of playback, lean in degrees.
VARIANTS = [
    ("fit", ["--without", "dynamics"], 1.0, 0.0),
    ("dynamics", [], 1.0, 0.0),
    ("gmr", ["--method", "gmr"], 1.0, 0.0),
    ("fast", ["--without", "dynamics"], 1.3, 0.0),
    ("lean", [], 1.0, None),
]
LEANS = [-12.0, -8.0, -5.0, 5.0, 8.0, 12.0]
# Metric, 95th percentile, square root. The square root brings shares and rare large values to one scale.
FIGURES = [
    ("unexplained_force_pct", False, True),
    ("unexplained_torque_cm", False, True),
    ("joint_at_limit_pct", False, True),
]
RIDGE = 1.0
BINS = 5


def value_of(figures, metric, p95):
    """A figure; NaN if the report lacks it."""
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
    """Turns the root of every frame of a CSV about its own lateral axis."""
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
           str(start + WINDOW_S), *options]
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
    return {"clip": clip.stem, "robot": robot, "variant": name, "window": f"{start:.1f}",
            "fell": int(data["simulation"]["fell"]), "figures": figures}


def make_windows(arguments):
    known = {(w["clip"], w["robot"], w["variant"], w["window"]) for w in read_windows(arguments.windows)}
    rng = random.Random(43)
    jobs = []
    for clip in sorted(path for folder in arguments.data for path in pathlib.Path(folder).rglob("*.bvh")):
        try:
            starts = window_starts(seconds_of(clip), arguments.per_clip)
        except (AttributeError, ValueError):
            continue  # a file that is not whole
        jobs += [(clip, robot, variant, start, rng.choice(LEANS)) for start in starts
                 for robot in arguments.robots for variant in VARIANTS]
    rng.shuffle(jobs)
    with tempfile.TemporaryDirectory() as folder, open(arguments.windows, "a", encoding="utf-8") as out:
        for clip, robot, variant, start, lean in jobs:
            if (clip.stem, robot, variant[0], f"{start:.1f}") in known:
                continue
            window = make_window(arguments.tool, clip, robot, variant, start,
                                 lean if variant[3] is None else 0.0, pathlib.Path(folder))
            if window:
                out.write(json.dumps(window) + "\n")
                out.flush()


def read_windows(path):
    file = pathlib.Path(path)
    return [json.loads(line) for line in file.read_text().splitlines() if line] if file.exists() else []


class Model:
    """Logistic regression with a ridge on standardised figures, by Newton's method."""

    def __init__(self, windows):
        raw = raw_matrix(windows)
        # The range without the outermost values: beyond it, the predictor does not extrapolate.
        self.least = np.nanpercentile(raw, 1, axis=0)
        self.most = np.nanpercentile(raw, 99, axis=0)
        shaped = self.shape(raw)
        self.middle = shaped.mean(axis=0)
        self.spread = np.maximum(shaped.std(axis=0), 1e-9)
        x = np.column_stack([np.ones(len(raw)), (shaped - self.middle) / self.spread])
        y = np.array([1.0 - w["fell"] for w in windows])
        ridge = np.full(x.shape[1], RIDGE)
        ridge[0] = 0.0
        self.beta = np.zeros(x.shape[1])
        for _ in range(50):
            p = 1.0 / (1.0 + np.exp(-x @ self.beta))
            gradient = x.T @ (y - p) - ridge * self.beta
            hessian = (x * (p * (1.0 - p))[:, None]).T @ x + np.diag(ridge + 1e-9)
            step = np.linalg.solve(hessian, gradient)
            self.beta += step
            if np.abs(step).max() < 1e-10:
                break

    def shape(self, raw):
        clipped = np.clip(raw, self.least, self.most)
        for i, (_, _, root) in enumerate(FIGURES):
            if root:
                clipped[:, i] = np.sqrt(clipped[:, i])
        return clipped

    def probability(self, windows):
        x = (self.shape(raw_matrix(windows)) - self.middle) / self.spread
        return 1.0 / (1.0 + np.exp(-(self.beta[0] + x @ self.beta[1:])))


def raw_matrix(windows):
    raw = np.array([[value_of(w["figures"], metric, p95) for metric, p95, _ in FIGURES] for w in windows])
    return np.maximum(raw, [0.0 if root else -1e9 for _, _, root in FIGURES])


def auc_of(probability, success):
    """The share of pairs of a success and a failure that are in the right order; ties count half."""
    good, bad = probability[success == 1], probability[success == 0]
    if not len(good) or not len(bad):
        return float("nan")
    return float(np.mean((good[:, None] > bad[None, :]) + 0.5 * (good[:, None] == bad[None, :])))


def calibration_of(probability, success):
    order = np.argsort(probability, kind="stable")
    return [{"predicted": round(float(probability[part].mean()), 4),
             "observed": round(float(success[part].mean()), 4), "windows": len(part)}
            for part in np.array_split(order, BINS)]


def fit(windows):
    clips = sorted({w["clip"] for w in windows})
    success = np.array([1.0 - w["fell"] for w in windows])
    held_out = np.zeros(len(windows))
    for clip in clips:
        inside = np.array([w["clip"] == clip for w in windows])
        model = Model([w for w, is_inside in zip(windows, inside) if not is_inside])
        held_out[inside] = model.probability([w for w, is_inside in zip(windows, inside) if is_inside])
    model = Model(windows)
    auc = auc_of(held_out, success)
    table = [{"metric": metric, "p95": p95, "root": root, "least": float(f"{model.least[i]:.6g}"),
              "most": float(f"{model.most[i]:.6g}"), "middle": float(f"{model.middle[i]:.6g}"),
              "spread": float(f"{model.spread[i]:.6g}"), "coefficient": float(f"{model.beta[i + 1]:.6g}")}
             for i, (metric, p95, root) in enumerate(FIGURES)]
    by_robot = {robot: {"windows": int(sum(mine)), "tracked": int(success[mine].sum()),
                        "auc": round(auc_of(held_out[mine], success[mine]), 3)}
                for robot in sorted({w["robot"] for w in windows})
                for mine in [np.array([w["robot"] == robot for w in windows])]}
    return {
        "description": "Probability that the controller of retarget simulate tracks ten seconds of a motion "
                       "without a fall; docs/certificate.md. Fitted by tools/fit_tracking_predictor.py; auc "
                       "and calibration are on clips that were left out.",
        "window_s": WINDOW_S,
        "intercept": float(f"{model.beta[0]:.6g}"),
        "figures": table,
        "auc": round(auc, 4),
        "brier": round(float(np.mean((held_out - success) ** 2)), 4),
        "calibration": calibration_of(held_out, success),
        "windows": len(windows),
        "tracked": int(success.sum()),
        "clips": len(clips),
        "robots": by_robot,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", default="retarget")
    parser.add_argument("--data", nargs="*", default=[], help="folders with BVH clips")
    parser.add_argument("--robots", nargs="*", default=ROBOTS)
    parser.add_argument("--per-clip", type=int, default=5, help="windows of a long clip")
    parser.add_argument("--windows", required=True, help="results by window, JSON lines")
    parser.add_argument("-o", "--output", required=True)
    arguments = parser.parse_args()
    if arguments.data:
        make_windows(arguments)
    windows = [w for w in read_windows(arguments.windows)
               if np.isfinite(raw_matrix([w])).all()]
    if len({w["fell"] for w in windows}) < 2:
        sys.exit("the windows need both falls and successes")
    windows.sort(key=lambda w: (w["clip"], w["robot"], w["variant"], float(w["window"])))
    result = fit(windows)
    pathlib.Path(arguments.output).write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    print(json.dumps({key: result[key] for key in ("auc", "brier", "windows", "tracked", "clips")}))


if __name__ == "__main__":
    main()
