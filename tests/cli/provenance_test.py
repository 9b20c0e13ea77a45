"""Sidecars and retarget verify."""

import json
import shutil
import unittest

from motion_formats import FormatsTest
from tool import sample


class Provenance(FormatsTest):
    def setUp(self):
        super().setUp()
        shutil.copy(sample("wave"), self.folder / "in.bvh")

    def verify(self, name="out.csv.json", **options):
        return self.run_tool("verify", name, **options)

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
        self.assert_fails(self.verify("many.json"), 3, "an object of more than 2000 members")

    def test_standard_output_has_no_sidecar(self):
        self.assert_fails(self.retarget("--sidecar", output="-"), 2,
                          "--sidecar needs an output file")


if __name__ == "__main__":
    unittest.main()
