"""The Windows tool under Wine makes the same files as the native one, and takes names that only Windows has.

    wine_checks.py NATIVE_TOOL WINE_TOOL

WINE_TOOL is a program that starts retarget.exe with its arguments (tools/windows.sh makes it). Not one of ctest's
tests: tools/windows.sh --test calls it."""

import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
NATIVE, WINE = sys.argv[1], sys.argv[2]

CLIPS = ["walk", "squat", "wave", "turn_in_place", "get_up"]
NAME = "Größe 机 & co"


def run(tool, *arguments, code=0, folder=None, given=None):
    done = subprocess.run([tool, *map(str, arguments)], capture_output=True, cwd=folder, input=given, timeout=600)
    if done.returncode != code:
        raise AssertionError(f"{arguments}: {done.returncode}\n{done.stderr.decode(errors='replace')}")
    return done


def clip(name):
    return ROOT / "data" / f"{name}.bvh"


class SameBytes(unittest.TestCase):
    def compare(self, *arguments, ending="csv"):
        with tempfile.TemporaryDirectory() as folder:
            results = []
            for which, tool in (("native", NATIVE), ("wine", WINE)):
                output = pathlib.Path(folder) / which / f"motion.{ending}"
                output.parent.mkdir()
                run(tool, *arguments, "-o", output)
                results.append({each.name: each.read_bytes() for each in output.parent.iterdir()})
            native, wine = results
            self.assertEqual(sorted(native), sorted(wine))
            for name, content in native.items():
                self.assertTrue(content == wine[name], f"{arguments}: {name} differs")

    def test_fit_of_every_sample(self):
        for name in CLIPS:
            self.compare(clip(name), "g1")

    def test_published_method(self):
        for name in ("walk", "squat"):
            self.compare(clip(name), "g1", "--method", "gmr")

    def test_other_robots(self):
        for robot in ("t1", "h1_2", "g1_with_hands", "pal_talos"):
            self.compare(clip("walk"), robot)

    def test_another_rate_and_part(self):
        self.compare(clip("walk"), "g1", "--fps", "50", "--start", "0.5", "--end", "2")

    def test_other_formats(self):
        # MuJoCo's DLL gives some constants of a model in another last digit, which single precision may show.
        with tempfile.TemporaryDirectory() as folder:
            for ending, form in (("npz", "npz-mjlab"), ("pkl", "pkl-gmr")):
                files = [f"{folder}/{which}.{ending}" for which in ("native", "wine")]
                for tool, file in zip((NATIVE, WINE), files):
                    run(tool, clip("squat"), "g1", "-o", file, "--format", form)
                for tool in (NATIVE, WINE):
                    run(tool, "compare", *files, "--robot", "g1", "--tolerance", "1e-6")

    def test_pages_and_edits(self):
        with tempfile.TemporaryDirectory() as folder:
            for which, tool in (("n", NATIVE), ("w", WINE)):
                run(tool, "edit", "mirror", clip("walk"), "-o", f"{folder}/{which}.bvh")
                run(tool, clip("walk"), "g1", "-o", f"{folder}/{which}.csv")
            self.assertEqual(pathlib.Path(f"{folder}/n.bvh").read_bytes(), pathlib.Path(f"{folder}/w.bvh").read_bytes())
            report = [run(tool, "evaluate", f"{folder}/n.csv", "--robot", "g1", "--bvh", clip("walk"), "--json", "-").stdout
                      for tool in (NATIVE, WINE)]
            self.assertEqual(report[0], report[1])
            run(WINE, "compare", f"{folder}/n.csv", f"{folder}/w.csv", "--tolerance", "0")

    def test_help(self):
        for words in (["--help"], ["batch", "--help"], ["live", "--help"]):
            self.assertEqual(run(NATIVE, *words).stdout, run(WINE, *words).stdout)

    def test_batch(self):
        with tempfile.TemporaryDirectory() as folder:
            for which, tool in (("n", NATIVE), ("w", WINE)):
                run(tool, "batch", ROOT / "data", "-o", f"{folder}/{which}", "--robot", "g1,t1", "--jobs", "2")
            native, wine = pathlib.Path(folder, "n"), pathlib.Path(folder, "w")
            names = sorted(str(each.relative_to(native)) for each in native.rglob("*.csv"))
            self.assertEqual(names, sorted(str(each.relative_to(wine)) for each in wine.rglob("*.csv")))
            self.assertEqual(len([each for each in names if each != "summary.csv"]), 2 * len(CLIPS))
            for name in names:
                if name != "summary.csv":
                    self.assertEqual((native / name).read_bytes(), (wine / name).read_bytes(), name)
            self.assertFalse([each for each in wine.rglob("*") if each.name.startswith(".retarget-")])
            again = run(WINE, "batch", ROOT / "data", "-o", wine, "--robot", "g1,t1", "--resume").stderr.decode()
            self.assertRegex(again, r"10 .*(up to date|unchanged|skipped|already)")


class Names(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name) / NAME
        self.folder.mkdir()
        self.addCleanup(self.temporary.cleanup)
        self.text = clip("squat").read_bytes()
        self.expected = run(NATIVE, clip("squat"), "g1", "-o", "-", "--format", "csv").stdout

    def windows_path(self, path):
        return "Z:" + str(path).replace("/", "\\")

    def test_unicode_spaces_and_drive_letters(self):
        (self.folder / f"{NAME}.bvh").write_bytes(self.text)
        for spelled in (str, self.windows_path):
            output = self.folder / f"{spelled.__name__} 歩く.csv"
            run(WINE, spelled(self.folder / f"{NAME}.bvh"), "g1", "-o", spelled(output))
            self.assertEqual(output.read_bytes(), self.expected)

    def test_relative_names(self):
        (self.folder / "a b.bvh").write_bytes(self.text)
        run(WINE, "a b.bvh", "g1", "-o", "ü.csv", folder=self.folder)
        self.assertEqual((self.folder / "ü.csv").read_bytes(), self.expected)

    def test_carriage_returns(self):
        (self.folder / "crlf.bvh").write_bytes(self.text.replace(b"\r\n", b"\n").replace(b"\n", b"\r\n"))
        run(WINE, "crlf.bvh", "g1", "-o", "crlf.csv", folder=self.folder)
        self.assertEqual((self.folder / "crlf.csv").read_bytes(), self.expected)

    def test_pipes(self):
        done = run(WINE, "-", "g1", "-o", "-", "--format", "csv", given=self.text)
        self.assertEqual(done.stdout, self.expected)
        self.assertNotIn(b"\r", done.stderr)

    def test_a_robot_in_such_a_folder(self):
        robot = self.folder / "robot"
        robot.mkdir()
        for file in (ROOT / "robots" / "unitree_g1").iterdir():
            if file.is_file():
                (robot / file.name).write_bytes(file.read_bytes())
        (self.folder / "c.bvh").write_bytes(self.text)
        run(WINE, "c.bvh", "-o", "c.csv", "--robot", self.windows_path(robot), "--method", "gmr", folder=self.folder)
        self.assertTrue((self.folder / "c.csv").stat().st_size > 1000)

    def test_batch_of_patterns(self):
        for sub in ("eins", "zwei ö"):
            (self.folder / sub).mkdir()
            (self.folder / sub / "clip 1.bvh").write_bytes(self.text)
        run(WINE, "batch", self.windows_path(self.folder) + "\\*\\cl*.bvh", "-o", "out", "--robot", "g1",
            folder=self.folder)
        for sub in ("eins", "zwei ö"):
            self.assertEqual((self.folder / "out" / sub / "clip 1.csv").read_bytes(), self.expected)
        manifest = (self.folder / "out" / "manifest.jsonl").read_text(encoding="utf-8")
        self.assertIn('"zwei ö/clip 1.bvh"', manifest)

    def test_sidecar_and_verify(self):
        (self.folder / "c.bvh").write_bytes(self.text)
        run(WINE, "c.bvh", "g1", "-o", "c.csv", "--sidecar", folder=self.folder)
        run(WINE, "verify", "c.csv.json", folder=self.folder)
        run(NATIVE, "verify", "c.csv.json", folder=self.folder)

    def test_errors(self):
        done = run(WINE, "nowhere ö.bvh", "g1", "-o", "x.csv", code=3, folder=self.folder)
        self.assertIn("nowhere ö.bvh", done.stderr.decode())
        self.assertIn("No such file", done.stderr.decode())
        run(WINE, "--nonsense", code=2)
        self.assertFalse((self.folder / "x.csv").exists())


class Live(unittest.TestCase):
    def free_port(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            return probe.getsockname()[1]

    def test_a_stream_by_pipes(self):
        played = [run(tool, "live", "--play", clip("walk"), "--to", "stdout", "--speed", "0").stdout
                  for tool in (NATIVE, WINE)]
        self.assertEqual(played[0], played[1])
        with tempfile.TemporaryDirectory() as folder:
            frames = []
            for which, tool in (("native", NATIVE), ("wine", WINE)):
                output = pathlib.Path(folder) / f"{which}.csv"
                run(tool, "live", "--robot", "g1", "-o", output, given=played[0])
                frames.append(output.read_bytes())
        self.assertGreater(len(frames[0].splitlines()), 100)
        self.assertEqual(frames[0], frames[1])

    def test_a_stream_by_datagrams_until_ctrl_c(self):
        port = self.free_port()
        with tempfile.TemporaryDirectory() as folder:
            output = pathlib.Path(folder) / "live.csv"
            live = subprocess.Popen([WINE, "live", "--robot", "g1", "--input", f"udp:{port}?format=bvh", "--skeleton",
                                     str(clip("walk")), "-o", str(output)], stderr=subprocess.PIPE)
            try:
                time.sleep(4)
                run(WINE, "live", "--play", clip("walk"), "--to", f"udp:{port}?format=bvh")
                live.send_signal(signal.SIGINT)
                _, messages = live.communicate(timeout=30)
            finally:
                live.kill()
            self.assertEqual(live.returncode, 0, messages.decode())
            self.assertGreater(len(output.read_bytes().splitlines()), 50, messages.decode())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
