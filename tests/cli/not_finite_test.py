"""Numbers near zero and numbers that are not finite: files with all digits of a robot that stands still
are measured, and what a solver cannot compute is in the verdict, and ends nothing."""

import io
import json
import math
import random
import re
import shutil
import struct
import unittest
import zipfile

from tool import SOURCE, ToolTest, read_rows, sample

NOISE = (1e-12, 1e-10, 1e-9, 3e-9, 1e-8, 1.5e-8, 1e-7)  # rad
ROBOT = "unitree_g1"


def product(a, b):
    """Returns the product of two quaternions x y z w."""
    (x1, y1, z1, w1), (x2, y2, z2, w2) = a, b
    return [w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2, w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
            w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2, w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2]


def standing_rows(pose, noise, frames=90):
    """Rows x y z, quaternion x y z w, joints, with all their digits."""
    numbers = random.Random(1)
    rows = []
    for _ in range(frames):
        turn = [0.5 * noise * numbers.gauss(0, 1) for _ in range(3)] + [1.0]
        joints = [angle + noise * numbers.gauss(0, 1) for angle in pose[7:]]
        rows.append(pose[:3] + product(pose[3:7], turn) + joints)
    return rows


def csv_text(rows):
    return "".join(",".join(f"{value:.17g}" for value in row) + "\n" for row in rows)


def npy(numbers, shape):
    header = str({"descr": "<f8", "fortran_order": False, "shape": shape})
    header += " " * (-(len(header) + 11) % 64) + "\n"
    return (b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode()
            + struct.pack(f"<{len(numbers)}d", *numbers))


def first_row(array):
    """Returns the first row of a float array in a .npy file."""
    header_size = struct.unpack("<H", array[8:10])[0]
    header = array[10:10 + header_size].decode()
    shape = [int(part) for part in re.search(r"\(([^)]*)\)", header).group(1).split(",") if part]
    count = math.prod(shape[1:])
    return list(struct.unpack(f"<{count}f", array[10 + header_size:10 + header_size + 4 * count]))


def standing_npz(made, rows):
    """A tracking NPZ that the tool made, standing still: its bodies as in its first frame, the root's
    rotation and the joints of the rows, as doubles."""
    frames = len(rows)
    with zipfile.ZipFile(made) as archive:
        arrays = {name: archive.read(name) for name in archive.namelist()}
    for name in ("joint_vel", "body_pos_w", "body_lin_vel_w", "body_ang_vel_w", "body_quat_w"):
        row = first_row(arrays[f"{name}.npy"])
        shape = (frames, len(row)) if name == "joint_vel" else (frames, 30, len(row) // 30)
        numbers = [value for each in rows
                   for value in ([each[6], *each[3:6], *row[4:]] if name == "body_quat_w" else row)]
        arrays[f"{name}.npy"] = npy(numbers, shape)
    arrays["joint_pos.npy"] = npy([value for row in rows for value in row[7:]], (frames, 29))
    arrays.pop("contacts.npy", None)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, content in arrays.items():
            archive.writestr(name, content)
    return packed.getvalue()


class StandingStill(ToolTest):
    def setUp(self):
        super().setUp()
        self.assert_done(self.retarget("--end", "0.5", "--precision", "17", "--format",
                                       "csv,npz-mjlab", output="out"))
        self.pose = read_rows((self.folder / "out.csv").read_text())[0]

    def figures(self, file):
        result = self.run_tool("evaluate", file, "--robot", ROBOT, "--dynamics", "--json", "q.json")
        self.assertIn(result.returncode, (0, 1), result.stderr)
        return json.loads((self.folder / "q.json").read_text())["motions"][0]

    def check(self, file):
        figures = self.figures(file)
        self.assertEqual(figures["dynamics_bad_pct"], 0)
        self.assertLess(figures["unexplained_force_pct"][1], 0.2)
        self.assertLess(figures["torque_p99_ratio"], 0.5)
        self.assertGreater(figures["zmp_margin_p5_cm"], 0)

    def test_csv_with_the_noise_of_a_sensor(self):
        for noise in NOISE:
            with self.subTest(noise=noise):
                self.write("still.csv", csv_text(standing_rows(self.pose, noise)))
                self.check("still.csv")

    def test_npz_with_the_noise_of_a_sensor(self):
        for noise in NOISE:
            with self.subTest(noise=noise):
                self.write("still.npz", standing_npz(
                    self.folder / "out.mjlab.npz", standing_rows(self.pose, noise)))
                self.check("still.npz")

    def test_a_clip_that_stands_still_takes_all_steps(self):
        """BVH with all digits of a human who stands still."""
        lines = sample("wave").read_text().splitlines()
        motion = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
        row = [float(value) for value in lines[motion + 2].split()]
        numbers = random.Random(2)
        for noise in (1e-7, 1e-6):  # degrees
            with self.subTest(noise=noise):
                rows = [" ".join(f"{value + noise * numbers.gauss(0, 1):.12f}" for value in row)
                        for _ in range(60)]
                clip = self.write("still.bvh", "\n".join(
                    [*lines[:motion], "Frames: 60", lines[motion + 1], *rows]) + "\n")
                self.assert_done(self.retarget("--report", "r.json", bvh=clip))
                report = json.loads((self.folder / "r.json").read_text())["motions"][0]
                self.assertTrue(report["fit"]["solver"]["converged"], report["fit"]["notes"])
                self.assertGreaterEqual(report["fit"]["solver"]["steps"], 10)
                self.assertEqual(report["fit"]["solver"]["failed_blocks"], 0)
                self.assertEqual(report["solver_failures"], 0)

    def test_movements_too_large_to_compute_with_are_measured(self):
        """Any file gives a report or an error, never a signal."""
        for value in (1e5, 1e15, 1e100, 1e200, 1e300):
            for column in (0, 2, 3, 9, 20):
                rows = standing_rows(self.pose, 1e-9, 40)
                rows[20][column] = value
                with self.subTest(value=value, column=column):
                    for name, content in (("far.csv", csv_text(rows)),
                                          ("far.npz", standing_npz(self.folder / "out.mjlab.npz", rows))):
                        self.write(name, content)
                        result = self.run_tool("evaluate", name, "--robot", ROBOT, "--dynamics",
                                               "--source-fps", "50")
                        self.assertGreaterEqual(result.returncode, 0, result.stderr)


class FailedSolvers(ToolTest):
    """A robot so heavy that its forces overflow; its joints are solved as usual."""

    def setUp(self):
        super().setUp()
        shutil.copytree(SOURCE / "robots" / ROBOT, self.folder / "heavy")
        model = self.folder / "heavy/model.xml"
        text, count = re.subn(r'<inertial mass="[0-9.e-]+"', '<inertial mass="1e308"',
                              model.read_text(), count=1)
        self.assertEqual(count, 1)
        model.write_text(text)
        self.write("clips/wave.bvh", sample("wave").read_bytes())
        self.options = ["--end", "1.5"]

    def test_verdict_reports_the_failure(self):
        result = self.retarget(*self.options, "--report", "r.json", robot="heavy")
        self.assert_done(result)
        self.assertIn("warning: fit with dynamics: non-finite numbers in frames 0 to 45",
                      result.stderr)
        self.assertIn("missed   solver_failures 1 (at most 0)", result.stderr)
        report = json.loads((self.folder / "r.json").read_text())["motions"][0]
        self.assertFalse(report["passed"])
        self.assertEqual(report["solver_failures"], 1)
        self.assertTrue(report["fit"]["solver"]["dynamics_failed"])
        self.assertEqual([fault["where"] for fault in report["faults"]
                          if fault["metric"] == "solver_failures"], ["fit with dynamics"])
        # The frames equal those without dynamics.
        self.assert_done(self.retarget("--end", "1.5", "--without", "dynamics", robot="heavy",
                                       output="without.csv"))
        self.assertEqual((self.folder / "out.csv").read_bytes(),
                         (self.folder / "without.csv").read_bytes())
        self.assertEqual(self.retarget(*self.options, "--gate", "default", robot="heavy",
                                       output="gated.csv").returncode, 1)

    def test_its_motion_is_measured(self):
        self.assert_done(self.retarget("--end", "1.5", "--without", "dynamics", robot="heavy"))
        result = self.run_tool("evaluate", "out.csv", "--robot", "heavy", "--dynamics", "--json",
                               "q.json")
        self.assertEqual(result.returncode, 0, result.stderr)
        figures = json.loads((self.folder / "q.json").read_text())["motions"][0]
        self.assertEqual(figures["dynamics_bad_pct"], 100)
        for value in figures.values():
            if isinstance(value, float):
                self.assertTrue(math.isfinite(value))

    def test_batches_reject_the_motion(self):
        for more in ((), ("--no-quality",)):
            with self.subTest(more=more):
                out = "out" + "".join(more)
                result = self.run_tool("batch", "clips", "--robot", "heavy", *self.options, *more,
                                       "-o", out)
                self.assert_done(result)
                self.assertEqual((self.folder / out / "passed.txt").read_text(), "")
                entry = json.loads((self.folder / out / "manifest.jsonl").read_text())
                self.assertEqual(entry["quality"]["gates_missed"], ["solver_failures"])
                self.assertEqual(entry["quality"]["figures"]["solver_failures"], 1)
                self.assertIn("non-finite numbers", entry["warnings"][0])


if __name__ == "__main__":
    unittest.main()
