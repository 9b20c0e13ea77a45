"""Pages of `retarget view` and `--html` in a headless browser: playback, faults and errors."""

import random
import unittest

import numpy as np

from mujoco_python import load_mujoco
from pages import data_of, tracks_of
from pages_in_browser import PagesInABrowser
from tool import SOURCE

ROBOT = SOURCE / "robots/unitree_g1/model.xml"


class InABrowser(PagesInABrowser):
    """Motions, faults and figures of pages."""

    def test_bodies_are_where_mujoco_has_them(self):
        """Compares the scene with MuJoCo's kinematics of the CSV."""
        mujoco = load_mujoco()
        model = mujoco.MjModel.from_xml_path(str(ROBOT))
        data = mujoco.MjData(model)
        rows = np.loadtxt(self.pages / "fit.csv", delimiter=",")
        self.assertEqual(rows.shape[1], model.nq)
        for page in ("run.html", "two.html"):
            self.open(page)
            self.assert_quiet(page)
            self.assertEqual(self.run_script("retarget.motions[0].frames"), len(rows))
            worst = 0.0
            for frame in random.Random(7).sample(range(len(rows)), 20):
                # CSV quaternions have w last.
                data.qpos[:] = rows[frame]
                data.qpos[3:7] = rows[frame, [6, 3, 4, 5]]
                mujoco.mj_kinematics(model, data)
                self.run_script(f"retarget.show({frame})")
                found = {
                    each["name"]: each["position"] for each in self.run_script("retarget.bodies(0)")
                }
                for body in range(1, model.nbody):
                    apart = data.xpos[body] - found[model.body(body).name]
                    worst = max(worst, float(np.linalg.norm(apart)))
            self.assertLess(worst, 2e-4)
            self.assertGreater(worst, 0.0)

    def test_joints_and_bones_are_those_of_the_files(self):
        self.open("one.html")
        rows = np.loadtxt(self.pages / "fit.csv", delimiter=",")
        self.assert_done(self.run_in_pages("inspect", "walk.bvh", "--positions", "positions.csv"))
        with open(self.pages / "positions.csv", encoding="utf-8") as file:
            names = file.readline().strip().split(",")
            places = np.loadtxt(file, delimiter=",")
        columns = {name: i for i, name in enumerate(names)}
        hips = next(name for name in names if "Hips" in name)
        for frame in (0, 77, 300):
            joints = list(self.run_script(f"retarget.joints(0, {frame})").values())
            self.assertLess(np.abs(rows[frame, 7:] - joints).max(), 1e-4)
            bones = {
                each["name"]: each["position"]
                for each in self.run_script(f"retarget.bones(0, {frame})")
            }
            at = columns[hips]
            # The file is in centimetres with y up.
            x, y, z = places[frame, at : at + 3] / 100.0
            self.assertLess(np.abs(np.array([x, -z, y]) - bones["Hips"]).max(), 1e-4)

    def test_playing_and_keys(self):
        self.open("one.html", "", size=(480, 360))
        # The page plays automatically without a time in the address.
        self.browser.wait_for("retarget.player.time > 0.2")
        self.browser.press(" ")
        self.assertFalse(self.run_script("retarget.player.playing"))
        frame = self.run_script("retarget.player.frame")
        for key, moved in ((".", 1), (".", 2), (",", 1)):
            self.browser.press(key)
            self.assertEqual(self.run_script("retarget.player.frame"), frame + moved)
        self.browser.press("End")
        self.assertAlmostEqual(self.time(), 10.0)
        self.browser.press("Home")
        self.assertEqual(self.time(), 0.0)
        self.browser.press("ArrowRight")
        self.assertAlmostEqual(self.time(), 1.0)
        # A looped part, at four times the speed.
        self.browser.press("i")
        self.run_script("retarget.player.seek(1.5)")
        self.browser.press("o")
        for _ in range(5):
            self.browser.press("+")
        self.assertEqual(self.run_script("retarget.player.speed"), 4)
        self.run_script(
            "window.times = [];"
            "retarget.player.addEventListener('time', () => times.push(retarget.player.time));"
            "retarget.player.play()"
        )
        self.browser.wait_for("times.some((time, i) => i > 0 && time < times[i - 1])")
        low, high = self.run_script("[Math.min(...times), Math.max(...times)]")
        self.assertGreaterEqual(low, 1.0)
        self.assertLess(high, 1.5 + 1 / 30 + 1e-6)
        self.browser.press(" ")
        self.browser.press("f")
        self.assertEqual(
            self.run_script(
                "document.querySelector('[aria-label=Camera] [aria-checked=true]').textContent"
            ),
            "Fixed",
        )

    def test_the_view_rotates_with_keys_while_it_has_the_focus(self):
        self.open("one.html", "#t=2", size=(480, 360))
        view = "retarget.onScreen(0, 1)"
        before = self.run_script(view)
        self.run_script("document.getElementById('canvas').focus()")
        for key in ("ArrowRight", "ArrowUp", "+"):
            self.browser.press(key)
            after = self.run_script(f"retarget.show(60), {view}")
            self.assertGreater(np.abs(np.subtract(after, before)).max(), 0.5, key)
            before = after
        self.assertEqual(self.time(), 2.0)
        self.assertEqual(self.run_script("retarget.player.speed"), 1)
        # A click does not set the focus: arrows still move through time.
        self.browser.click(240, 120)
        self.assertEqual(self.run_script("document.activeElement.tagName"), "BODY")
        self.browser.press("ArrowRight")
        self.assertEqual(self.time(), 3.0)

    def test_a_link_to_a_moment(self):
        self.open("one.html", "#t=2.5")
        self.assertEqual(self.time(), 2.5)
        self.assertFalse(self.run_script("retarget.player.playing"))
        self.assertIn("2.50", self.run_script("document.getElementById('clock').textContent"))
        self.run_script("location.hash = '#t=4'")
        self.browser.wait_for("retarget.player.time === 4")

    def test_faults_lead_to_their_worst_frame(self):
        self.open("two.html")
        header = data_of((self.pages / "two.html").read_text())[0]
        faults = [fault for motion in header["motions"] for fault in motion["report"]["faults"]]
        self.assertEqual(self.run_script("document.querySelectorAll('.mark').length"), len(faults))
        # The last mark lies on top of those that it overlaps.
        floating = [fault for fault in faults if fault["kind"] == "floating"][-1]
        x, y = self.run_script(
            "(() => { const mark = [...document.querySelectorAll('.mark.floating')].at(-1);"
            "const box = mark.getBoundingClientRect();"
            "return [box.x + box.width / 2, box.y + box.height / 2]; })()"
        )
        self.browser.click(x, y)
        self.assertAlmostEqual(self.time(), floating["worst"] / 30.0)
        # Also from the list.
        self.run_script("document.getElementById('tab-faults').click()")
        listed = self.run_script(
            "[...document.querySelectorAll('.list button')].map((button) => button.innerText)"
        )
        for text, fault in zip(listed, faults, strict=True):
            self.assertIn(fault["label"], text)
        self.run_script("[...document.querySelectorAll('.list button')].at(-1).click()")
        self.assertAlmostEqual(self.time(), faults[-1]["worst"] / 30.0)
        self.assert_quiet("two.html")

    def test_a_fault_marks_only_its_own_motion(self):
        self.open("two.html")
        header = data_of((self.pages / "two.html").read_text())[0]
        faults = [
            (i, fault)
            for i, motion in enumerate(header["motions"])
            for fault in motion["report"]["faults"]
        ]
        at, (motion, fault) = next(
            (at, each) for at, each in enumerate(faults) if each[1]["bodies"] and each[0] == 1
        )
        self.run_script(f"document.querySelectorAll('.list button')[{at}].click()")
        marked = [self.run_script(f"retarget.highlighted({i})") for i in (0, 1)]
        self.assertEqual(marked[1 - motion], [])
        self.assertNotEqual(marked[motion], [])
        self.assertTrue(set(marked[motion]) <= set(fault["bodies"]))
        # A chosen body is marked in all motions of its robot.
        self.run_script(
            "const select = document.querySelector('#panel-body select');"
            f"select.value = {marked[motion][0]}; select.dispatchEvent(new Event('change'))"
        )
        self.assertEqual([self.run_script(f"retarget.highlighted({i})") for i in (0, 1)],
                         [marked[motion][:1]] * 2)

    def test_gates_and_figures_have_plain_labels(self):
        self.open("two.html")
        report = data_of((self.pages / "two.html").read_text())[0]["motions"][0]["report"]
        gates, figures = self.run_script(
            "[...document.querySelectorAll('#panel-quality table')].map((table) =>"
            "[...table.querySelectorAll('tbody tr')].map((row) =>"
            "[row.cells[0].textContent, row.cells[0].title || row.title]))"
        )
        self.assertIn(["Self-collision", "self_1cm_pct"], gates)
        self.assertEqual(len(figures), len(report["figures"]))
        self.assertEqual([text for text, _ in gates + figures if "_" in text], [])
        keys = {each["key"] for each in report["figures"]}
        self.assertEqual({title.split(":")[0] for _, title in figures}, keys)

    def test_contact_rows_distinguish_motions(self):
        self.assert_done(
            self.run_in_pages("view", "fit.csv", "fit.npz", "--robot", "unitree_g1",
                              "--bvh", "walk.bvh", "-o", "same.html")
        )
        self.open("same.html")
        titles = self.run_script(
            "[...document.querySelectorAll('#lanes .name')]"
            ".filter((each) => each.textContent === 'Left foot').map((each) => each.title)"
        )
        self.assertEqual(
            titles, ["In contact, from top to bottom: walk.bvh, fit.csv, fit.npz"]
        )
        # The first colour in the middle of each band.
        colours = self.run_script("""(() => {
            const canvas = [...document.querySelectorAll('#lanes .name')]
              .find((each) => each.textContent === 'Left foot').nextSibling.firstChild;
            const context = canvas.getContext('2d');
            const found = [1, 3, 5].map((sixth) => {
              const y = Math.floor((sixth / 6) * canvas.height);
              const row = context.getImageData(0, y, canvas.width, 1).data;
              const at = row.findIndex((value, i) => i % 4 === 3 && value > 100) - 3;
              return at < 0 ? null : [...row.slice(at, at + 3)].join();
            });
            return found;
        })()""")
        self.assertNotIn(None, colours)
        self.assertEqual(len(set(colours)), 3)

    def test_two_in_step_with_their_figures(self):
        self.open("two.html")
        self.run_script("retarget.show(60)")
        places = [
            {
                each["name"]: np.array(each["position"])
                for each in self.run_script(f"retarget.bodies({motion})")
            }
            for motion in (0, 1)
        ]
        apart = [np.linalg.norm(places[0][name] - place) for name, place in places[1].items()]
        self.assertGreater(max(apart), 0.005)
        self.assertLess(max(apart), 0.3)
        verdicts = self.run_script(
            "[...document.querySelectorAll('.verdict')].map((each) => each.textContent)"
        )
        self.assertEqual(len(verdicts), 2)
        self.assertIn("fit.csv: all", verdicts[0])
        self.assertIn("gates missed", verdicts[1])
        names = self.run_script(
            "[...document.querySelectorAll('.tag:not([hidden])')].map((each) => each.textContent)"
        )
        self.assertEqual(sorted(names), ["fit.csv", "gmr.csv", "walk.bvh"])

    def test_a_click_picks_a_body(self):
        self.open("two.html", "#t=3")
        bodies = self.run_script("retarget.bodies(1).map((each) => each.name)")
        torso = bodies.index("torso_link")
        x, y = self.run_script(f"retarget.onScreen(1, {torso})")
        self.browser.click(x, y)
        picked = self.run_script("retarget.picked()")
        self.assertEqual((picked["motion"], bodies[picked["body"]]), (1, "torso_link"))
        panel = self.run_script("document.getElementById('panel-body').innerText")
        for text in ("torso_link", "waist_pitch_joint", "Tracking error", "rad"):
            self.assertIn(text, panel)

    def test_errors_of_the_picked_body_over_time(self):
        self.open("two.html", "#t=3", size=(640, 420))
        page = (self.pages / "two.html").read_text()
        header, tracks = data_of(page)[0], tracks_of(page)
        bodies = self.run_script("retarget.bodies(0).map((each) => each.name)")
        name = "left_ankle_roll_link"
        # Fifteen per second.
        self.assertEqual([each["error_stride"] for each in header["motions"]], [2, 2])
        self.run_script(
            "const select = document.querySelector('#panel-body select');"
            f"select.value = {bodies.index(name)}; select.dispatchEvent(new Event('change'));"
            "document.getElementById('tab-body').click()"
        )
        for frame in (90, 200):
            self.run_script(f"retarget.show({frame})")
            panel = self.run_script("document.getElementById('panel-body').innerText")
            for i, motion in enumerate(header["motions"]):
                [errors] = [each for each in motion["errors"] if each["body"] == name]
                values = {
                    key: float(tracks[errors[key]][frame // 2, 0])
                    for key in ("position", "rotation")
                }
                shown = self.run_script(f"retarget.errors({i}, '{name}', {frame})")
                self.assertAlmostEqual(shown["position"], values["position"], places=6)
                self.assertAlmostEqual(shown["rotation"], values["rotation"], places=6)
                for key, unit in (("position", "cm"), ("rotation", "\u00b0")):
                    self.assertIn(f"{values[key]:.1f}\u202f{unit}", panel)
        # Its curves, with a synchronous cursor.
        self.run_script("document.getElementById('tab-joints').click()")
        plots = "[...document.querySelectorAll('#panel-joints section .plot')]"
        self.assertEqual(
            self.run_script(f"{plots}.map((each) => each.querySelector('b').textContent)"),
            ["position error, cm", "rotation error, \u00b0"],
        )
        cursor = f"{plots}[0].querySelector('.cursor').getBoundingClientRect().left"
        # Drawn once the browser has reported its size.
        area = "document.querySelector('#panel-joints section .area').getBoundingClientRect()"
        for frame in (250, 60):
            self.run_script(f"retarget.show({frame})")
            there = f"{area}.left + {frame} / 300 * {area}.width"
            self.browser.wait_for(f"Math.abs({cursor} + 0.75 - ({there})) < 3")
        self.assert_quiet("two.html")
        # Another body has its own curves, an empty selection has none.
        self.run_script(
            "select.value = ''; select.dispatchEvent(new Event('change'))"
        )
        self.assertEqual(self.run_script(f"{plots}.length"), 0)

    def test_the_source_is_shown_beside_each_motion(self):
        self.open("two.html", "#t=3", size=(640, 420))
        self.assertEqual([each["motion"] for each in self.run_script("retarget.humans()")], [0])
        button = (
            "[...document.querySelectorAll('button')]"
            ".find((each) => each.textContent === 'Per robot')"
        )
        apart = "retarget.placeOf(1).map((value, i) => value - retarget.placeOf(0)[i])"
        before = np.linalg.norm(self.run_script(apart))
        self.run_script(f"{button}.click()")
        humans = self.run_script("retarget.humans()")
        self.assertEqual([each["motion"] for each in humans], [0, 1])
        self.assertEqual(self.run_script(f"{button}.getAttribute('aria-pressed')"), "true")
        # The layout makes room for the second one.
        self.assertGreater(np.linalg.norm(self.run_script(apart)), before + 0.3)
        places = [np.array(each["place"]) for each in humans]
        self.assertGreater(np.linalg.norm(places[1] - places[0]), 0.5)
        self.run_script("retarget.show(95)")
        names = self.run_script(
            "[...document.querySelectorAll('.tag:not([hidden])')].map((each) => each.textContent)"
        )
        self.assertEqual(sorted(names), ["fit.csv", "gmr.csv", "walk.bvh", "walk.bvh"])
        self.run_script(f"{button}.click()")
        self.assertEqual([each["motion"] for each in self.run_script("retarget.humans()")], [0])
        self.assert_quiet("two.html")
        # A single motion has no choice.
        self.open("one.html", size=(640, 420))
        self.assertTrue(self.run_script(f"{button} === undefined"))


if __name__ == "__main__":
    unittest.main()
