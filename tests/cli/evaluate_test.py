"""`retarget evaluate` and --report as commands: tables, gates, sources and their parts, errors."""

import csv
import json
import os
import subprocess
import unittest

import tool
from tool import SOURCE, ToolTest, sample, short_clip

def mean_of(value):
    """The mean of a list, or a number itself."""
    return sum(value) / len(value) if isinstance(value, list) else value


class EvaluateCommand(ToolTest):
    def setUp(self):
        super().setUp()
        self.good = SOURCE / "tests" / "golden" / "wave.csv"

    def evaluate(self, *arguments, **options):
        return self.run_tool("evaluate", *arguments, "--robot", "unitree_g1", **options)

    def test_table_compares_files_side_by_side(self):
        result = self.evaluate(self.good, SOURCE / "tests/golden/squat.csv", "--gate", "none")
        self.assert_done(result)
        lines = [line.split() for line in result.stdout.splitlines()]
        self.assertEqual(lines[0], ["wave.csv:", "no", "gates"])
        self.assertIn(["metric", "gate", "wave.csv", "squat.csv"], lines)
        self.assertEqual(len([line for line in lines if line[:1] == ["jumps"]]), 1)
        self.assertLessEqual(len(lines), 25)
        every = self.evaluate(self.good, SOURCE / "tests/golden/squat.csv", "--gate", "none", "--all")
        self.assert_done(every)
        rows = [line.split() for line in every.stdout.splitlines()]
        self.assertIn(["metric", "unit", "wave.csv", "squat.csv"], rows)
        self.assertGreater(len(rows), 25)

    def test_the_report_says_which_figures_are_gates(self):
        result = self.evaluate(self.good)
        lines = result.stdout.splitlines()
        self.assertLessEqual(len(lines), 25)
        self.assertRegex(lines[0], r"^wave\.csv: \d+ of \d+ gates passed")
        self.assertRegex(result.stdout, r"\nlimits +[+x] limit_pct \S+ <=0")
        self.assertRegex(result.stdout, r"\nsmoothness +peak_speed [\d.]+ ")
        self.assertNotIn("root_jerk_p99", result.stdout)
        self.assertRegex(self.evaluate(self.good, "--all").stdout, r"\n +root_jerk_p99 +m/s")

    @tool.needs_posix  # Wine writes escape sequences of its own to a terminal.
    def test_colours_are_for_terminals(self):
        def shown(**environment):
            leader, follower = os.openpty()
            result = subprocess.run([tool.TOOL, "evaluate", str(self.good), "--robot", "unitree_g1"],
                                    stdout=follower, stderr=subprocess.PIPE, check=False,
                                    env={**os.environ, "TERM": "xterm", **environment})
            os.close(follower)
            text = b""
            while chunk := self.read_of(leader):
                text += chunk
            os.close(leader)
            self.assertIn(result.returncode, (0, 1), result.stderr)
            return text

        self.assertIn(b"\x1b[32m+\x1b[0m", shown(NO_COLOR=""))
        self.assertNotIn(b"\x1b", shown(NO_COLOR="1"))
        self.assertNotIn("\x1b", self.evaluate(self.good).stdout)

    @staticmethod
    def read_of(descriptor):
        try:
            return os.read(descriptor, 65536)
        except OSError:  # the other side is closed
            return b""

    def test_gates_decide_the_exit_code(self):
        self.assert_done(self.evaluate(self.good, "--gate", "none", "--gate", "jumps=0"))
        result = self.evaluate(self.good, "--gate", "none", "--gate", "peak_speed=0")
        # A result instead of an error.
        self.assertEqual(result.returncode, 1)
        self.assertNotIn("error", result.stderr)
        self.assertRegex(result.stderr, r"missed +wave.csv: peak_speed [\d.]+ \(at most 0\)\n"
                                        r"verdict +wave.csv: 0 of 1 gate passed")
        self.assertIn("wave.csv: peak_speed is", result.stdout)
        gates = self.write("gates.json", '{"gates": {"peak_speed": {"max": 0}}}')
        result = self.evaluate(self.good, "--gate", "none", "--gate", gates, "--quiet")
        self.assertEqual((result.returncode, result.stderr), (1, ""))
        self.assert_done(self.evaluate(self.good, "--gate", "none", "--gate", gates, "--gate",
                                       "peak_speed=none"))

    def test_a_named_gate_without_a_value_is_missed(self):
        for named in ("limb_angle_deg<=90", "limb_angle_deg=90"):
            result = self.evaluate(self.good, "--gate", "none", "--gate", named)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("limb_angle_deg (not measured)", result.stderr)
            self.assertIn("no source of the motion is given", result.stdout)
        # Gates of a file apply to whatever is measured.
        gates = self.write("gates.json", '{"gates": {"limb_angle_deg": {"max": 90}}}')
        self.assert_done(self.evaluate(self.good, "--gate", "none", "--gate", gates))
        # No motion without a scene could pass gates of scenes.
        self.assert_done(self.evaluate(self.good, "--gate", "scene_pen_1cm_pct=0"))

    def test_invalid_gates(self):
        self.assert_fails(self.evaluate(self.good, "--gate", "jmps=0"), 2, 'did you mean "jumps"?')
        self.assert_fails(self.evaluate(self.good, "--gate", "jumps=few"), 2, '"few"')
        for bound in ("nan", "inf", "-inf"):
            self.assert_fails(self.evaluate(self.good, "--gate", f"jumps<={bound}"), 2, bound)
        self.assert_fails(self.evaluate(self.good, "--gate", "no.json"), 4, "no.json")
        self.assert_fails(self.evaluate(self.good, "--gate", self.write("g.json", "{}")), 4, "gates")

    def test_json_on_standard_output_in_place_of_the_table(self):
        result = self.evaluate(self.good, "--json", "-", "--gate", "none")
        self.assert_done(result)
        report = json.loads(result.stdout)
        self.assertEqual(report["motions"][0]["file"], "wave.csv")
        self.assertIn("definition", report["metrics"]["acc_p99"])

    def test_report_has_the_costs_of_the_fit_terms(self):
        result = self.retarget("--report", "run.json", "--without", "self-collision")
        self.assert_done(result)
        motion, = json.loads((self.folder / "run.json").read_text())["motions"]
        terms = {term["name"]: term for term in motion["fit"]["terms"]}
        self.assertEqual(terms["self-collision"]["after"], 0.0)
        self.assertLess(terms["contact-height"]["after"], 0.1 * terms["contact-height"]["before"])
        self.assertTrue(terms["rotation"]["worst_frames"])
        self.assertTrue(motion["fit"]["floor_found"])
        self.assert_done(self.retarget("--report", "gmr.json", "--method", "gmr"))
        motion, = json.loads((self.folder / "gmr.json").read_text())["motions"]
        self.assertNotIn("fit", motion)

    def test_forces_beyond_contacts_are_measured_and_reduced(self):
        self.write("step.bvh", short_clip("walk", 90))
        bad = {}
        for name, options in (("plain", ("--without", "dynamics")), ("dynamics", ())):
            self.assert_done(self.run_tool("--bvh", "step.bvh", "--robot", "unitree_g1",
                                           "-o", f"{name}.csv", *options))
            result = self.run_tool("evaluate", f"{name}.csv", "--robot", "unitree_g1",
                                   "--dynamics", "--gate", "none", "--json", "-")
            self.assert_done(result)
            motion, = json.loads(result.stdout)["motions"]
            bad[name] = motion["dynamics_bad_pct"]
            self.assertIn("torque_over_pct", motion)
        self.assertGreater(bad["plain"], 5.0)
        self.assertLess(bad["dynamics"], 0.5 * bad["plain"])
        # A gate on a metric of inverse dynamics measures them.
        faults = self.run_tool("evaluate", "plain.csv", "--robot", "unitree_g1",
                               "--gate", "none", "--gate", "dynamics_bad_pct=1")
        self.assertEqual(faults.returncode, 1)
        self.assertIn("force along", faults.stdout)
        plain = self.run_tool("evaluate", "plain.csv", "--robot", "unitree_g1", "--gate", "none")
        self.assertNotIn("dynamics_bad_pct", plain.stdout)
        # A run and a batch measure the same values.
        self.assert_done(self.run_tool("--bvh", "step.bvh", "--robot", "unitree_g1", "-o", "run.csv",
                                       "--dynamics", "--report", "run.json"))
        motion, = json.loads((self.folder / "run.json").read_text())["motions"]
        self.assertEqual(motion["dynamics_bad_pct"], bad["dynamics"])
        self.assert_done(self.run_tool("batch", "step.bvh", "--robot", "unitree_g1", "-o", "out",
                                       "--dynamics"))
        with open(self.folder / "out/summary.csv", encoding="utf-8", newline="") as file:
            row, = csv.DictReader(file)
        self.assertEqual(float(row["dynamics_bad_pct"]), bad["dynamics"])
        refused = self.run_tool("batch", "step.bvh", "--robot", "unitree_g1", "-o", "other",
                                "--dynamics", "--no-quality")
        self.assert_fails(refused, 2, "--dynamics and --no-quality cannot be combined")
        wrong = self.run_tool("--bvh", "step.bvh", "--robot", "g1", "-o", "x.csv", "--with", "dynamic")
        self.assert_fails(wrong, 2, 'did you mean "dynamics"?')

    def test_unconverged_fit_is_reported(self):
        few = self.write("few.json", '{"iterations": 1, "extra_iterations": 0}')
        for options, converged in (((), True), (("--fit-config", few), False)):
            with self.subTest(options):
                result = self.retarget("--report", "run.json", "--sidecar", *options,
                                       bvh=tool.sample("turn_in_place"))
                self.assert_done(result)
                self.assertEqual("not converged after 1 step" in result.stderr, not converged)
                motion, = json.loads((self.folder / "run.json").read_text())["motions"]
                solver = motion["fit"]["solver"]
                self.assertEqual(solver["converged"], converged)
                self.assertEqual(solver["steps"], 10 if converged else 1)
                self.assertEqual(solver["failed_blocks"], 0)
                if converged:
                    self.assertGreater(solver["cost_before"], solver["cost_after"])
                self.assertTrue(solver["windows"])
                notes = " ".join(motion["fit"]["notes"])
                self.assertEqual("not converged" in notes, not converged)
                sidecar = json.loads((self.folder / "out.csv.json").read_text())
                self.assertEqual(sidecar["quality"]["motions"][0]["fit"]["solver"], solver)
                self.assertEqual(motion["passed"], converged)

    def test_summary_of_a_good_motion_ignores_missing_convergence(self):
        result = self.retarget("--report", "run.json", bvh=tool.sample("walk"), robot="unitree_h1")
        self.assert_done(result)
        self.assertNotIn("not converged", result.stderr)
        motion, = json.loads((self.folder / "run.json").read_text())["motions"]
        self.assertTrue(motion["passed"])
        self.assertFalse(motion["fit"]["solver"]["converged"])
        self.assertIn("not converged", " ".join(motion["fit"]["notes"]))

    def test_with_a_source_at_another_rate(self):
        clip = tool.sample("wave")
        for fps in ("source", "12"):
            with self.subTest(fps):
                self.assert_done(self.retarget("--fps", fps, "--report", "run.json", bvh=clip))
                result = self.evaluate("out.csv", "--bvh", clip, "--fps", fps, "--json", "e.json",
                                       "--gate", "none")
                self.assert_done(result)
                run, = json.loads((self.folder / "run.json").read_text())["motions"]
                found, = json.loads((self.folder / "e.json").read_text())["motions"]
                self.assertEqual(found["source"], "wave.bvh")
                self.assertIn("track_pos_cm", found)
                # A file does not record whether its solver failed.
                for key in set(run) - {"gates", "passed", "fit", "solver_failures"}:
                    self.assertEqual(found[key], run[key], key)

    def test_the_source_has_the_rate_of_the_motion(self):
        """Files that state a rate, also one that is not the default."""
        clip = self.write("wave.bvh", short_clip("wave", 60))
        for fps, output, options in (("60", "out.pkl", ("--format", "pkl-gmr")),
                                     ("60", "out.csv", ("--sidecar",))):
            with self.subTest(output):
                self.assert_done(self.retarget("--fps", fps, *options, "--report", "run.json",
                                               bvh=clip, output=output))
                run, = json.loads((self.folder / "run.json").read_text())["motions"]
                result = self.evaluate(output, "--bvh", clip, "--json", "e.json", "--gate", "none")
                self.assert_done(result)
                self.assertNotIn("resampled", result.stderr)
                found, = json.loads((self.folder / "e.json").read_text())["motions"]
                self.assertEqual(found["fps"], 60)
                for key in ("frames", "com_acc_p99", "root_acc_p99", "track_pos_cm"):
                    if output.endswith("csv"):
                        self.assertEqual(found[key], run[key], key)
                    else:  # The report measures the digits of a CSV.
                        self.assertLess(abs(mean_of(found[key]) / mean_of(run[key]) - 1), 0.05, key)
        with open(self.folder / "out.pkl", "rb") as stdin:
            piped = self.evaluate("-", "--bvh", clip, "--gate", "none", "--json", "e.json",
                                  stdin=stdin)
        self.assert_done(piped)
        found, = json.loads((self.folder / "e.json").read_text())["motions"]
        self.assertEqual(found["fps"], 60)
        # Several motions share one source.
        self.assert_done(self.run_tool("convert", "out.csv", "slow.pkl", "--robot", "unitree_g1",
                                       "--format", "pkl-gmr", "--fps", "30"))
        result = self.evaluate("out.pkl", "slow.pkl", "--bvh", clip, "--gate", "none")
        self.assert_done(result)
        self.assertIn("slow.pkl: from 30 to 60 fps, the rate of the source", result.stderr)
        self.assertNotIn("out.pkl: from", result.stderr)
        result = self.evaluate("out.pkl", "--bvh", clip, "--fps", "30", "--gate", "none")
        self.assertIn("out.pkl: from 60 to 30 fps, the rate of the source", result.stderr)

    def test_a_part_of_the_source(self):
        """--start and --end name the part of the source that a motion shows."""
        clip = tool.sample("wave")
        part = ("--start", "1", "--end", "2")
        self.assert_done(self.retarget(*part, "--report", "run.json", bvh=clip))
        run, = json.loads((self.folder / "run.json").read_text())["motions"]

        def found(*options):
            result = self.evaluate("out.csv", "--bvh", clip, *options, "--json", "e.json", "--gate", "none")
            self.assert_done(result)
            motion, = json.loads((self.folder / "e.json").read_text())["motions"]
            return motion, result.stderr

        same, messages = found(*part)
        self.assertNotIn("measured only up to its end", messages)
        for key in set(run) - {"gates", "passed", "fit", "solver_failures"}:
            self.assertEqual(same[key], run[key], key)
        # Without --end, the rest of the source may matter, but not its frames beyond the motion.
        self.assertEqual(found("--start", "1")[0]["source_frames"], run["source_frames"])
        shorter, messages = found("--start", "1", "--end", "1.5")
        self.assertIn("measured only up to its end", messages)
        self.assertAlmostEqual(shorter["source_frames"], run["source_frames"] / 2, delta=1)
        self.assertGreater(found("--end", "1")[0]["track_pos_cm"][0], same["track_pos_cm"][0])

    def test_the_recorded_part_of_the_source(self):
        """A sidecar records which frames of the source a motion shows."""
        clip = self.write("wave.bvh", short_clip("wave", 120))
        for output, options in (("part.csv", ("--frames", "30:90")),
                                ("part.pkl", ("--start", "1", "--format", "pkl-gmr")),
                                ("image.csv", ("--end", "2", "--mirror", "--height", "1.6"))):
            with self.subTest(output):
                self.assert_done(self.retarget(*options, "--sidecar", "--report", "run.json",
                                               bvh=clip, output=output))
                run, = json.loads((self.folder / "run.json").read_text())["motions"]
                result = self.evaluate(output, "--bvh", clip, "--json", "e.json", "--gate", "none")
                self.assert_done(result)
                self.assertIn(" ".join(options[:2]), result.stderr)
                self.assertIn("as the sidecar records it", result.stderr)
                found, = json.loads((self.folder / "e.json").read_text())["motions"]
                self.assertEqual(found["source_frames"], run["source_frames"])
                height = options[3:] if "--height" in options else ()
                self.assertEqual("left out --height 1.6: recorded" in result.stderr, bool(height))
                self.assert_done(self.evaluate(output, "--bvh", clip, *height, "--json", "e.json",
                                               "--gate", "none"))
                found, = json.loads((self.folder / "e.json").read_text())["motions"]
                self.assertAlmostEqual(mean_of(found["track_pos_cm"]), mean_of(run["track_pos_cm"]),
                                       delta=0.01)
        self.assert_done(self.retarget("--limits", "gmr", "--sidecar", bvh=clip,
                                       output="limited.csv"))
        result = self.evaluate("limited.csv", "--bvh", clip, "--gate", "none")
        self.assertIn("official; the sidecar of limited.csv records gmr", result.stderr)
        result = self.evaluate("limited.csv", "--bvh", clip, "--gate", "none", "--limits",
                               "gmr")
        self.assertNotIn("records gmr", result.stderr)
        # Given options take precedence; a part of another source is not applied.
        result = self.evaluate("part.csv", "--bvh", clip, "--start", "1", "--gate", "none")
        self.assertNotIn("part ", result.stderr)
        result = self.evaluate("image.csv", "--bvh", clip, "--height", "1.6", "--gate", "none")
        self.assertNotIn("left out", result.stderr)
        result = self.evaluate("part.csv", "image.csv", "--bvh", clip, "--gate", "none")
        self.assertIn("record different parts", result.stderr)
        other = self.write("other.bvh", short_clip("wave", 121))
        result = self.evaluate("part.csv", "--bvh", other, "--gate", "none")
        self.assertIn("records --frames 30:90 of another source", result.stderr)

    def test_arms_alone_as_in_their_own_report(self):
        self.assert_done(self.retarget("--follow", "arms", "--sidecar", "--report", "run.json",
                                       bvh=sample("turn_in_place")))
        self.evaluate("out.csv", "--bvh", sample("turn_in_place"), "--json", "file.json")
        run, file = (json.loads((self.folder / name).read_text())["motions"][0]
                     for name in ("run.json", "file.json"))
        self.assertEqual(file["joint_offset_rad"], run["joint_offset_rad"])
        gates = [gate for gate in run["gates"] if gate["metric"] != "solver_failures"]
        self.assertEqual(file["gates"], gates)

    def test_standard_input_and_other_layouts(self):
        text = self.good.read_text()
        for name, other in (("blank", text.replace(",", " ")), ("tab", text.replace(",", "\t")),
                            ("crlf", text.replace("\n", "\r\n"))):
            with self.subTest(name):
                file = self.write("other.csv", other)
                with open(file, encoding="utf-8") as stdin:
                    piped = self.evaluate("-", "--gate", "none", stdin=stdin)
                self.assert_done(piped)
                plain = self.evaluate(self.good, "--gate", "none")
                rows = [line.split()[2:] for line in piped.stdout.splitlines()[1:]]
                self.assertEqual(rows, [x.split()[2:] for x in plain.stdout.splitlines()[1:]])

    def test_bad_motions(self):
        self.assert_fails(self.evaluate("missing.csv"), 3, "missing.csv")
        self.assert_fails(self.evaluate(self.write("short.csv", "1,2,3\n")), 3,
                          "short.csv:1:1", "needs 36")
        self.assert_fails(self.evaluate(self.write("empty.csv", "")), 3, "no frames")
        bad = self.good.read_text().replace(",", ",x", 1)
        self.assert_fails(self.evaluate(self.write("bad.csv", bad)), 3, "expected a number")

    def test_bad_usage(self):
        self.assert_fails(self.run_tool("evaluate", self.good), 2, "no robot is given")
        self.assert_fails(self.evaluate(), 2, "motions")
        self.assert_fails(self.evaluate(self.good, "--start", "1"), 2, "--start needs the source")
        self.assert_fails(self.evaluate(self.good, "--end", "1"), 2, "--end needs the source")
        self.assert_fails(self.evaluate(self.good, "--fps", "source"), 2, "needs the source")
        self.assert_fails(self.evaluate("-", "-"), 2, "only once")
        self.assert_fails(self.evaluate(self.good, "--json", "no/r.json"), 2, "no")
        self.assert_fails(self.retarget("--report", "-"), 2, "--report needs a file")
        self.assert_fails(self.evaluate(self.good, "--bvh", "a.bvh", "--smpl", "a.npz"), 2,
                          "--bvh and --smpl both name a motion")
        self.assert_fails(self.retarget("--report", "no/r.json"), 2, "no")

    def test_a_motion_that_ends_early_is_reported(self):
        self.assert_done(self.retarget("--method", "gmr", "--start", "1", "--end", "3", bvh=sample("wave"),
                                       output="part.csv"))
        evaluate = ("evaluate", "part.csv", "--robot", "unitree_g1", "--bvh", sample("wave"), "--gate", "none")
        result = self.run_tool(*evaluate)
        self.assertIn("the motion has 61 frames of the 121 of the source", result.stderr)
        self.assertIn("--start and --end select another part", result.stderr)
        result = self.run_tool(*evaluate, "--start", "1", "--end", "3")
        self.assertNotIn("of the source and is compared", result.stderr)

    def test_a_source_that_ends_early_is_reported(self):
        result = self.evaluate(self.good, "--bvh", tool.sample("wave"), "--start", "1", "--gate",
                               "none")
        self.assert_done(result)
        self.assertIn("contacts and tracking are measured only up to its end", result.stderr)


if __name__ == "__main__":
    unittest.main()
