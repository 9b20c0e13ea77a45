"""Replays in physics and certificates, through the command line."""

import json
import pathlib
import subprocess
import tempfile
import unittest

from tool import SOURCE, TOOL


def call(*arguments):
    return subprocess.run([TOOL, *map(str, arguments)], capture_output=True, text=True, check=False)


class Simulate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        for clip in ("walk", "squat"):
            done = call(SOURCE / f"data/{clip}.bvh", "g1", "-o", cls.folder / f"{clip}.csv", "--with", "dynamics",
                        "--sidecar")
            assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def simulate(self, motion, *options):
        done = call("simulate", motion, "--robot", "g1", "--json", *options)
        return done.returncode, json.loads(done.stdout)

    def moved(self, name, change):
        """A copy of the squat with changed rows."""
        rows = [[float(x) for x in line.split(",")] for line in (self.folder / "squat.csv").read_text().splitlines()]
        for i, row in enumerate(rows):
            change(i, row)
        file = self.folder / name
        file.write_text("".join(",".join(f"{x:.6f}" for x in row) + "\n" for row in rows))
        return file

    def test_walk_and_squat_do_not_fall(self):
        for clip in ("walk", "squat"):
            code, report = self.simulate(self.folder / f"{clip}.csv")
            self.assertEqual(code, 0, report)
            self.assertFalse(report["fell"])
            self.assertLess(report["joint_error_deg"]["mean"], 1.0)
            self.assertLess(report["root_error_cm"]["p95"], 5.0)
            self.assertLessEqual(report["torque_p99_ratio"], 1.0)

    def test_a_jumping_root_is_lost(self):
        def jump(i, row):
            if i >= 60:
                row[1] += 0.5
        code, report = self.simulate(self.moved("jump.csv", jump))
        self.assertEqual(code, 1)
        self.assertTrue(report["fell"])
        self.assertGreater(report["fall_time_s"], 1.5)

    def test_outputs(self):
        out, report = self.folder / "simulated.csv", self.folder / "report.json"
        done = call("simulate", self.folder / "squat.csv", "--robot", "g1", "-o", out, "--report", report)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("fall", done.stdout)
        lines = out.read_text().splitlines()
        self.assertEqual(len(lines), json.loads(report.read_text())["frames"])
        again = self.folder / "again.csv"
        call("simulate", self.folder / "squat.csv", "--robot", "g1", "-o", again)
        self.assertEqual(out.read_bytes(), again.read_bytes())

    def test_wrong_usage(self):
        self.assertEqual(call("simulate", self.folder / "squat.csv").returncode, 2)
        self.assertEqual(call("simulate", self.folder / "none.csv", "--robot", "g1").returncode, 3)
        squat = self.folder / "squat.csv"
        self.assertEqual(call("simulate", squat, "--robot", "g1", "-o", squat).returncode, 2)

    def test_certificate(self):
        motion = self.folder / "squat.csv"
        file = self.folder / "squat.csv.certificate.json"
        done = call("certify", motion, "--robot", "g1", "--bvh", SOURCE / "data/squat.bvh")
        self.assertTrue(file.exists(), done.stderr)
        certificate = json.loads(file.read_text())
        self.assertEqual(certificate["schema"], "retarget-certificate-1")
        schema = json.loads((SOURCE / "docs/certificate.schema.json").read_text())
        self.assertEqual(sorted(certificate), sorted(schema["required"]))
        for part in ("motion", "request", "prediction", "verdict"):
            self.assertEqual(sorted(certificate[part]), sorted(schema["properties"][part]["required"]), part)
        self.assertEqual(done.returncode, 0 if certificate["verdict"]["passed"] else 1)
        self.assertFalse(certificate["simulation"]["fell"])
        self.assertIn("options", certificate["sidecar"])
        self.assertTrue(0.0 < certificate["prediction"]["predicted_tracking_success"] < 1.0)
        roles = [each["role"] for each in certificate["inputs"]]
        for role in ("source", "model", "profile", "predictor"):
            self.assertIn(role, roles)
        verified = call("verify", file)
        self.assertEqual(verified.returncode, 0, verified.stderr)

        self.assertIn("\nsimulation no fall\n", done.stderr)
        self.assertRegex(done.stderr, r"\nverdict  \d+ of \d+ gates passed")
        sidecar = self.folder / "squat.csv.json"
        kept = sidecar.read_bytes()
        sidecar.unlink()
        try:
            missing = call("verify", file)
            self.assertEqual(missing.returncode, 1)
            self.assertRegex(missing.stderr, "hint: the sidecar .*squat.csv.json, .* is missing")
            sidecar.write_bytes(kept.replace(b"{", b"{ ", 1))
            self.assertRegex(call("verify", file).stderr, "hint: the sidecar .*squat.csv.json has changed")
        finally:
            sidecar.write_bytes(kept)
        alone = call("certify", motion, "--robot", "g1", "-o", self.folder / "alone.json")
        self.assertRegex(alone.stderr, r"verdict  \d+ of \d+ gates passed, \d+ not measured")

        # Every change is found and named.
        for path, value in ((("simulation", "fell"), True), (("quality", "dynamics_bad_pct"), 0.123),
                            (("prediction", "predicted_tracking_success"), 0.99),
                            (("verdict", "passed"), not certificate["verdict"]["passed"])):
            forged = json.loads(json.dumps(certificate))
            forged[path[0]][path[1]] = value
            other = self.folder / "forged.json"
            other.write_text(json.dumps(forged, indent=2))
            found = call("verify", other)
            self.assertEqual(found.returncode, 1, path)
            self.assertIn("/".join(path), found.stderr)
        forged = json.loads(json.dumps(certificate))
        model = next(i for i, each in enumerate(forged["inputs"]) if each["role"] == "model")
        forged["inputs"][model]["file"] += "x"
        other.write_text(json.dumps(forged))
        found = call("verify", other)
        self.assertEqual(found.returncode, 1)
        self.assertIn(f"/inputs/{model}/file", found.stderr)
        other.write_text(json.dumps({**certificate, "schema": "retarget-certificate-2"}))
        found = call("verify", other)
        self.assertEqual(found.returncode, 3)
        self.assertIn('"schema" of the certificate', found.stderr)

        kept = motion.read_bytes()
        motion.write_bytes(kept.replace(b"0.1", b"0.2", 1))
        try:
            changed = call("verify", file)
            self.assertEqual(changed.returncode, 1)
            self.assertIn("the motion has changed", changed.stderr)
        finally:
            motion.write_bytes(kept)


if __name__ == "__main__":
    unittest.main()
