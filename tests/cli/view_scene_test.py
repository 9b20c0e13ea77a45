"""Numbers of the motions in pages: parts of viewer/src without a browser, in Node."""

import json
import unittest

import numpy as np

from tool import NODE, SOURCE, run_in_node

VIEWER = SOURCE / "viewer/src"
RIM = 0.006

# A motion of one body and one joint: frames, rate, position of the root by frame.
MOTION = """
const { Motion } = await import(`${viewer}/motions.js`);
const robot = {
  root: 1, joints: [{ name: 'knee', body: 1 }], outputs: [0],
  links: [{ parent: -1 }, { parent: 0, joint: 0, pose: [0, 0, -0.4, 1, 0, 0, 0] }],
  bodies: [{ name: 'world', link: -1, pose: [0, 0, 0, 1, 0, 0, 0] },
           { name: 'pelvis', link: 0, pose: [0, 0, 0, 1, 0, 0, 0] },
           { name: 'foot', link: 1, pose: [0, 0, -0.4, 1, 0, 0, 0] }],
  soles: [{ side: 'left', body: 2, points: [[0, 0, -0.05], [0.1, 0, -0.05], [0, 0.1, -0.05]] }],
};
const motionOf = (frames, fps, place) => new Motion(
  { label: 'a', robot: 0, frames, rate: [fps, 1],
    tracks: { position: 0, rotation: 1, joints: 2 }, contacts: [] },
  0, { robots: [robot], humans: [] },
  [Float64Array.from(Array.from({ length: frames }, (_, i) => place(i)).flat()),
   Float64Array.from(Array.from({ length: frames }, () => [1, 0, 0, 0]).flat()),
   new Float64Array(frames)]);
"""


@unittest.skipUnless(NODE, "there is no Node")
class Scene(unittest.TestCase):
    """Without a browser and without three.js."""

    def run_script(self, script, value=None):
        """The result of a script for `value`; `viewer` is the folder of the sources."""
        text = f"""
            const viewer = {json.dumps(VIEWER.as_uri())};
            const value = {json.dumps(value)};
            // what modules ask a browser when they are read
            globalThis.window = {{
              matchMedia: () => ({{ matches: false, addEventListener() {{}} }}),
            }};
            const main = async () => {{ {script} }};
            process.stdout.write(JSON.stringify(await main()));
        """
        return run_in_node(self, text)

    def test_soles_of_every_robot_are_plates_below_the_foot(self):
        soles = {}
        for file in sorted(SOURCE.glob("robots/**/robot.json")):
            for side, sole in json.loads(file.read_text()).get("soles", {}).items():
                soles[f"{file.parent.name} {side}"] = sole["points"]
        self.assertGreater(len(soles), 10)
        plates = self.run_script(
            "const { solePlate } = await import(`${viewer}/sole_plate.js`);"
            "return Object.fromEntries("
            "Object.entries(value).map(([name, points]) => [name, solePlate(points)]));",
            soles,
        )
        for name, points in soles.items():
            with self.subTest(name):
                self.assertIsNotNone(plates[name])
                points = np.array(points)
                vertices = np.array(plates[name]["vertices"]).reshape(-1, 3)
                middle = points.mean(axis=0)
                *axes, normal = np.linalg.svd(points - middle)[2]
                # All of the sole is on the plate, which is hardly wider, and thin.
                for axis in axes:
                    wide = (vertices - middle) @ axis
                    low, high = wide.min(), wide.max()
                    along = (points - middle) @ axis
                    self.assertLess(low, along.min())
                    self.assertGreater(high, along.max())
                    self.assertLess(high - low, np.ptp(along) + 6 * RIM)
                uneven = np.ptp((points - middle) @ normal)
                self.assertLess(np.ptp((vertices - middle) @ normal), 3 * RIM + 2 * uneven + 1e-9)
                # The plate is outside the foot, on the side away from the ankle.
                up = normal if normal @ -middle > 0 else -normal
                heights = (vertices - middle) @ up
                self.assertLess(heights.min() + RIM, uneven + 1e-9)
                self.assertGreater(heights.max(), RIM)

    def test_points_on_a_line_are_no_plate(self):
        self.assertIsNone(
            self.run_script(
                "const { solePlate } = await import(`${viewer}/sole_plate.js`);"
                "return solePlate([[0, 0, 0], [1, 1, 0], [2, 2, 0]]);"
            )
        )

    def test_the_camera_follows_the_motion_that_continues(self):
        first, last, ended = self.run_script(
            MOTION
            + """
            const { calmWay, onWay } = await import(`${viewer}/ways.js`);
            const short = motionOf(31, 30, () => [0, 0, 0.8]);
            const long = motionOf(501, 50, (i) => [0.1 * i, 2, 0.8]);
            const way = calmWay([short, long]);
            return [onWay(way, 0), onWay(way, 10), [1, 1.04, 10].map((t) => short.hasEnded(t))];
            """
        )
        np.testing.assert_allclose(first, [0, 1, 0.8], atol=1e-9)
        np.testing.assert_allclose(last, [50, 2, 0.8], atol=1e-9)
        self.assertEqual(ended, [False, True, True])

    def test_a_human_continues_after_its_motion(self):
        self.assertEqual(
            self.run_script(
                MOTION
                + "const motion = motionOf(31, 30, () => [0, 0, 0]);"
                + "return [0.5, 1, 3].map((time) => [motion.frameAt(time), motion.step(time)]);"
            ),
            [[15, 15], [30, 30], [30, 90]],
        )

    def test_figures_are_as_large_as_their_robot_wherever_it_is(self):
        stands = self.run_script(
            MOTION
            + """
            const { standing, lift } = await import(`${viewer}/ways.js`);
            return [0.85, 2.7, 0.2].map((z) => {
              const motion = motionOf(40, 30, () => [0, 0, z]);
              const stand = standing(motion);
              return [stand.height, stand.root, lift(z, stand)];
            });
            """
        )
        # Pelvis to sole is 0.85; the pelvis is the highest point.
        for height, root, _ in stands:
            self.assertAlmostEqual(height, 1.18 * 0.85)
            self.assertAlmostEqual(root, 0.85)
        # The camera follows a climbing or crawling body up and down, but not a standing one.
        self.assertEqual(stands[0][2], 0)
        self.assertGreater(stands[1][2], 1.6)
        self.assertLess(stands[2][2], -0.5)

    def test_faults_are_counted_in_all(self):
        faults = [{"metric": "limit_pct", "kind": "limit"}] * 10
        faults.append({"metric": "jumps", "kind": "jump"})
        totals, texts = self.run_script(
            """
            const { totalsByKind, countText } = await import(`${viewer}/timeline.js`);
            return [[...totalsByKind(value)], [countText(10, 37), countText(3, 3)]];
            """,
            [
                {"report": {"faults": faults, "fault_totals": {"limit_pct": 37, "jumps": 1}}},
                {"report": {"faults": faults[-1:]}},
                {},
            ],
        )
        self.assertEqual(dict(totals), {"limit": 37, "jump": 2})
        self.assertEqual(texts, ["worst 10 of 37", "3"])

    def test_limits_of_several_motions_are_those_that_all_keep(self):
        self.assertEqual(
            self.run_script(
                """
                const { commonLimits } = await import(`${viewer}/joints_panel.js`);
                return [
                  [{ lower: -1, upper: 2 }, { lower: -2, upper: 1 }],
                  [{ lower: null, upper: 2 }, { lower: -2, upper: null }],
                  [{ lower: null, upper: null }],
                ].map(commonLimits);
                """
            ),
            [
                {"lower": -1, "upper": 1},
                {"lower": -2, "upper": 2},
                {"lower": None, "upper": None},
            ],
        )

    def test_without_gates_there_is_no_verdict(self):
        self.assertEqual(
            self.run_script(
                "const { verdict } = await import(`${viewer}/quality_panel.js`);"
                "return verdict({ report: { gates: [] } });"
            )["state"],
            "unjudged",
        )


if __name__ == "__main__":
    unittest.main()
