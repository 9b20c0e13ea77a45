"""Robot motions read from every format and converted: detection, required options."""

import os
import pickle
import unittest

from motion_formats import GOLDEN, FormatsTest
from optional_numpy import numpy as np
from tool import SHARED, ToolTest, read_rows, sample


class Conversions(FormatsTest):
    def test_round_trip(self):
        golden = read_rows((GOLDEN / "walk.csv").read_text())
        self.converted(GOLDEN / "walk.csv", "out", "--format", "csv,csv-soma,pkl-gmr",
                       "--precision", "9")
        for name in ("out.csv", "out.soma.csv", "out.gmr.pkl"):
            self.converted(name, "back.csv", "--precision", "9")
            self.assert_same(self.rows("back.csv"), golden, 2e-9)
        # Both tracking formats are recognised and contain the same motion.
        self.converted(GOLDEN / "walk.csv", "out", "--format", "npz-mjlab,npz-beyondmimic")
        for flavour in ("mjlab", "beyondmimic"):
            said = self.converted(f"out.{flavour}.npz", f"{flavour}.csv")
            self.assertIn(f"npz-{flavour}, ", said)
            self.assertIn("at 50 fps", said)
        self.assertEqual((self.folder / "mjlab.csv").read_bytes(),
                         (self.folder / "beyondmimic.csv").read_bytes())

    def test_csv_dialects_are_found(self):
        golden = read_rows((GOLDEN / "walk.csv").read_text())
        dialects = {
            "wxyz": ("--csv-quat", "wxyz"),
            "space": ("--csv-delimiter", "space"),
            "numbered": ("--csv-frame-column", "--csv-delimiter", "tab"),
            "named": ("--csv-header", "--csv-quat", "wxyz", "--csv-frame-column"),
        }
        for name, options in dialects.items():
            self.converted(GOLDEN / "walk.csv", f"{name}.csv", "--precision", "9", *options)
            said = self.converted(f"{name}.csv", "back.csv", "--precision", "9")
            self.assert_same(self.rows("back.csv"), golden, 1e-8)
        self.assertIn("frame numbers", said)
        said = self.converted("wxyz.csv", "back.csv")
        self.assertIn("quaternion wxyz", said)

    def test_units_that_a_csv_does_not_name_are_never_guessed(self):
        golden = read_rows((GOLDEN / "walk.csv").read_text())
        self.converted(GOLDEN / "walk.csv", "other.csv", "--precision", "9", "--csv-degrees",
                       "--csv-centimetres")
        self.assert_fails(self.convert("other.csv", "x.csv"), 3, "--source-angles")
        degrees = ("--source-angles", "deg")
        self.assert_fails(self.convert("other.csv", "x.csv", *degrees), 3, "--source-unit")
        self.converted("other.csv", "back.csv", *degrees, "--source-unit", "cm", "--precision", "9")
        self.assert_same(self.rows("back.csv"), golden, 1e-8)
        # A walk on a roof; an earlier version wrote it on the ground at a hundredth of its size.
        high = np.array(golden)
        high[:, 2] += 7.0
        np.savetxt(self.folder / "high.csv", high, delimiter=",")
        for command in (("convert", "high.csv", "x.csv"), ("evaluate", "high.csv")):
            self.assert_fails(self.run_tool(*command, "--robot", "unitree_g1"), 3, "--source-unit")
        self.assertFalse((self.folder / "x.csv").exists())
        self.converted("high.csv", "x.csv", "--source-unit", "m")
        self.assert_same(self.rows("x.csv"), high.tolist(), 1e-6)

    def test_unknown_properties_are_required(self):
        rows = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        odd = rows.copy()
        odd[:, 10] = 5.0
        np.savetxt(self.folder / "odd.csv", odd, delimiter=",")
        self.assert_fails(self.convert("odd.csv", "x.csv"), 3, "--source-angles")
        high = rows.copy()
        high[:, 2] += 4.0
        np.savetxt(self.folder / "high.csv", high, delimiter=",")
        self.assert_fails(self.convert("high.csv", "x.csv"), 3, "--source-unit")
        self.converted("high.csv", "x.csv", "--source-unit", "m")
        # Two variants have 23 columns.
        np.savetxt(self.folder / "few.csv", rows[:, :30], delimiter=",")
        self.assert_fails(self.convert("few.csv", "x.csv"), 3, "--source-dof", "23, 23-pbhc")
        # A robot that lies still.
        lying = np.repeat(rows[:1], 20, axis=0)
        lying[:, 3:7] = [0.5, 0.5, 0.5, 0.5]
        np.savetxt(self.folder / "lying.csv", lying, delimiter=",")
        result = self.convert("lying.csv", "x.csv")
        self.assert_done(result)
        self.assertIn("warning", result.stderr)
        self.assertIn("--source-quat", result.stderr)
        np.savetxt(self.folder / "crooked.csv", 2 * rows, delimiter=",")
        self.assert_fails(self.convert("crooked.csv", "y.csv"), 3, "expected 1")
        self.assertFalse((self.folder / "y.csv").exists())

    def test_variants(self):
        said = self.converted(GOLDEN / "walk.csv", "few.csv", "--dof", "23-pbhc",
                              "--precision", "9")
        self.assertIn("with movement would be locked", said)
        self.assertEqual(len(self.rows("few.csv")[0]), 30)
        self.converted("few.csv", "all.csv", "--source-dof", "23-pbhc", "--precision", "9")
        wanted = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        wanted[:, [26, 27, 28, 33, 34, 35]] = 0
        self.assert_same(self.rows("all.csv"), wanted.tolist(), 1e-9)

    def test_rates(self):
        frames = np.arange(61)
        rows = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")[:1].repeat(61, axis=0)
        rows[:, 0] = 0.01 * frames + 1e-5 * frames ** 2
        rows[:, 10] = np.sin(0.05 * frames)
        np.savetxt(self.folder / "a.csv", rows, delimiter=",")
        self.converted("a.csv", "b.csv", "--source-fps", "120", "--fps", "60", "--no-antialias",
                       "--source-quat", "xyzw", "--precision", "9")
        self.assert_same(self.rows("b.csv"), rows[::2].tolist(), 1e-8)
        self.converted("a.csv", "c.csv", "--source-fps", "60", "--fps", "120",
                       "--source-quat", "xyzw", "--precision", "9")
        fine = np.arange(0, 60.1, 0.5)
        found = np.array(self.rows("c.csv"))
        self.assertEqual(len(found), 121)
        self.assertLess(np.abs(found[:, 0] - (0.01 * fine + 1e-5 * fine ** 2)).max(), 1e-8)
        self.assertLess(np.abs(found[:, 10] - np.sin(0.05 * fine)).max(), 1e-6)
        # A column of times determines the rate.
        timed = np.column_stack([frames / 120, rows])
        np.savetxt(self.folder / "timed.csv", timed, delimiter=",", fmt="%.9f")
        self.assertIn("at 120 fps", self.converted("timed.csv", "d.csv", "--source-quat",
                                                        "xyzw"))

    def test_python_pickles_of_every_protocol(self):
        rows = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        for protocol in (2, 3, 4, 5):
            for order in ("C", "F"):
                motion = {"fps": np.float64(30), "root_pos": rows[:, :3].astype(">f4"),
                          "root_rot": np.array(rows[:, 3:7], order=order),
                          "dof_pos": np.array(rows[:, 7:], order=order), "local_body_pos": None,
                          "link_body_list": None}
                with open(self.folder / "a.pkl", "wb") as file:
                    pickle.dump(motion, file, protocol)
                self.converted("a.pkl", "b.csv", "--precision", "9")
                self.assert_same(self.rows("b.csv"), rows.tolist(), 1e-6)

    def test_pickles_of_joblib(self):
        try:
            import joblib
        except ImportError:
            self.skipTest("no joblib")
        rows = np.loadtxt(GOLDEN / "walk.csv", delimiter=",")
        dof = np.delete(rows[:, 7:], [19, 20, 21, 26, 27, 28], axis=1)
        motion = {"root_trans_offset": rows[:, :3], "root_rot": rows[:, 3:7],
                  "dof": np.asfortranarray(dof), "fps": 30}
        for compress in (0, 3, ("gzip", 3)):
            joblib.dump({"a": motion, "b": motion}, self.folder / "a.pkl", compress=compress)
            self.assert_fails(self.convert("a.pkl", "b.csv"), 3, "--motion: a, b")
            self.converted("a.pkl", "b.csv", "--motion", "b", "--precision", "9")
            wanted = rows.copy()
            wanted[:, [26, 27, 28, 33, 34, 35]] = 0
            self.assert_same(self.rows("b.csv"), wanted.tolist(), 1e-8)

    def test_nothing_is_executed(self):
        class Evil:
            def __reduce__(self):
                return os.system, (f"touch {self_folder}/executed",)

        self_folder = self.folder
        for protocol in (2, 4):
            self.write("evil.pkl", pickle.dumps({"fps": 30, "root_pos": Evil()}, protocol))
            self.assert_fails(self.convert("evil.pkl", "x.csv"), 3, "system, which is not allowed")
        self.assertEqual(self.files(), ["evil.pkl"])

    def test_other_files_are_named(self):
        self.assert_fails(self.convert(sample("walk"), "x.csv"), 3, "BVH", "retarget it to a robot")
        np.savez(self.folder / "a.npz", poses=np.zeros((3, 156)))
        self.assert_fails(self.convert("a.npz", "x.csv"), 3, "no array \"joint_pos\"")
        self.write("empty.csv", "")
        self.assert_fails(self.convert("empty.csv", "x.csv"), 3, "no frames")


class Lengths(ToolTest):
    def test_a_walk_on_the_ground_is_not_in_metres(self):
        """Scaled walks were once written without a warning."""
        self.assert_done(self.retarget("--frames", "0:90", bvh=sample("walk")))
        rows = read_rows((self.folder / "out.csv").read_text())
        for scale in (0.1, 0.01, 0.001):
            small = [[scale * value for value in row[:3]] + row[3:] for row in rows]
            self.write("small.csv", "".join(",".join(f"{v:.6f}" for v in row) + "\n"
                                            for row in small))
            for command in (("convert", "small.csv", "x.csv"), ("evaluate", "small.csv")):
                line = (*command, "--robot", "g1", "--source-quat", "xyzw")
                self.assert_fails(self.run_tool(*line), 3, "upright", "--source-unit m")
        self.assertFalse((self.folder / "x.csv").exists())
        self.assert_done(self.run_tool("convert", "small.csv", "x.csv", "--robot", "g1",
                                       "--source-quat", "xyzw", "--source-unit", "m"))

    def test_bodies_on_the_ground_are_in_metres(self):
        for name in ("get_up", "squat"):
            self.assert_done(self.retarget(bvh=sample(name), output="own.csv"))
            result = self.run_tool("convert", "own.csv", "x.csv", "--robot", "g1")
            self.assert_done(result)
            self.assertNotIn("warning", result.stderr)


class RealFiles(FormatsTest):
    """Files made by other programs."""

    def setUp(self):
        super().setUp()
        self.data = SHARED / "data" / "robot_motion"
        if not self.data.exists():
            self.skipTest("no folder of shared data: set RETARGET_SHARED to run this test")

    def test_gmr(self):
        self.converted(self.data / "gmr_g1_soma_walk_forward.pkl", "a.csv", "--precision", "12")
        with open(self.data / "gmr_g1_soma_walk_forward.pkl", "rb") as file:
            motion = pickle.load(file)
        wanted = np.hstack([motion["root_pos"], motion["root_rot"], motion["dof_pos"]])
        found = np.array(self.rows("a.csv"))
        found[:, 3:7] *= np.sign((found[:, 3:7] * wanted[:, 3:7]).sum(1, keepdims=True))
        self.assertLess(np.abs(found - wanted).max(), 1e-9)
        # Its true rate is different.
        said = self.converted(self.data / "gmr_g1_soma_walk_forward.pkl", "b.csv", "--source-fps",
                              "120", "--fps", "30")
        self.assertIn("273 frames at 30 fps", said)

    def test_pbhc_and_asap(self):
        for name, frames in (("pbhc_g1_23dof_horse_stance_punch", 200),
                             ("asap_g1_walk_joblib", 152)):
            self.converted(self.data / f"{name}.pkl", f"{name}.csv")
            found = np.array(self.rows(f"{name}.csv"))
            self.assertEqual(found.shape, (frames, 36))
            self.assertEqual(np.abs(found[:, [26, 27, 28, 33, 34, 35]]).max(), 0)
            self.assertGreater(np.abs(found[:, 7:26]).max(), 0.3)
            # Back again.
            self.converted(f"{name}.csv", f"{name}.pkl", "--format", "pkl-pbhc")
            self.converted(f"{name}.pkl", "again.csv")
            self.assert_same(self.rows("again.csv"), found.tolist(), 2e-6)

    def test_unitree(self):
        for clip in ("walk4_subject1", "dance1_subject2", "fallAndGetUp2_subject2"):
            file = SHARED / "data" / "unitree_g1_csv" / f"{clip}.csv"
            rows = np.loadtxt(file, delimiter=",")[:900]
            np.savetxt(self.folder / "a.csv", rows, delimiter=",", fmt="%.6f")
            rows[:, 3:7] = rows[:, [6, 3, 4, 5]]
            np.savetxt(self.folder / "b.csv", rows, delimiter=",", fmt="%.6f")
            self.assertIn("quaternion xyzw", self.converted("a.csv", "c.csv"), clip)
            self.assertIn("quaternion wxyz", self.converted("b.csv", "d.csv"), clip)
            self.assertEqual((self.folder / "c.csv").read_bytes(),
                             (self.folder / "d.csv").read_bytes())


if __name__ == "__main__":
    unittest.main()
