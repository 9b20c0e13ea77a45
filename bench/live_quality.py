"""Measures the quality of live runs for several lags: the table of docs/live.md.

Each clip is played through a pipe to `retarget live`, and the resulting motion is measured like any other.

    python3 bench/live_quality.py build/release/tools/retarget/retarget data/*.bvh
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

LAGS_MS = (0, 40, 80, 200, 500, 1000)
FIGURES = ("self_1cm_pct", "stance_slip_mean", "stance_drift_p95_cm", "stance_height_p50_cm", "float_planted_pct",
           "foot_pen_max_cm", "root_jerk_mean", "acc_rms", "track_pos_cm", "limb_angle_deg")
FPS = 50


def measured(tool: str, robot: str, clip: pathlib.Path, motion: pathlib.Path) -> dict:
    """Returns the metrics of a motion compared with its clip, and the missed gates."""
    done = subprocess.run([tool, "evaluate", motion, "--robot", robot, "--bvh", clip, "--fps", str(FPS), "--json", "-"],
                          capture_output=True, text=True, check=False)
    return json.loads(done.stdout)["motions"][0]


def live(tool: str, robot: str, clip: pathlib.Path, output: pathlib.Path, lag_ms: int | None) -> None:
    """Plays a clip to a live run; without a lag, frame by frame."""
    mode = ["--mode", "frame"] if lag_ms is None else ["--mode", "lag", "--lag", str(lag_ms / 1000)]
    player = subprocess.Popen([tool, "live", "-q", "--play", clip, "--to", "stdout", "--speed", "0"],
                              stdout=subprocess.PIPE)
    subprocess.run([tool, "live", "-q", "--robot", robot, "--skeleton", clip, "--fps", str(FPS), *mode, "-o", output],
                   stdin=player.stdout, check=True)
    player.stdout.close()
    player.wait()


def figure(report: dict, key: str) -> float:
    """Returns a metric of a JSON report."""
    value = report[key]
    return value[0] if isinstance(value, list) else value


def main() -> None:
    """Prints a row of means over the clips for each lag, and one for the offline fit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool")
    parser.add_argument("clips", nargs="+", type=pathlib.Path)
    parser.add_argument("--robot", default="unitree_g1")
    arguments = parser.parse_args()
    rows: list[tuple[str, int | None]] = [("frame", None), *((f"lag {lag} ms", lag) for lag in LAGS_MS)]
    print("| | gates missed |", " | ".join(FIGURES), "|")
    print("|---" * (len(FIGURES) + 2) + "|")
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "live.csv"
        for name, lag in [*rows, ("whole clip", -1)]:
            reports = []
            for clip in arguments.clips:
                if lag == -1:
                    subprocess.run([arguments.tool, "-q", clip, arguments.robot, "--fps", str(FPS), "-o", output],
                                   check=True)
                else:
                    live(arguments.tool, arguments.robot, clip, output, lag)
                reports.append(measured(arguments.tool, arguments.robot, clip, output))
            missed = sum(not gate["passed"] for report in reports for gate in report["gates"])
            means = [sum(figure(report, key) for report in reports) / len(reports) for key in FIGURES]
            print(f"| {name} | {missed} |", " | ".join(f"{mean:.3g}" for mean in means), "|", flush=True)


if __name__ == "__main__":
    main()
