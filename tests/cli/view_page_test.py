"""Pages of `retarget view` and `--html`: the contents of the files. view_browser_test.py opens them."""

import json
import math
import re
import shutil
import unittest

import numpy as np

from pages import data_of, tracks_of
from tool import SHARED, SOURCE, ToolTest, needs_shared, sample, short_clip

KILOBYTE, MEGABYTE = 1000, 1000000


class PageFiles(ToolTest):
    """Without a browser."""

    def long_walk(self, times):
        """Returns the sample walk repeated `times` times."""
        lines = sample("walk").read_text().splitlines()
        at = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
        rows = lines[at + 2 :] * times
        return self.write(
            "long.bvh",
            "\n".join([*lines[:at], f"Frames: {len(rows)}", lines[at + 1], *rows]) + "\n",
        )

    def run_page(self, *options, clip, output="walk.csv"):
        self.assert_done(
            self.retarget(
                "--html", "page.html", *options, bvh=clip, robot="unitree_g1", output=output
            )
        )
        return (self.folder / "page.html").read_text()

    def test_a_minute_is_small(self):
        page = self.run_page("--method", "gmr", clip=self.long_walk(6))
        header, *sizes = data_of(page)
        self.assertEqual(header["motions"][0]["frames"], 1806)
        self.assertLess(sum(sizes), 300 * KILOBYTE)
        self.assertLess(len(page), 1.5 * MEGABYTE)

    @needs_shared
    def test_a_minute_of_captured_motion_is_small(self):
        clip = SHARED / "data/lafan1/dance1_subject2.bvh"
        page = self.run_page("--method", "gmr", "--end", 60, clip=clip)
        header, *sizes = data_of(page)
        self.assertGreaterEqual(header["motions"][0]["frames"], 1800)
        self.assertLess(sum(sizes), 300 * KILOBYTE)

    @needs_shared
    def test_a_source_of_smpl(self):
        clip = SHARED / "data/smpl/smpl_walk.npz"
        self.assert_done(self.retarget("--method", "gmr", bvh=clip, output="walk.csv"))
        view = ("view", "walk.csv", "--robot", "unitree_g1", "-o", "page.html")
        self.assert_done(self.run_tool(*view, "--smpl", clip))

    def test_the_same_bytes_every_time(self):
        clip = self.write("walk.bvh", short_clip("walk", 40))
        self.assertEqual(self.run_page(clip=clip), self.run_page(clip=clip))

    def test_the_figures_are_those_of_the_report(self):
        clip = self.write("walk.bvh", short_clip("walk", 61))
        page = self.run_page("--report", "walk.json", clip=clip)
        [report] = json.loads((self.folder / "walk.json").read_text())["motions"]
        shown = data_of(page)[0]["motions"][0]["report"]
        keys = [each["key"] for each in shown["figures"]]
        self.assertIn("limb_angle_deg", keys)
        self.assertEqual(keys, [key for key in report if key in keys])
        for figure in shown["figures"]:
            both = [figure["value"], figure["p95"]] if "p95" in figure else figure["value"]
            self.assertEqual(both, report[figure["key"]])
        self.assertEqual(len(shown["faults"]), len(report["faults"]))
        # A page made later from the file shows them, too.
        self.assert_done(
            self.run_tool(
                "view", "walk.csv", "--robot", "unitree_g1", "--bvh", clip, "-o", "again.html"
            )
        )
        again = data_of((self.folder / "again.html").read_text())[0]["motions"][0]["report"]
        # A file does not record whether the solver failed; all other figures are equal.
        of_file = [each for each in shown["figures"] if each["key"] != "solver_failures"]
        self.assertEqual(again["figures"], of_file)

    def test_errors_over_time_are_those_of_the_report(self):
        clip = self.write("walk.bvh", short_clip("walk", 61))
        # At a rate at which every frame has its errors.
        page = self.run_page("--method", "gmr", "--fps", 15, "--report", "walk.json", clip=clip)
        [report] = json.loads((self.folder / "walk.json").read_text())["motions"]
        header, tracks = data_of(page)[0], tracks_of(page)
        errors = {each["body"]: each for each in header["motions"][0]["errors"]}
        # The errors of each body's last table.
        rows = {row["body"]: row for row in report["tracking"]}
        self.assertEqual(errors.keys(), rows.keys())
        self.assertGreater(len(rows), 10)
        self.assertEqual(header["motions"][0]["error_stride"], 1)
        curves = 0
        for body, row in rows.items():
            for key, figure, near in (
                ("position", "position_cm", header["precision"]["error_cm"]),
                ("rotation", "rotation_deg", header["precision"]["error_deg"]),
            ):
                if row[figure] is None:
                    self.assertNotIn(key, errors[body])
                    continue
                values = tracks[errors[body][key]][:, 0]
                self.assertEqual(len(values), report["frames"])
                self.assertAlmostEqual(values.mean(), row[figure], delta=near + 1e-9)
                p95 = np.percentile(values, 95)
                self.assertAlmostEqual(p95, row[figure.replace("_", "_p95_")], delta=0.3)
                curves += 1
        self.assertGreater(curves, 15)

    def test_humans_are_drawn_as_the_header_describes(self):
        """Colours and chains have one source: the script has neither names of limbs nor colours of sides."""
        page = self.run_page("--method", "gmr", clip=self.write("walk.bvh", short_clip("walk", 20)))
        figure = data_of(page)[0]["figure"]
        self.assertEqual(figure["colours"].keys(), {"left", "right", "middle"})
        bones = [bone for chain in figure["chains"] for bone in chain["bones"]]
        for bone in ("Head", "LeftToe", "RightHand"):
            self.assertEqual(bones.count(bone), 1)
        for side in ("left", "right"):
            for chain in (each for each in figure["chains"] if each["side"] == side):
                self.assertTrue(all(bone.lower().startswith(side) for bone in chain["bones"][1:]))
        self.assertNotIn("RightForeArm", page.replace("\n", ""))

    def test_wrong_calls(self):
        clip = self.write("walk.bvh", short_clip("walk", 20))
        self.assert_done(self.retarget(bvh=clip, robot="unitree_g1", output="a.csv"))
        shutil.copy(self.folder / "a.csv", self.folder / "b.csv")
        view = ("view", "a.csv", "--robot", "unitree_g1")
        for arguments, message in (
            (
                (*view, "b.csv", "-o", "two.svg"),
                "a strip of poses shows one motion, found 2 motions",
            ),
            (
                (*view, "--label", "x", "--label", "y", "-o", "p.html"),
                "2 labels and 1 motion are given",
            ),
            ((*view, "--start", 1, "-o", "p.html"), "--start needs the source"),
            ((*view, "-o", "nowhere/p.html"), "nowhere"),
            (
                ("--bvh", clip, "--robot", "unitree_g1", "-o", "c.csv", "--html", "-"),
                "--html needs a file",
            ),
            (
                ("--bvh", clip, "--robot", "unitree_g1", "-o", "c.csv", "--html", clip),
                "overwrite the input",
            ),
        ):
            with self.subTest(message):
                result = self.run_tool(*arguments)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(message, result.stderr)
        for name in ("two.svg", "p.html", "c.csv"):
            self.assertFalse((self.folder / name).exists(), name)

    def test_options_for_the_other_output_are_rejected(self):
        clip = self.write("walk.bvh", short_clip("walk", 20))
        self.assert_done(self.retarget(bvh=clip, robot="unitree_g1", output="a.csv"))
        view = ("view", "a.csv", "--robot", "unitree_g1")
        for arguments, message in (
            (("-o", "p.html", "--strip", 6), "--strip needs a PNG"),
            (("-o", "p.png", "--label", "x"), "--label needs a page"),
            (("-o", "p.svg", "--meshes", "."), "--meshes needs a page"),
        ):
            with self.subTest(message):
                result = self.run_tool(*view, *arguments)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(message, result.stderr)
                self.assertFalse((self.folder / arguments[1]).exists())
        # Both options apply to both motions.
        self.assert_done(self.run_tool(*view, "-o", "P.HTML", "--png", "p.png", "--strip", 2))
        self.assertIn("<!doctype html>", (self.folder / "P.HTML").read_text())

    def test_every_motion_keeps_its_own_rate(self):
        clip = self.write("walk.bvh", short_clip("walk", 61))
        self.assert_done(
            self.retarget(
                "--method",
                "gmr",
                "--format",
                "npz-mjlab",
                "--npz-fps",
                50,
                bvh=clip,
                robot="unitree_g1",
                output="a.npz",
            )
        )
        self.assert_done(
            self.retarget("--method", "gmr", bvh=clip, robot="unitree_g1", output="b.csv")
        )
        self.assert_done(
            self.run_tool(
                "view", "a.npz", "b.csv", "--robot", "unitree_g1", "--bvh", clip, "-o", "p.html"
            )
        )
        first, second = data_of((self.folder / "p.html").read_text())[0]["motions"]
        # Two seconds of both, although the source is sampled at the rate of the first.
        self.assertEqual(first["rate"], second["rate"])
        rate = first["rate"][0] / first["rate"][1]
        self.assertAlmostEqual(rate, 50)
        for motion in (first, second):
            self.assertAlmostEqual((motion["frames"] - 1) / rate, 2.0, delta=0.05)
        self.assertNotIn("file_rate", first)
        self.assertEqual(second["file_rate"], [30, 1])

    def test_a_human_is_turned_as_its_motion_was(self):
        clip = self.write("walk.bvh", short_clip("walk", 61))
        self.assert_done(
            self.retarget("--method", "gmr", bvh=clip, robot="unitree_g1", output="a.csv")
        )
        # A quarter turn to the left about the vertical, and three metres ahead.
        half = math.sqrt(0.5)
        rows = []
        for line in (self.folder / "a.csv").read_text().splitlines():
            x, y, z, qx, qy, qz, qw, *joints = [float(value) for value in line.split(",")]
            turned = [half * (qx - qy), half * (qy + qx), half * (qz + qw), half * (qw - qz)]
            rows.append([3.0 - y, x, z, *turned, *joints])
        turned = self.write(
            "turned.csv", "\n".join(",".join(f"{v:.6f}" for v in row) for row in rows) + "\n"
        )
        self.assert_done(
            self.run_tool(
                "view", "a.csv", turned, "--robot", "unitree_g1", "--bvh", clip, "-o", "p.html"
            )
        )
        motions = data_of((self.folder / "p.html").read_text())[0]["motions"]
        (scale, x, y, yaw), (scale_2, x_2, y_2, yaw_2) = [each["placement"] for each in motions]
        self.assertLess(abs(yaw), 0.1)
        self.assertAlmostEqual(yaw_2 - yaw, math.pi / 2, delta=1e-3)
        self.assertAlmostEqual(scale, scale_2, delta=1e-3)
        self.assertAlmostEqual(x_2, 3.0 - y, delta=2e-3)
        self.assertAlmostEqual(y_2, x, delta=2e-3)

    def test_a_motion_too_far_away_leaves_nothing(self):
        self.assert_done(
            self.retarget(
                bvh=self.write("walk.bvh", short_clip("walk", 20)),
                robot="unitree_g1",
                output="a.csv",
            )
        )
        rows = [line.split(",") for line in (self.folder / "a.csv").read_text().splitlines()]
        for row in rows:
            row[0] = "900000"
        far = self.write("far.csv", "\n".join(map(",".join, rows)) + "\n")
        result = self.run_tool(
            "view", far, "--robot", "unitree_g1", "--source-unit", "m", "-o", "p.html"
        )
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("far.csv: error: frame 0 has a position too far away", result.stderr)
        self.assertFalse((self.folder / "p.html").exists())

    def test_texts_can_be_read_in_light_and_dark(self):
        style = (SOURCE / "viewer/page.css").read_text()
        blocks = re.findall(r":root \{(.*?)\n\s*\}", style, re.DOTALL)
        self.assertEqual(len(blocks), 2)
        for name, block in zip(("light", "dark"), blocks):
            colours = dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block))
            for text, ground in (
                ("ink", "surface"),
                ("ink", "raised"),
                ("ink", "ground"),
                ("soft", "surface"),
                ("soft", "raised"),
                ("good", "good-back"),
                ("bad", "bad-back"),
                ("accent-ink", "accent"),
            ):
                with self.subTest(scheme=name, text=text, ground=ground):
                    self.assertGreaterEqual(contrast(colours[text], colours[ground]), 4.5)


def contrast(a, b):
    """Ratio of two colours as WCAG defines it."""

    def light(colour):
        parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        return sum(
            weight * (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4)
            for weight, part in zip((0.2126, 0.7152, 0.0722), parts)
        )

    high, low = sorted((light(a), light(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


if __name__ == "__main__":
    unittest.main()
