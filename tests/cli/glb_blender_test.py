"""A robot's GLB as Blender opens it (PyPI's bpy, an optional extra: 300 MB, which no script installs)."""

import json
import subprocess
import sys
import unittest

import numpy as np

from mujoco_python import load_mujoco
from tool import SOURCE, ToolTest, sample

ROBOT = SOURCE / "robots/unitree_g1/model.xml"
FRAMES = (0, 40, 111, 250, 299)

# Blender ends its process in an unusual way, so it runs in a separate one.
SCRIPT = """
import json, sys
import bpy
file, fps, frames = sys.argv[1], float(sys.argv[2]), json.loads(sys.argv[3])
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = int(fps)
bpy.ops.import_scene.gltf(filepath=file)
places = []
for frame in frames:
    # Second 0 is at frame 0 or 1, depending on the version of the importer.
    scene.frame_set(frame)
    places.append({each.name: list(each.matrix_world.translation) for each in scene.objects})
begin = min(action.frame_range[0] for action in bpy.data.actions)
print("FOUND " + json.dumps({"begin": begin, "places": places}))
"""


class Blender(ToolTest):
    def test_nodes_are_where_mujoco_has_the_bodies(self):
        if subprocess.run([sys.executable, "-c", "import bpy"], capture_output=True).returncode != 0:
            self.skipTest("there is no bpy, an optional extra: pip install bpy")
        mujoco = load_mujoco()
        self.assert_done(
            self.run_tool(sample("walk"), "unitree_g1", "--method", "gmr", "-o", "walk.csv")
        )
        self.assert_done(
            self.run_tool("convert", "walk.csv", "walk.glb", "--robot", "unitree_g1")
        )
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT, self.folder / "walk.glb", "30", json.dumps(FRAMES)],
            capture_output=True, text=True, timeout=300, check=False,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout.split("FOUND ")[1])
        self.assertEqual(found["begin"], 0)
        rows = np.loadtxt(self.folder / "walk.csv", delimiter=",")
        model = mujoco.MjModel.from_xml_path(str(ROBOT))
        data = mujoco.MjData(model)
        worst = 0.0
        for frame, places in zip(FRAMES, found["places"]):
            data.qpos[:] = rows[frame]
            data.qpos[3:7] = rows[frame, [6, 3, 4, 5]]
            mujoco.mj_kinematics(model, data)
            for body in range(1, model.nbody):
                apart = data.xpos[body] - places[model.body(body).name]
                worst = max(worst, float(np.linalg.norm(apart)))
        self.assertLess(worst, 2e-4)
        self.assertGreater(worst, 0.0)


if __name__ == "__main__":
    unittest.main()
