"""`retarget view FOLDER`: pages of a batch and one that lists them, by hand and in a browser."""

import base64
import contextlib
import hashlib
import json
import os
import pathlib
import re
import signal
import struct
import subprocess
import time
import unittest
import zlib

from browser import Browser, chromium
from tool import SOURCE, TOOL, ToolTest, absent, is_sanitized, read_rows, short_clip

ODD = "a b <img src=x onerror=alert(1)> \"'&\u00e9\u202e.bvh"


def data_of(path, name):
    """The JSON that a page carries."""
    text = re.search(rf'id="{name}">(.*?)</script>', path.read_text(), re.S)[1]
    return json.loads(text if text.startswith("{") else zlib.decompress(base64.b64decode(text)))


class GalleryTest(ToolTest):
    """Support for both kinds of tests."""

    def batch(self, *options, clips=("walk", "squat")):
        for name in clips:
            self.write(f"clips/{name}.bvh", short_clip(name, 40))
        self.run_tool("batch", "clips", "-o", "out", "--robot", "unitree_g1", "--method", "gmr",
                      *options)

    def gallery(self, *options, folder="out"):
        return self.run_tool("view", folder, "-o", "gallery", *options)

    def index(self):
        return data_of(self.folder / "gallery/index.html", "gallery")

    def entries(self):
        lines = (self.folder / "out/manifest.jsonl").read_text().splitlines()
        return [json.loads(line) for line in lines]

    def write_entries(self, entries, name="manifest.jsonl"):
        self.write(f"out/{name}", "".join(json.dumps(entry) + "\n" for entry in entries))


class Gallery(GalleryTest):
    def test_every_clip_has_its_page_and_the_worst_come_first(self):
        self.write("clips/broken.bvh", b"HIERARCHY\n")
        self.batch()
        self.assert_done(self.gallery())
        clips = self.index()["clips"]
        rows = (self.folder / "out/summary.csv").read_text().splitlines()[1:]
        summary = [row.split(",")[1] for row in rows]
        self.assertEqual([clip["name"] for clip in clips], summary)
        self.assertTrue(clips[0]["failed"])
        self.assertIn("broken.bvh", clips[0]["message"])
        self.assertNotIn("page", clips[0])
        entries = {entry["relative"]: entry for entry in self.entries()}
        metrics = [metric["key"] for metric in self.index()["metrics"]]
        pages = []
        for clip in clips[1:]:
            entry = entries[clip["name"]]
            self.assertEqual(clip["missed"], entry["quality"]["gates_missed"])
            figures = dict(zip(metrics, clip["figures"]))
            for key, value in entry["quality"]["figures"].items():
                near = max(1e-4, abs(value) * 6e-3)
                self.assertAlmostEqual(figures[key], value, delta=near, msg=key)
            page = self.folder / "gallery" / clip["page"]
            header = data_of(page, "page-header")
            self.assertEqual(header["motions"][0]["frames"], entry["frames"])
            self.assertIn("human", header["motions"][0])
            picture = (self.folder / "gallery" / clip["picture"]).read_bytes()
            width, height = struct.unpack_from(">II", picture, 16)
            self.assertLessEqual((width, height), (321, 120))
            pages.append((page.name, header["links"]))
        index = "../index.html"
        self.assertEqual(pages[0][1], {"index": index, "previous": "", "next": pages[1][0]})
        self.assertEqual(pages[1][1], {"index": index, "previous": pages[0][0], "next": ""})
        # A second run: the same bytes and no other files.
        before = {f: (self.folder / f).read_bytes() for f in self.files() if f.startswith("gal")}
        self.assert_done(self.gallery())
        after = {f: (self.folder / f).read_bytes() for f in self.files() if f.startswith("gal")}
        self.assertEqual(before, after)

    def test_the_options_of_the_batch_say_what_was_made_of_the_source(self):
        self.batch("--start", 0.5, "--csv-degrees", clips=("walk",))
        self.assert_done(self.gallery())
        header = data_of(self.folder / "gallery" / self.index()["clips"][0]["page"], "page-header")
        report = header["motions"][0]["report"]
        angle = next(figure["value"] for figure in report["figures"]
                     if figure["key"] == "limb_angle_deg")
        entry = self.entries()[0]["quality"]["figures"]["limb_angle_deg"]
        self.assertAlmostEqual(angle, entry, delta=0.3)

    def test_a_fixed_base_is_measured_as_in_the_batch(self):
        self.batch("--base", "fixed", clips=("walk",))
        self.assert_done(self.gallery())
        header = data_of(self.folder / "gallery" / self.index()["clips"][0]["page"], "page-header")
        shown = {figure["key"] for figure in header["motions"][0]["report"]["figures"]}
        recorded = set(self.entries()[0]["quality"]["figures"])
        self.assertNotIn("stance_slip_mean", recorded)
        self.assertEqual(shown & {"stance_slip_mean", "body_pen_cm_p99"}, set())

    def test_missing_motions_are_reported_and_the_rest_is_shown(self):
        self.batch()
        (self.folder / "out/walk.csv").unlink()
        (self.folder / "clips/squat.bvh").unlink()
        with open(self.folder / "out/manifest.jsonl", "a") as manifest:
            manifest.write('{"relative": "torn')
        result = self.gallery()
        self.assert_done(result)
        self.assertIn("a motion of the manifest is missing: walk.csv", result.stderr)
        self.assertIn("1 line of the manifest cannot be read", result.stderr)
        self.assertIn("1 clip is shown without the source, which no longer exists", result.stderr)
        walk = next(clip for clip in self.index()["clips"] if clip["name"] == "walk.bvh")
        self.assertEqual(walk["message"], "the motion is missing: walk.csv")
        squat = next(clip for clip in self.index()["clips"] if clip["name"] == "squat.bvh")
        header = data_of(self.folder / "gallery" / squat["page"], "page-header")
        self.assertNotIn("human", header["motions"][0])
        # A changed source does not block the page.
        self.write("clips/squat.bvh", b"HIERARCHY\n")
        self.assert_done(self.gallery())
        squat = next(clip for clip in self.index()["clips"] if clip["name"] == "squat.bvh")
        self.assertIn("without its source", squat["message"])
        self.assertIn("page", squat)

    def test_parts_of_a_batch_that_has_not_been_merged(self):
        self.batch("--shard", "1/2")
        self.batch("--shard", "2/2")
        self.assertFalse((self.folder / "out/manifest.jsonl").exists())
        self.assert_done(self.gallery())
        self.assertEqual(len(self.index()["clips"]), 2)

    def test_unreadable_motion_has_a_page_with_the_reason(self):
        self.batch()
        self.write("out/walk.csv", "1,2,<b>3\n")
        result = self.gallery()
        self.assert_done(result)
        self.assertIn("1 motion cannot be shown", result.stderr)
        walk = next(clip for clip in self.index()["clips"] if clip["name"] == "walk.bvh")
        self.assertIn("walk.csv", walk["message"])
        page = (self.folder / "gallery" / walk["page"]).read_text()
        self.assertIn("walk.csv", page)
        self.assertIn("../index.html", page)
        self.assertNotIn("<b>3", page)

    def header(self, clip):
        return data_of(self.folder / "gallery" / clip["page"], "page-header")

    def test_a_source_that_has_changed_is_not_shown(self):
        self.batch(clips=("walk", "squat"))
        # Another readable clip: only its content differs.
        self.write("clips/walk.bvh", short_clip("squat", 40))
        self.assert_done(self.gallery())
        clips = {clip["name"]: clip for clip in self.index()["clips"]}
        self.assertIn("the source has changed since", clips["walk.bvh"]["message"])
        header = self.header(clips["walk.bvh"])
        self.assertNotIn("human", header["motions"][0])
        self.assertIn("the source has changed since", header["title"])
        self.assertIn("human", self.header(clips["squat.bvh"])["motions"][0])
        self.assertNotIn("message", clips["squat.bvh"])

    def test_a_motion_that_has_changed_is_not_shown(self):
        self.batch()
        text = (self.folder / "out/squat.csv").read_text()
        self.write("out/walk.csv", text)
        self.assert_done(self.gallery())
        walk = next(clip for clip in self.index()["clips"] if clip["name"] == "walk.bvh")
        self.assertIn("the motion has changed since", walk["message"])
        self.assertNotIn("picture", walk)

    def test_paths_are_those_of_the_batchs_call_or_of_its_folder(self):
        self.batch(clips=("walk",))
        # Moved with its sources: the same names are found from the batch's folder.
        (self.folder / "clips").rename(self.folder / "out/clips")
        self.write("clips/walk.bvh", short_clip("squat", 40))
        self.assert_done(self.gallery())
        clip = self.index()["clips"][0]
        self.assertNotIn("message", clip)
        self.assertIn("human", self.header(clip)["motions"][0])

    def test_files_that_others_name_are_not_reported(self):
        self.batch(clips=("walk",))
        self.write("secret.txt", "HIERARCHY\nthe secret word\n")
        options = json.loads((self.folder / "out/options.json").read_text())
        entry = self.entries()[0]
        for role in ("map", "tpose-file", "limits", "smpl-model"):
            options[0]["paths"] = {role: "secret.txt"}
            options[0]["options"][role] = str(self.folder / "secret.txt")
            self.write("out/options.json", json.dumps(options))
            self.write_entries([entry])
            self.assert_done(self.gallery())
            message = self.index()["clips"][0]["message"]
            self.assertIn("a file named by the batch's options has changed since: secret.txt", message)
            for file in self.folder.glob("gallery/**/*.html"):
                self.assertNotIn("the secret", file.read_text(), role)
        options[0]["paths"] = {}
        self.write("out/options.json", json.dumps(options))
        self.write_entries([{**entry, "input": {**entry["input"], "file": "secret.txt"}}])
        self.assert_done(self.gallery())
        for file in self.folder.glob("gallery/**/*.html"):
            self.assertNotIn("the secret", file.read_text())

    def test_the_robot_of_the_call_is_for_its_own_motions(self):
        self.write("clips/walk.bvh", short_clip("walk", 40))
        self.run_tool("batch", "clips", "-o", "out", "--method", "gmr",
                      "--robot", "unitree_g1", "--robot", "booster_t1_29dof")
        self.assert_done(self.gallery("--robot", "unitree_g1"))
        clips = self.index()["clips"]
        self.assertEqual(sorted(clip["robot"] for clip in clips),
                         ["booster_t1_29dof", "unitree_g1"])
        for clip in clips:
            self.assertNotIn("message", clip)
            header = self.header(clip)
            robot = header["robots"][header["motions"][0]["robot"]]
            self.assertEqual(robot["name"], clip["robot"])
        self.assert_fails(self.run_tool("view", "out", "-o", "other", "--robot", "fourier_n1"), 2,
                          "no motions for the robot", "booster_t1_29dof, unitree_g1")
        self.assertFalse((self.folder / "other").exists())

    def test_the_options_say_how_a_motion_was_written(self):
        self.batch(clips=("walk",))
        motion = self.folder / "out/walk.csv"
        rows = read_rows(motion.read_text())
        for row in rows:
            # On a high platform, as if in centimetres; a rotated arm, as if in degrees.
            row[2] += 30.0
            row[-1] += 12.56637
        motion.write_text("".join(",".join(map(repr, row)) + "\n" for row in rows))
        entry = self.entries()[0]
        content = motion.read_bytes()
        entry["outputs"][0].update(bytes=len(content),
                                   hash=f"sha256:{hashlib.sha256(content).hexdigest()}")
        self.write_entries([entry])
        self.assert_done(self.gallery())
        clip = self.index()["clips"][0]
        self.assertNotIn("message", clip)
        self.assertIn("picture", clip)

    def test_pages_of_an_earlier_gallery_are_removed(self):
        self.batch()
        self.assert_done(self.gallery())
        self.write("gallery/clips/notes.html", "my own")
        self.write_entries([e for e in self.entries() if e["relative"] == "walk.bvh"])
        self.assert_done(self.gallery())
        clip = self.index()["clips"][0]
        left = sorted(f.name for f in self.folder.glob("gallery/clips/*"))
        self.assertEqual(left, sorted(["notes.html", *(pathlib.Path(clip[key]).name
                                                       for key in ("page", "picture"))]))

    def test_no_folder_of_a_batch_becomes_a_gallery(self):
        self.write("clips/sub/walk.bvh", short_clip("walk", 40))
        self.batch("--shard", "1/1")
        self.write("parts/manifest.part_1_of_2.jsonl", "")
        before = self.files()
        for output in ("parts", "out", "out/sub", "clips", "clips/sub", "."):
            self.assert_fails(self.run_tool("view", "out", "-o", output), 2, "own files")
        self.assertEqual(self.files(), before)

    def test_faults_are_explained(self):
        self.batch(clips=("walk",))
        self.assert_fails(self.gallery(folder="clips"), 3, "manifest.jsonl")
        for output, word in (("page.html", "folder"), ("out/walk.csv", "folder"), ("-", "folder"),
                             ("out", "batch"), ("no/gallery", "no")):
            self.assert_fails(self.run_tool("view", "out", "-o", output), 2, word)
        self.assert_fails(self.gallery("--bvh", "clips/walk.bvh"), 2, "--bvh")
        self.assert_fails(self.run_tool("view", "out", "clips", "-o", "gallery"), 2, "one folder")
        self.assert_fails(self.gallery("--robot", "no_such_robot"), 4, "no_such_robot")
        self.assertFalse((self.folder / "gallery").exists())

    def data_with_a_gate_of_its_own(self):
        """A data folder whose gates are a pipe, so that making a page waits for them."""
        data = self.folder / "data"
        data.mkdir()
        for name in ("robots", "configs"):
            source = SOURCE / name
            (data / name).mkdir()
            for each in source.iterdir():
                if each.name != "quality":
                    (data / name / each.name).symlink_to(each)
        (data / "configs/quality").mkdir()
        os.mkfifo(data / "configs/quality/default.json")
        return data

    def start_waiting_gallery(self, processors=None, **environment):
        data = self.data_with_a_gate_of_its_own()
        process = subprocess.Popen([TOOL, "view", "out", "-o", "gallery", "--data-dir", data],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True,
                                   preexec_fn=lambda: processors and
                                   os.sched_setaffinity(0, processors),
                                   env={**os.environ, **environment})
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        return process

    def feed(self):
        """Releases one process that waits for gates; returns whether there was one."""
        try:
            end = os.open(self.folder / "data/configs/quality/default.json",
                          os.O_WRONLY | os.O_NONBLOCK)
        except OSError:
            return False
        with contextlib.suppress(BrokenPipeError), open(end, "wb") as pipe:
            pipe.write((SOURCE / "configs/quality/default.json").read_bytes())
        return True

    def wait_until(self, condition):
        deadline = time.monotonic() + 120
        while not (found := condition()):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        return found

    def children(self, process):
        path = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
        try:
            return [int(word) for word in path.read_text().split()]
        except FileNotFoundError:
            return []

    def test_one_that_is_stopped_leaves_nothing_half_written(self):
        self.batch(clips=("walk",))
        entry = self.entries()[0]
        self.write_entries([{**entry, "relative": f"walk{i:03}.bvh"} for i in range(120)])
        process = self.start_waiting_gallery()

        def first_page():
            self.feed()
            return list(self.folder.glob("gallery/clips/*.html"))

        self.wait_until(first_page)
        # The next pages wait, so that it cannot finish.
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)

        def ended():
            self.feed()
            time.sleep(0.1)
            return process.poll() is not None

        self.wait_until(ended)
        self.assertEqual(process.returncode, 130)
        made = sorted(f.name for f in self.folder.glob("gallery/**/*") if f.is_file())
        self.assertNotIn("index.html", made)
        self.assertTrue(made)
        self.assertLess(len(made), 240)
        for name in made:
            self.assertRegex(name, r"^walk.*\.(html|png)$")
            content = (self.folder / "gallery/clips" / name).read_bytes()
            self.assertTrue(content.endswith(b"</html>\n") or b"IEND" in content[-12:], name)

    def test_it_fails_when_every_process_dies(self):
        self.batch()
        # At its end the leak checker starts a child process, and hangs if that is killed.
        options = ":".join(filter(None, [os.environ.get("ASAN_OPTIONS"), "detect_leaks=0"]))
        process = self.start_waiting_gallery(ASAN_OPTIONS=options)

        def ended():
            for child in self.children(process):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(child, signal.SIGKILL)
            return process.poll() is not None

        self.wait_until(ended)
        told = process.stderr.read()
        self.assertEqual(process.returncode, 1, told)
        self.assertIn("no page could be created", told)
        self.assertFalse((self.folder / "gallery/index.html").exists())

    def test_links_skip_a_page_that_failed(self):
        self.batch(clips=("walk", "squat", "wave"))
        # On one processor there is one process at a time.
        process = self.start_waiting_gallery(processors=[min(os.sched_getaffinity(0))])
        gates = self.folder / "data/configs/quality/default.json"

        def waiting():
            """Returns the other end of the pipe as soon as a process reads it."""
            with contextlib.suppress(OSError):
                return os.open(gates, os.O_WRONLY | os.O_NONBLOCK)

        end = self.wait_until(waiting)
        # Later processes need not wait.
        ready = self.write("ready.json", (SOURCE / "configs/quality/default.json").read_bytes())
        os.replace(self.folder / ready, gates)
        os.kill(self.children(process)[0], signal.SIGKILL)
        os.close(end)
        self.wait_until(lambda: process.poll() is not None)
        self.assertEqual(process.returncode, 0, process.stderr.read())
        clips = self.index()["clips"]
        self.assertIn("its page could not be created", [clip.get("message") for clip in clips])
        for clip in clips:
            self.assertTrue((self.folder / "gallery" / clip["page"]).is_file(), clip)

    @unittest.skipIf(is_sanitized(), "sanitizers take address space beyond any bound")
    def test_memory_is_bounded(self):
        self.batch(clips=("walk",))
        process = self.start_waiting_gallery()
        child = self.wait_until(lambda: self.children(process))[0]
        limits = pathlib.Path(f"/proc/{child}/limits")
        # The bound applies first in a new process.
        self.wait_until(lambda: "unlimited" not in re.search("Max data size +(.+)",
                                                             limits.read_text())[1].split()[0])

        def ended():
            self.feed()
            return process.poll() is not None

        self.wait_until(ended)

class GalleryInABrowser(GalleryTest):
    def setUp(self):
        super().setUp()
        self.program = chromium()
        if self.program is None:
            absent("there is no Chromium (Debian: chromium)")

    def names(self, browser):
        return browser.run(
            "[...document.querySelectorAll('.clip h2')].map((node) => node.textContent)")

    def choose(self, browser, identity, value):
        browser.run(f"document.getElementById('{identity}').value = {json.dumps(value)};"
                    "document.getElementById('tools').dispatchEvent(new Event('input'))")

    def follow(self, browser, condition):
        """Follows a link and waits for the page."""
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            try:
                return browser.wait_for(condition, wait=deadline - time.monotonic())
            except RuntimeError:
                # Requested while the browser was between two pages.
                time.sleep(0.05)
        return self.fail(condition)

    def test_a_thousand_clips(self):
        self.batch(clips=("walk",))
        entry = self.entries()[0]
        entries = []
        for i in range(1000):
            quality = json.loads(json.dumps(entry["quality"]))
            quality["figures"]["peak_speed"] = 1.0 + i * 7919 % 1000
            quality["gates_missed"] = ["jumps"] if i % 4 == 0 else []
            entries.append({**entry, "relative": f"take {i % 10}/clip_{i}.bvh", "frames": 30 + i,
                            "quality": quality,
                            "outputs": [{**entry["outputs"][0], "file": f"gone/{i}.csv"}]})
        self.write_entries(entries)
        result = self.gallery()
        self.assert_done(result)
        self.assertIn("1000 motions of the manifest are missing: gone/", result.stderr)
        page = self.folder / "gallery/index.html"
        self.assertLess(page.stat().st_size, 2_000_000)
        with Browser(self.program) as browser:
            browser.open(page)
            self.assertEqual(len(self.names(browser)), 1000)
            # The page stays fast on a busy machine: it has few elements, and cards out of sight are
            # neither laid out nor drawn.
            elements = browser.run("document.querySelectorAll('*').length")
            self.assertLess(elements, 13_000)
            skipped = browser.run(
                "[...document.querySelectorAll('.clip')].filter((card) =>"
                "!card.querySelector('h2').checkVisibility({contentVisibilityAuto: true})).length")
            self.assertGreater(skipped, 900)
            self.choose(browser, "search", "CLIP_99 take")
            self.assertEqual(sorted(self.names(browser)), sorted(
                [f"take {i % 10}/clip_{i}.bvh" for i in (99, *range(990, 1000))]))
            self.choose(browser, "search", "")
            self.choose(browser, "filter", "gate jumps")
            self.assertEqual(len(self.names(browser)), 250)
            self.assertIn("250 of 1000 clips",
                          browser.run("document.getElementById('count').textContent"))
            self.choose(browser, "filter", "")
            self.choose(browser, "sort", "seconds")
            self.assertEqual(self.names(browser)[0], "take 9/clip_999.bvh")
            metric = [each["key"] for each in self.index()["metrics"]].index("peak_speed")
            self.choose(browser, "sort", f"figure {metric}")
            worst = max(range(1000), key=lambda i: i * 7919 % 1000)
            self.assertEqual(self.names(browser)[0], f"take {worst % 10}/clip_{worst}.bvh")
            browser.run("document.getElementById('turn').click()")
            self.assertEqual(self.names(browser)[0], "take 0/clip_0.bvh")
            self.choose(browser, "search", "nothing like it")
            self.assertFalse(browser.run("document.getElementById('nothing').hidden"))
            self.assertEqual(browser.complaints(), [])
            self.assertEqual(len(browser.requests()), 1)

    def test_pictures_links_keys_and_odd_names(self):
        self.write("clips/" + ODD, short_clip("wave", 30))
        self.batch()
        self.assert_done(self.gallery())
        with Browser(self.program) as browser:
            browser.open(self.folder / "gallery/index.html")
            browser.wait_for("document.images.length === 3 && "
                             "[...document.images].every((image) => image.naturalWidth > 100)")
            self.assertIn(ODD, self.names(browser))
            self.assertEqual(browser.complaints(), [])
            policy = browser.run(
                "document.querySelector('meta[http-equiv=Content-Security-Policy]').content")
            self.assertIn("img-src 'self';", policy)
            pages = browser.run("[...document.querySelectorAll('a.clip')].map((node) => node.href)")
            self.assertEqual(len(pages), 3)
            browser.run("document.querySelector('a.clip').click()")
            # Into the first, on to the others, back, and to the index.
            for key, wanted in (("", 0), ("]", 1), ("]", 2), ("]", 2), ("[", 1)):
                if key:
                    browser.press(key)
                there = f"location.href === {json.dumps(pages[wanted])}"
                self.follow(browser, f"window.retarget && {there}")
            self.assertEqual(browser.complaints(), [])
            browser.run("document.querySelector('.clip-link').click()")
            self.follow(browser, "document.getElementById('clips')")


if __name__ == "__main__":
    unittest.main()
