"""retarget batch --certify: certificates of clips, and the selection by their figures."""

import json
import unittest

from batch_runs import BatchTest
from tool import SOURCE


class Certify(BatchTest):
    def setUp(self):
        super().setUp()
        (self.folder / "in").mkdir()
        for clip in ("squat", "get_up"):
            (self.folder / f"in/{clip}.bvh").write_bytes((SOURCE / f"data/{clip}.bvh").read_bytes())

    def test_certificates_select(self):
        self.clips("short.bvh")  # Two frames cannot be simulated.
        # The squat misses no gate. Getting up is a motion that the controller cannot track.
        gates = ("--gate", "none", "--gate", "tracked_pct>=100")
        self.assert_done(self.batch("--certify", *gates, fast=False))
        self.assertEqual(self.outputs(end=".certificate.json"),
                         ["get_up.csv.certificate.json", "squat.csv.certificate.json"])
        entries = {entry["relative"]: entry for entry in self.manifest()}
        for clip, fell in (("squat", False), ("get_up", True)):
            certificate = json.loads((self.folder / f"out/{clip}.csv.certificate.json").read_text())
            self.assertEqual(certificate["simulation"]["fell"], fell, clip)
            figures = entries[f"{clip}.bvh"]["quality"]["figures"]
            self.assertEqual(figures["predicted_tracking_success"],
                             certificate["prediction"]["predicted_tracking_success"])
            self.assertEqual(figures["tracked_pct"] < 100, fell)
            self.assertIn("dynamics_bad_pct", figures)
            self.assertIn("options", certificate["sidecar"])
            self.assertIn(f"{clip}.csv.certificate.json",
                          [output["file"] for output in entries[f"{clip}.bvh"]["outputs"]])
            # The source has been measured as well.
            self.assertIsNotNone(certificate["quality"]["limb_angle_deg"])
            self.assert_done(self.run_tool("verify", f"out/{clip}.csv.certificate.json"))
        self.assertIn("no certificate", entries["short.bvh"]["warnings"][0])
        self.assertEqual(self.lines("passed.txt"), ["squat.csv"])
        reasons = "\n".join(self.lines("failed.tsv"))
        self.assertRegex(reasons, r"get_up.bvh\ttracked_pct .* \(at least 100\)")
        self.assertIn("short.bvh\ttracked_pct unknown", reasons)
        rows = {row["clip"]: row for row in self.summary()}
        self.assertEqual(rows["squat.bvh"]["tracked_pct"], "100")

        # Nothing is done again, and a certificate that was changed is made again.
        self.assertIn("3 of 3 are done", self.batch("--certify", *gates, "--resume", fast=False).stderr)
        certificate = self.folder / "out/squat.csv.certificate.json"
        kept = certificate.read_bytes()
        certificate.write_bytes(kept.replace(b'"fell": false', b'"fell": true'))
        self.assertIn("2 of 3 are done", self.batch("--certify", *gates, "--resume", fast=False).stderr)
        self.assertEqual(certificate.read_bytes(), kept)

        # Other bounds select without a simulation.
        self.assert_done(self.batch("--merge", "--gate", "none", "--gate", "tracked_pct>=1", inputs=(),
                                    robot=None, fast=False))
        self.assertEqual(self.lines("passed.txt"), ["get_up.csv", "squat.csv"])
        self.assert_done(self.batch("--merge", "--gate", "none", "--gate",
                                    "predicted_tracking_success>=1.5", inputs=(), robot=None, fast=False))
        self.assertEqual(self.lines("passed.txt"), [])

    def test_batches_with_and_without_certificates_differ(self):
        (self.folder / "in/get_up.bvh").unlink()
        self.assert_done(self.batch("--sidecar", "--dynamics", fast=False))
        self.assertEqual(self.outputs(end=".certificate.json"), [])
        self.assert_done(self.batch("--certify", "--resume", fast=False))
        self.assertEqual(self.outputs(end=".certificate.json"), ["squat.csv.certificate.json"])

    def test_certificates_of_parts_and_mirror_images_can_be_verified(self):
        (self.folder / "in/get_up.bvh").unlink()
        self.assert_done(self.batch("--certify", "--mirror", "--start", 0.5, "--end", 2, "--format",
                                    "npz-mjlab,glb", fast=False))
        names = self.outputs(end=".certificate.json")
        self.assertEqual(names, ["squat.mjlab.npz.certificate.json",
                                 "squat_mirrored.mjlab.npz.certificate.json"])
        for name in names:
            self.assert_done(self.run_tool("verify", f"out/{name}"))
        # Without the mirror image, the source is another one.
        file = self.folder / "out" / names[1]
        certificate = json.loads(file.read_text())
        self.assertEqual(certificate["request"]["options"]["start"], "0.5")
        for change, words in ((lambda c: c["request"].update(mirror=False), "the certificate differs at"),
                              (lambda c: c["request"]["options"].update(start="soon"), '"start"'),
                              (lambda c: c["request"]["options"].update(start=1), "unknown option"),
                              (lambda c: c.update(inputs={"0": 1}), "the certificate differs at /inputs")):
            forged = json.loads(json.dumps(certificate))
            change(forged)
            file.write_text(json.dumps(forged))
            done = self.run_tool("verify", f"out/{names[1]}")
            self.assertIn(done.returncode, (1, 3), done.stderr)
            self.assertIn(words, done.stderr)

    def test_wrong_usage(self):
        for options, words in (
                (("--certify", "--no-quality"), "--certify and --no-quality"),
                (("--certify", "--format", "glb"), "a format that can be read"),
                (("--gate", "tracked_pct>=100"), "the gate on tracked_pct needs certificates"),
                (("--certify", "--merge"), "--certify and --merge")):
            merges = "--merge" in options
            if merges:
                (self.folder / "out").mkdir(exist_ok=True)
            done = self.batch(*options, inputs=() if merges else ("in",),
                              robot=None if merges else "unitree_g1", fast=False)
            self.assertEqual(done.returncode, 2, options)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
