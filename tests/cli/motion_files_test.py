"""Files next to and between runs: no input is overwritten, differences are reported, and missing
information is required or reported."""

import json
import math
import os
import pathlib
import pickle
import unittest

from tool import SOURCE, ToolTest, difference, needs_posix, read_rows, sample, short_clip

GOLDEN = SOURCE / "tests" / "golden" / "walk.csv"
G1 = ("--robot", "unitree_g1")


class NothingIsOverwritten(ToolTest):
    def test_outputs_are_no_inputs(self):
        clip = self.folder / "w.bvh"
        clip.write_bytes(pathlib.Path(sample("wave")).read_bytes())
        before = clip.read_bytes()
        for option in ("--report", "--write-map"):
            self.assert_fails(self.retarget(option, "w.bvh", bvh=clip), 2, "overwrite")
        self.assertEqual(clip.read_bytes(), before)
        self.assert_done(self.retarget("--method", "gmr"))
        motion = self.folder / "out.csv"
        before = motion.read_bytes()
        self.assert_fails(self.run_tool("evaluate", "out.csv", "--robot", "unitree_g1", "--json",
                                        "out.csv"), 2, "overwrite")
        self.assertEqual(motion.read_bytes(), before)

    def test_motion_and_report_come_together(self):
        self.assertEqual(self.retarget("--method", "gmr", "--report", "/dev/full").returncode, 1)
        self.assertEqual(self.files(), [])


class Differences(ToolTest):
    def test_the_tolerance_itself_agrees(self):
        self.write("a.csv", "0.043508,1,2\n0.1,1,2\n")
        self.write("b.csv", "0.043509,1,2\n0.1,1,2\n")
        self.assert_done(self.run_tool("compare", "a.csv", "b.csv", "--tolerance", "1e-6"))
        self.write("c.csv", "0.043510,1,2\n0.1,1,2\n")
        self.assert_fails(self.run_tool("compare", "a.csv", "c.csv", "--tolerance", "1e-6"), 1)

    def test_rates_are_compared_and_empty_files_do_not_agree(self):
        self.assert_done(self.retarget("--method", "gmr"))
        for fps in ("30", "25"):
            self.assert_done(self.run_tool("convert", "out.csv", f"{fps}.pkl", "--robot",
                                           "unitree_g1", "--format", "pkl-gmr", "--source-fps",
                                           fps))
        self.assert_done(self.run_tool("compare", "30.pkl", "30.pkl"))
        self.assert_fails(self.run_tool("compare", "30.pkl", "25.pkl"), 1, "fps")
        (self.folder / "empty.pkl").write_bytes(pickle.dumps({"about": "nothing"}, protocol=4))
        self.assert_fails(self.run_tool("compare", "empty.pkl", "empty.pkl"), 3)


class MotionFilesTest(ToolTest):
    """A test that has the golden walk with the usual six digits."""

    def setUp(self):
        super().setUp()
        self.assert_done(self.run_tool("convert", GOLDEN, "plain.csv", *G1))

    def assert_plain(self, name="out.csv"):
        found, wanted = (read_rows((self.folder / each).read_text()) for each in (name, "plain.csv"))
        # Quaternions are normalised.
        self.assertIsNone(difference(found, wanted, 1.5e-6))


class Headers(MotionFilesTest):
    """CSV columns are read by their names, or the file is rejected."""

    def setUp(self):
        super().setUp()
        self.assert_done(self.run_tool("convert", GOLDEN, "named.csv", *G1, "--csv-header"))
        self.header, _, self.rows = (self.folder / "named.csv").read_text().partition("\n")

    def convert(self, header, *arguments, rows=None):
        self.write("in.csv", header + "\n" + (self.rows if rows is None else rows))
        return self.run_tool("convert", "in.csv", "out.csv", *G1, *arguments)

    def test_names_in_foreign_spellings(self):
        # In another order, so that reading by position would give another motion.
        names = self.header.split(",")[::-1]
        self.header = ",".join(names)
        self.rows = "".join(",".join(line.split(",")[::-1]) + "\n"
                            for line in self.rows.splitlines())
        for header in (",".join(f'"{name}"' for name in names), self.header.upper(),
                       ",".join("robot/" + name for name in names), "\ufeff" + self.header):
            self.assert_done(self.convert(header))
            self.assert_plain()
        self.assert_done(self.convert(";".join(names), rows=self.rows.replace(",", ";")))
        self.assert_plain()

    def test_unknown_files_are_not_guessed(self):
        letters = ",".join(f"c{i}" for i in range(36))
        self.assert_fails(self.convert(letters), 3, "not understood", '"c0", "c1"',
                          "--ignore-header")
        self.assert_fails(self.run_tool("evaluate", "in.csv", *G1), 3, "not understood")
        self.assert_done(self.convert(letters, "--ignore-header"))
        self.assert_plain()

    def test_omitted_joints_are_reported(self):
        names = self.header.split(",")
        few = [",".join(line.split(",")[:20]) for line in self.rows.splitlines()]
        self.assert_fails(self.convert(",".join(names[:20]), rows="\n".join(few)), 3,
                          "names 13 joints", "missing: waist_roll_joint", "right_wrist_yaw_joint")
        self.assert_done(self.run_tool("convert", GOLDEN, "few.csv", *G1, "--csv-header", "--dof",
                                       "23-pbhc"))
        result = self.run_tool("convert", "few.csv", "out.csv", *G1)
        self.assert_done(result)
        self.assertIn("warning: 6 of the robot's 29 joints are not in the file", result.stderr)

    def test_times_are_the_rate(self):
        lines = self.rows.splitlines()
        for unit, name, ticks in (("s", "time", 0.02), ("ms", "time_ms", 20)):
            timed = "\n".join(f"{i * ticks:.6f},{line}" for i, line in enumerate(lines))
            result = self.convert(f"{name},{self.header}", rows=timed)
            self.assert_done(result)
            self.assertIn("at 50 fps", result.stderr)
            result = self.convert(f"{name},{self.header}", "--source-fps", "30", rows=timed)
            self.assert_done(result)
            self.assertIn("warning: the file has times in " + unit, result.stderr)
            result = self.run_tool("evaluate", "in.csv", *G1, "--gate", "none", "--json", "r.json")
            self.assert_done(result)
            report = json.loads((self.folder / "r.json").read_text())
            self.assertEqual(report["motions"][0]["fps"], 50)
        odd = "\n".join(f"{i + (i > 30)},{line}" for i, line in enumerate(lines))
        self.assert_fails(self.convert(f"time,{self.header}", rows=odd), 3, "--source-fps")


class Rates(ToolTest):
    """Files preserve the speed of a motion."""

    def test_soma_round_trips(self):
        self.assert_done(self.run_tool("convert", GOLDEN, "soma.csv", *G1, "--format", "csv-soma",
                                       "--precision", "9"))
        result = self.run_tool("convert", "soma.csv", "back.pkl", *G1, "--format", "pkl-gmr")
        self.assert_done(result)
        self.assertIn("csv-soma, 301 frames at 30 fps", result.stderr)
        self.assert_done(self.run_tool("convert", GOLDEN, "there.pkl", *G1, "--format", "pkl-gmr"))
        self.assert_done(self.run_tool("compare", "there.pkl", "soma.csv", *G1))
        result = self.run_tool("evaluate", "soma.csv", *G1, "--gate", "none", "--json", "r.json")
        self.assert_done(result)
        self.assertEqual(json.loads((self.folder / "r.json").read_text())["motions"][0]["fps"], 30)

    def test_a_rate_that_soma_cannot_store_is_reported(self):
        result = self.run_tool("convert", GOLDEN, "soma.csv", *G1, "--format", "csv-soma",
                               "--source-fps", "50")
        self.assert_done(result)
        self.assertIn("its readers assume 120 fps, this motion has 50", result.stderr)
        for command in (("convert", "soma.csv", "x.csv"), ("evaluate", "soma.csv", "--gate", "none"),
                        ("compare", "soma.csv", "soma.csv")):
            result = self.run_tool(*command, *G1)
            self.assert_done(result)
            self.assertIn("at 120 fps; the file states no rate", result.stderr)
            said = " ".join(result.stderr.split())
            self.assertIn("SOMA's 120 fps are assumed, --", said)
            self.assertIn("fps states another rate", said)
            result = self.run_tool(*command, *G1, "--source-fps", "50")
            self.assert_done(result)
            self.assertIn("at 50 fps\n", result.stderr)
        result = self.run_tool("evaluate", "soma.csv", "--gate", "none", *G1, "--fps", "50")
        self.assertIn("at 50 fps\n", result.stderr)

    def test_rates_are_compared_if_files_state_them(self):
        for fps in ("30", "25"):
            self.assert_done(self.run_tool("convert", GOLDEN, f"{fps}.pkl", *G1, "--format",
                                           "pkl-gmr", "--source-fps", fps))
        self.assert_fails(self.run_tool("compare", "30.pkl", "25.pkl", *G1), 1, "fps")
        self.assert_done(self.run_tool("compare", "25.pkl", GOLDEN, *G1))
        self.assert_fails(self.run_tool("compare", "30.pkl", "25.pkl", "--source-fps", "30"), 2,
                          "--robot")


class Reading(MotionFilesTest):
    def report_of(self, *arguments):
        result = self.run_tool("evaluate", *arguments, *G1, "--gate", "none", "--json", "r.json")
        self.assert_done(result)
        report = json.loads((self.folder / "r.json").read_text())["motions"][0]
        del report["file"]
        return report, result.stderr

    def test_evaluate_finds_the_order_of_the_quaternion(self):
        self.assert_done(self.run_tool("convert", GOLDEN, "wxyz.csv", *G1, "--csv-quat", "wxyz"))
        golden, _ = self.report_of("plain.csv")
        found, said = self.report_of("wxyz.csv")
        self.assertEqual(found, golden)
        self.assertIn("quaternion wxyz", said)
        wrong, _ = self.report_of("wxyz.csv", "--source-quat", "xyzw")
        self.assertNotEqual(wrong, golden)
        lying = ("0,0,.2,.5,.5,.5,.5" + ",0" * 29 + "\n") * 20
        self.write("lying.csv", lying)
        result = self.run_tool("evaluate", "lying.csv", *G1, "--gate", "none")
        self.assert_done(result)
        self.assertIn("read as xyzw", result.stderr)
        self.assertIn("--source-quat", result.stderr)
        result = self.run_tool("evaluate", "lying.csv", *G1, "--source-quat", "xyzw", "--gate", "none")
        self.assert_done(result)
        self.assertNotIn("equally plausible", result.stderr)

    def test_a_motion_that_fits_both_orders_is_read_as_written(self):
        part = ("--start", "2.7", "--end", "4.8")
        clip = sample("get_up")
        self.assert_done(self.retarget(*part, "--sidecar", bvh=clip, output="own.csv"))
        recorded = self.run_tool("convert", "own.csv", "recorded.csv", *G1)
        self.assert_done(recorded)
        self.assertNotIn("equally plausible", recorded.stderr)
        (self.folder / "own.csv.json").unlink()
        result = self.run_tool("convert", "own.csv", "read.csv", *G1)
        self.assert_done(result)
        self.assertIn("equally plausible", result.stderr)
        self.assertEqual((self.folder / "read.csv").read_bytes(),
                         (self.folder / "recorded.csv").read_bytes())

    def test_units_hold_for_all_of_a_file(self):
        self.assert_done(self.run_tool("convert", GOLDEN, "soma.csv", *G1, "--format", "csv-soma",
                                       "--precision", "12"))
        rows = [line.split(",") for line in (self.folder / "soma.csv").read_text().splitlines()]
        for row in rows[1:]:
            row[4:] = [repr(math.radians(float(value))) for value in row[4:]]
        self.write("rad.csv", "".join(",".join(row) + "\n" for row in rows))
        self.assert_done(self.run_tool("convert", "rad.csv", "out.csv", *G1, "--source-angles",
                                       "rad"))
        self.assert_plain()
        self.assert_done(self.run_tool("convert", GOLDEN, "a.pkl", *G1, "--format", "pkl-gmr"))
        motion = pickle.loads((self.folder / "a.pkl").read_bytes()) if self.has_numpy() else None
        if motion:
            motion["dof_pos"] = motion["dof_pos"] * 180 / math.pi
            motion["root_pos"] = motion["root_pos"] * 100
            self.write("deg.pkl", pickle.dumps(motion))
            self.assert_done(self.run_tool("convert", "deg.pkl", "out.csv", *G1, "--source-angles",
                                           "deg", "--source-unit", "cm"))
            self.assert_plain()
        self.assert_done(self.run_tool("convert", GOLDEN, "a.npz", *G1, "--format", "npz-mjlab"))
        for option in (("--source-angles", "deg"), ("--source-unit", "cm")):
            self.assert_fails(self.run_tool("convert", "a.npz", "x.csv", *G1, *option), 3,
                              "radians and metres")

    @staticmethod
    def has_numpy():
        try:
            import numpy  # pylint: disable=unused-import,import-outside-toplevel
        except ImportError:
            return False
        return True

    def test_old_pickles_are_named(self):
        for protocol in (0, 1):
            self.write("old.pkl", pickle.dumps({"fps": 30, "root_pos": [[0.0, 0.0, 1.0]]}, protocol))
            self.assert_fails(self.run_tool("convert", "old.pkl", "x.csv", *G1), 3,
                              "protocol 0 or 1", "pickle.dump(motion, file)")

    def test_bombs_are_refused(self):
        if not self.has_numpy():
            self.skipTest("no numpy")
        import gzip  # pylint: disable=import-outside-toplevel

        import numpy  # pylint: disable=import-outside-toplevel
        numpy.savez_compressed(self.folder / "bomb.npz",
                               joint_pos=numpy.zeros((400_000, 29), numpy.float32))
        self.assertLess((self.folder / "bomb.npz").stat().st_size, 100_000)
        self.assert_fails(self.run_tool("compare", "bomb.npz", "bomb.npz"), 3, "compression ratio is implausible")
        self.write("bomb.pkl", gzip.compress(b"\x80\x04" + bytes(40 << 20)))
        self.assert_fails(self.run_tool("convert", "bomb.pkl", "x.csv", *G1), 3, "unpacked")


class Losses(ToolTest):
    def test_lost_wrists_are_reported(self):
        for command in (("convert", GOLDEN, "out.pkl"),
                        ("--bvh", sample("walk"), "-o", "out.pkl", "--frames", "0:30", "--method",
                         "gmr")):
            result = self.run_tool(*command, *G1, "--format", "pkl-pbhc")
            self.assert_done(result)
            self.assertIn("warning: pkl-pbhc has the joints of the variant 23-pbhc: 6 joints "
                          "with movement would be locked, losing up to 0.", result.stderr)
            self.assertIn("--dof 23-pbhc omits them", result.stderr)
        largest = max(max(abs(value) for value in row[26:29] + row[33:36])
                      for row in read_rows(GOLDEN.read_text()))
        result = self.run_tool("convert", GOLDEN, "out.pkl", *G1, "--format", "pkl-pbhc")
        self.assertIn(f"losing up to {round(largest, 3):g} rad", result.stderr)
        self.assert_done(self.run_tool("convert", GOLDEN, "few.csv", *G1, "--dof", "23-pbhc"))
        result = self.run_tool("convert", "few.csv", "out.pkl", *G1, "--source-dof", "23-pbhc",
                               "--format", "pkl-pbhc")
        self.assertNotIn("lost", result.stderr)


class Names(ToolTest):
    def test_names_identify_the_file(self):
        for name, words in (("x.NPZ", "npz-mjlab, npz-beyondmimic"), ("x.Pkl", "pkl-gmr, pkl-pbhc"),
                            ("x.pickle", "pkl-gmr"), ("x.joblib", "pkl-gmr"),
                            ("x.bvh", "ends in .bvh"), ("x.json", "ends in .json"),
                            ("x.JSON", "ends in .JSON"), ("x.csv.gz", "ends in .gz")):
            self.assert_fails(self.retarget(output=name), 2, words)
        self.assert_fails(self.retarget("--format", "npz-mjlab", output="x.CSV"), 2, "ends in .CSV")
        self.assertEqual(self.files(), [])
        self.assert_done(self.run_tool("convert", GOLDEN, "x.NPZ", *G1, "--format", "npz-mjlab"))
        self.assert_done(self.run_tool("convert", GOLDEN, "y.CSV", *G1, "--format",
                                       "csv,npz-mjlab"))
        self.assert_done(self.run_tool("convert", GOLDEN, "z.pickle", *G1, "--format", "pkl-gmr"))
        self.assertEqual(self.files(), ["x.NPZ", "y.csv", "y.mjlab.npz", "z.pickle"])

    def test_motions_have_the_whole_name_of_their_file(self):
        for output, name in (("walk.v2", "walk.v2"), ("walk.v2.motion-lib.pkl", "walk.v2"),
                             ("walk.motion-lib.pkl", "walk"), ("f23.976.PKL", "f23.976")):
            self.assert_done(self.run_tool("convert", GOLDEN, output, *G1, "--format",
                                           "pkl-motion-lib"))
            bytes_of_file = (self.folder / output).read_bytes()
            # A short text after the opening of the dictionary.
            self.assertEqual(bytes_of_file[4:4 + len(name) + 2],
                             b"\x8c" + bytes([len(name)]) + name.encode(), output)
        self.assert_done(self.run_tool("convert", GOLDEN, "take.3/", *G1, "--format", "csv-sonic"))
        self.assertIn("Metadata for: take.3\n", (self.folder / "take.3/metadata.txt").read_text())

    @needs_posix
    def test_names_that_are_not_utf8(self):
        clip = os.fsdecode(b"bad\xff clip.bvh")
        self.write(clip, short_clip("wave", 3))
        out = os.fsdecode(b"bad\xff out")
        self.assert_done(self.retarget("--method", "gmr", "--sidecar", "--format",
                                       "csv,pkl-pbhc", bvh=clip, output=out,
                                       errors="surrogateescape"))
        sidecar = self.folder / (out + ".csv.json")
        found = json.loads(sidecar.read_text(encoding="utf-8"))
        self.assertEqual(bytes.fromhex(found["output"]["file_hex"]), b"bad\xff out.csv")
        self.assertEqual(bytes.fromhex(found["options"]["motion_hex"]), b"bad\xff clip.bvh")
        self.assertIn("file_hex", found["inputs"][0])
        self.assert_done(self.run_tool("verify", sidecar, errors="surrogateescape"))
        if Reading.has_numpy():
            motions = pickle.loads((self.folder / (out + ".pbhc.pkl")).read_bytes())
            self.assertEqual(list(motions), ["bad\ufffd out"])


class EditedSidecars(ToolTest):
    def test_options_follow_the_rules_of_the_command_line(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:3", "--sidecar"))
        text = (self.folder / "out.csv.json").read_text()
        for name, value, words in (("precision", 2_000_000_000, '"precision"'),
                                   ("precision", -1, '"precision"'), ("precision", 1e300, ""),
                                   ("precision", 6.5, '"precision"'), ("method", "magic", '"method"'),
                                   ("csv-delimiter", "pipe", '"csv-delimiter"'),
                                   ("npz-fps", 0, '"npz-fps"'), ("start", -7.0, '"start"'),
                                   ("height", 1e9, '"height"'), ("format", ["tape"], '"format"'),
                                   ("source-fps", -3.0, '"source-fps"'), ("start", 1.0, "--frames"),
                                   ("robot-xml", "r.xml", "--robot-xml"), ("lenient", 1, "lenient")):
            edited = json.loads(text)
            edited["options"][name] = value
            self.write("out.csv.json", json.dumps(edited))
            with self.subTest(name=name, value=value):
                self.assert_fails(self.run_tool("verify", "out.csv.json"), 3, "out.csv.json", words)
        self.write("out.csv.json", text)
        self.assert_done(self.run_tool("verify", "out.csv.json"))


class FramesInFront(ToolTest):
    """A leading frame of zeros, from which the motion jumps."""

    def setUp(self):
        super().setUp()
        lines = short_clip("walk", 60).decode().splitlines()
        count = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
        zeros = " ".join("0" for _ in lines[count + 2].split())
        self.write("in.bvh", "\n".join([*lines[:count], "Frames: 61", lines[count + 1], zeros,
                                        *lines[count + 2:]]) + "\n")

    def sidecar(self, *arguments):
        self.assert_done(self.retarget("--sidecar", *arguments, bvh="in.bvh"))
        return json.loads((self.folder / "out.csv.json").read_text())

    def test_sidecars_store_the_lead_in(self):
        self.assertEqual(self.sidecar()["found"]["lead_in_frames"], 1)
        self.assertEqual(self.sidecar("--lead-in", "keep")["found"]["lead_in_frames"], 0)
        self.assertEqual(self.sidecar("--frames", "0:9")["found"]["lead_in_frames"], 0)

    def test_old_sidecars_keep_every_frame(self):
        kept = self.sidecar("--lead-in", "keep")
        del kept["options"]["lead-in"]
        self.write("out.csv.json", json.dumps(kept))
        self.assert_done(self.run_tool("verify", "out.csv.json"))
        dropped = self.sidecar()
        self.assert_done(self.run_tool("verify", "out.csv.json"))
        del dropped["options"]["lead-in"]
        self.write("out.csv.json", json.dumps(dropped))
        self.assert_fails(self.run_tool("verify", "out.csv.json"), 1, "the output differs")


class Messages(ToolTest):
    def test_columns_that_do_not_fit(self):
        golden = SOURCE / "tests" / "golden" / "walk.csv"
        # The joint count selects the whole robot, as with --dof.
        self.assert_done(self.run_tool("convert", golden, "same.csv", *G1, "--source-dof", 29))
        self.assert_done(self.run_tool("compare", golden, "same.csv"))
        self.assert_fails(self.run_tool("convert", golden, "x.csv", *G1, "--source-dof", 23), 3,
                          "36 columns, the robot unitree_g1 needs 30: 7 of the root and 23 joints")
        self.assert_fails(self.run_tool("convert", golden, "x.csv", *G1, "--source-dof", "42"), 4,
                          'no variant "42"')
        short = "\n".join(row.rsplit(",", 1)[0] for row in golden.read_text().splitlines())
        self.assert_fails(self.run_tool("convert", self.write("35.csv", short), "x.csv", *G1), 3,
                          "35 columns, the robot unitree_g1 needs 36", "30 (23)")

    def test_hints_do_not_repeat_given_arguments(self):
        self.assert_done(self.retarget("--format", "npz-mjlab", output="g1.npz"))
        other = ("convert", "g1.npz", "x.csv", "--robot", "fourier_n1")
        self.assert_fails(self.run_tool(*other, "--from", "npz-mjlab"), 3, "29 joints")
        self.assertNotIn("--from", self.run_tool(*other, "--from", "npz-mjlab").stderr)
        copy = self.write("scene.xml", (SOURCE / "robots/unitree_g1/model.xml").read_text())
        model = ("--bvh", sample("wave"), "--robot-xml", copy, "-o", "x.csv")
        for kind in ("published", "derived"):
            result = self.run_tool(*model, "--ik-config", kind)
            self.assert_fails(result, 4, f"no {kind} retargeting configuration", "robots add")
            self.assertNotIn("omit --ik-config", result.stderr)
        self.assert_fails(self.run_tool(*model), 2, "has no retargeting configuration", "robots add")


if __name__ == "__main__":
    unittest.main()
