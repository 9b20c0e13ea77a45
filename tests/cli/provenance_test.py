"""Sidecars and retarget verify."""

import json
import shutil
import unittest

from motion_formats import FormatsTest
from tool import SOURCE, sample, short_clip


class Provenance(FormatsTest):
    def setUp(self):
        super().setUp()
        shutil.copy(sample("wave"), self.folder / "in.bvh")

    def verify(self, name="out.csv.json", **options):
        return self.run_tool("verify", name, **options)

    def test_a_folder_called_like_the_robot_is_not_the_robot(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:9", "--sidecar",
                                       bvh="in.bvh", output="out.csv"))
        (self.folder / "unitree_g1").mkdir()
        self.assert_done(self.verify())

    def test_sidecar(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:60", "--sidecar",
                                       "--format", "csv,npz-mjlab", bvh="in.bvh", output="out"))
        self.assertEqual(self.files(), ["in.bvh", "out.csv", "out.csv.json", "out.mjlab.npz",
                                        "out.mjlab.npz.json"])
        sidecar = json.loads((self.folder / "out.csv.json").read_text())
        self.assertEqual(sidecar["output"]["format"], "csv")
        self.assertEqual(sidecar["options"]["method"], "gmr")
        self.assertEqual(sidecar["options"]["frames"], "0:60")
        roles = [each["role"] for each in sidecar["inputs"]]
        self.assertEqual(roles, ["motion", "model", "profile", "mapping", "skeletons"])
        self.assertTrue(all(each["hash"].startswith("sha256:") for each in sidecar["inputs"]))
        self.assertEqual(sidecar["found"]["unit"], "cm")
        self.assertIn("metrics", json.dumps(sidecar["quality"]))
        self.assert_done(self.verify())
        self.assert_done(self.verify("out.mjlab.npz.json"))
        # No file was written.
        self.assertEqual(len(self.files()), 5)

    def test_the_motion_beside_the_sidecar_is_compared(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:40", "--sidecar", bvh="in.bvh"))
        for ending in ("", ".json"):
            (self.folder / f"out.csv{ending}").rename(self.folder / f"new.csv{ending}")
        done = self.verify("new.csv.json")
        self.assert_done(done)
        self.assertIn("new.csv: the output", done.stderr)
        with open(self.folder / "new.csv", "a") as file:
            file.write("\n")
        self.assert_fails(self.verify("new.csv.json"), 1, "new.csv", "has changed")
        (self.folder / "new.csv").unlink()
        self.assert_fails(self.verify("new.csv.json"), 1, "the motion of the sidecar is missing")

    def test_changed_inputs_are_named(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:40", "--sidecar",
                                       bvh="in.bvh"))
        bvh = (self.folder / "in.bvh").read_text()
        # As after a move to another folder.
        moved = self.folder / "moved"
        moved.mkdir()
        for name in ("in.bvh", "out.csv", "out.csv.json"):
            shutil.copy(self.folder / name, moved / name)
        (self.folder / "in.bvh").unlink()
        self.assert_done(self.verify(moved / "out.csv.json"))
        lines = bvh.splitlines(keepends=True)
        row = lines[-390].split() if len(lines) > 400 else lines[-1].split()
        first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time")) + 6
        row = lines[first].split()
        row[1] = str(float(row[1]) + 1.0)
        lines[first] = " ".join(row) + "\n"
        self.write("in.bvh", "".join(lines))
        result = self.verify()
        self.assert_fails(result, 1, "the output differs", "the motion in.bvh has changed")
        self.write("in.bvh", bvh)
        self.assert_done(self.verify())
        csv = (self.folder / "out.csv").read_text()
        self.write("out.csv", csv + csv.splitlines()[-1] + "\n")
        self.assert_fails(self.verify(), 1, "changed since the sidecar was written")
        self.assert_fails(self.verify("in.bvh"), 3, "not a run's sidecar")

    def test_the_missing_format_is_that_of_the_sidecar(self):
        self.write("in.bvh", short_clip("wave", 20))
        self.assert_done(self.retarget("--method", "gmr", "--sidecar", "--format",
                                       "csv,npz-mjlab,protomotions", bvh="in.bvh", output="out"))
        self.write("in.bvh", short_clip("wave", 1))
        for name in ("out.motion", "out.mjlab.npz"):
            failed = self.verify(f"{name}.json")
            self.assert_fails(failed, 3, f"{name}: error: a tracking file needs three frames")
            self.assertIn("the motion in.bvh has changed", failed.stderr)

    def test_altered_facts_and_metrics_are_found(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:60", "--sidecar",
                                       bvh="in.bvh"))
        text = (self.folder / "out.csv.json").read_text()
        self.assert_done(self.verify())
        report = json.loads(text)["quality"]["motions"][0]

        def altered(change):
            sidecar = json.loads(text)
            change(sidecar["found"], sidecar["quality"]["motions"][0])
            self.write("out.csv.json", json.dumps(sidecar))
            return self.verify()

        self.assert_fails(altered(lambda found, motion: found.update(fps=60.0)), 1, "found.fps")
        self.assert_fails(altered(lambda found, motion: found.update(skeleton="other")), 1,
                          "found.skeleton")
        jumps = report["jumps"] + 77
        self.assert_fails(altered(lambda found, motion: motion.update(jumps=jumps)), 1,
                          "quality.jumps")
        self.assert_fails(altered(lambda found, motion: motion.update(passed=not motion["passed"])),
                          1, "quality.gates")
        self.assert_fails(altered(lambda found, motion: motion["gates"][0].update(
            passed=not motion["gates"][0]["passed"])), 1, "quality.gates")
        self.assert_done(altered(lambda found, motion: None))

    def test_gates_and_dynamics_of_the_run(self):
        missed = self.retarget("--frames", "0:60", "--sidecar", "--dynamics", "--gate",
                               "peak_speed<=0.5", bvh="in.bvh")
        self.assertEqual(missed.returncode, 1, missed.stderr)
        report = json.loads((self.folder / "out.csv.json").read_text())["quality"]["motions"][0]
        self.assertIn("dynamics_bad_pct", report)
        self.assertFalse(report["passed"])
        self.assert_done(self.verify())

    def test_files_behind_a_scene_are_recorded(self):
        self.write("step.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0.1\n"
                               "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
        self.write("scene.json", json.dumps(
            {"bodies": [{"name": "step", "shapes": [{"type": "mesh", "file": "step.obj"}]}]}))
        self.write("track.csv", "".join("5,5,0,0,0,0,1\n" for _ in range(121)))
        self.assert_done(self.retarget("--frames", "0:40", "--sidecar", "--scene", "scene.json",
                                       "--object-track", "step=track.csv", bvh="in.bvh"))
        self.assert_done(self.verify())
        roles = [each["role"] for each in json.loads(
            (self.folder / "out.csv.json").read_text())["inputs"]]
        self.assertIn("scene geometry", roles)
        self.assertIn("object-track 1", roles)
        text = (self.folder / "step.obj").read_text()
        self.write("step.obj", text.replace("0.1", "0.2"))
        changed = self.verify()
        self.assertIn("the scene geometry scene.json has changed", changed.stderr)

    def test_files_that_moved_change_no_report(self):
        limits = {"left_elbow_joint": [-0.5, 1.5]}
        self.write("lim.json", json.dumps(limits))
        shutil.copy(SOURCE / "configs/lafan1_to_unitree_g1.json", self.folder / "cfg.json")
        self.assert_done(self.retarget("--frames", "0:40", "--sidecar", "--limits", "lim.json",
                                       "--ik-config", "cfg.json", bvh="in.bvh"))
        moved = self.folder / "moved"
        moved.mkdir()
        for name in ("in.bvh", "out.csv", "out.csv.json", "lim.json", "cfg.json"):
            shutil.move(self.folder / name, moved / name)
        self.assert_done(self.verify(moved / "out.csv.json"))

    def test_a_sidecar_of_another_build_is_compared_by_bytes(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:40", "--sidecar",
                                       bvh="in.bvh"))
        sidecar = json.loads((self.folder / "out.csv.json").read_text())
        # The order of members does not matter, and damaged members do not crash the command.
        self.write("out.csv.json", json.dumps(sidecar, sort_keys=True))
        done = self.verify()
        self.assert_done(done)
        self.assertIn("the output and its report are identical", done.stderr)
        self.write("out.csv.json", json.dumps(sidecar | {"found": None}))
        self.assert_fails(self.verify(), 1, "found.fps")
        self.write("out.csv.json", json.dumps(sidecar | {"build": ["another"], "found": []}))
        done = self.verify()
        self.assert_done(done)
        self.assertIn("its report was not compared", done.stderr)

    def test_an_output_with_only_its_sidecar(self):
        self.assert_done(self.retarget("--method", "gmr", "--frames", "0:2", "--sidecar",
                                       bvh="in.bvh"))
        sidecar = json.loads((self.folder / "out.csv.json").read_text())
        for name in ("../out.csv", str(self.folder / "out.csv"), "a/out.csv", ".."):
            sidecar["output"]["file"] = name
            self.write("odd.json", json.dumps(sidecar))
            self.assert_fails(self.verify("odd.json"), 3, "not the name of a file in the same folder")

    def test_a_sidecar_of_many_members_is_refused_at_once(self):
        sidecar = {"output": {"file": "a.csv"}, "options": {}, "inputs": []}
        sidecar.update({f"key{i}": 1 for i in range(200_000)})
        self.write("many.json", json.dumps(sidecar))
        self.assert_fails(self.run_measured("verify", "many.json", seconds=5), 3, "an object of more than 2000 members")

    def test_standard_output_has_no_sidecar(self):
        self.assert_fails(self.retarget("--sidecar", output="-"), 2,
                          "--sidecar needs an output file")


if __name__ == "__main__":
    unittest.main()
