"""Meshes of pages, as a maker's model names them: their locations, and missing files."""

import shutil
import struct
import unittest

import numpy as np

from mujoco_python import load_mujoco
from pages import data_of, tracks_of
from tool import SOURCE, ToolTest, unwrapped

# Half a step of the page's vertices along each axis.
TOLERANCE = 0.5 * 4e-4 * np.sqrt(3) + 1e-6
# Nothing is symmetric, so that axes cannot be confused.
CORNERS = np.array(
    [[0, 0, 0], [0.13, 0.02, 0], [0.01, 0.21, 0.03], [0.02, 0.01, 0.34], [0.2, 0.1, 0.3]]
)
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 4], [2, 0, 3], [1, 4, 3], [2, 3, 4]])

MODEL = """
<mujoco model="maker"><compiler angle="degree" meshdir="assets" eulerseq="zyx"/>
  <default><mesh scale="0.001 0.001 0.001"/>
    <default class="visual"><geom type="mesh" contype="0" conaffinity="0" pos="0.01 0 0"/></default>
  </default>
  <asset>
    <mesh name="trunk" file="trunk.stl"/>
    <mesh file="arm.stl" scale="0.002 -0.001 0.0015"/>
    <mesh name="ref" file="sub/hand.obj" scale="1 0.5 1.5" refpos="0.05 0.1 -0.02"
          refquat="0.8 0.2 -0.4 0.4"/>
  </asset>
  <worldbody><body name="base" pos="0 0 1"><freejoint/>
    <geom class="visual" mesh="trunk" euler="10 20 30"/>
    <geom type="mesh" mesh="arm" pos="9 9 9"/>
    <body name="upper" pos="0 0.2 0.1" quat="0.9 0.1 0.3 0.2">
      <joint name="turn" axis="0 1 0" range="-90 90"/>
      <geom type="mesh" mesh="arm" pos="0.03 0.04 0.05" axisangle="1 2 3 40"/>
      <frame pos="0 0 0.4" euler="0 90 0">
        <body name="hand"><geom type="mesh" mesh="ref" quat="0.5 0.5 -0.5 0.5" pos="0 0.1 0"/>
          <geom type="mesh" mesh="trunk"/></body>
      </frame>
    </body></body></worldbody></mujoco>"""


def binary_stl(scale=1.0):
    corners = CORNERS * scale
    return (
        bytes(80)
        + struct.pack("<I", len(FACES))
        + b"".join(
            struct.pack("<12fH", 0, 0, 0, *corners[face].astype(np.float32).ravel(), 0)
            for face in FACES
        )
    )


def text_stl(scale=1.0):
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {:.9g} {:.9g} {:.9g}\n".format(*(CORNERS[i] * scale)) for i in face)
        + "endloop\nendfacet\n"
        for face in FACES
    )
    return f"solid x\n{facets}endsolid x\n".encode()


def obj(scale=1.0):
    lines = ["v {:.9g} {:.9g} {:.9g}".format(*corner) for corner in CORNERS * scale]
    lines += ["f {} {} {}".format(*(face + 1)) for face in FACES]
    return ("\n".join(lines) + "\n").encode()


class Meshes(ToolTest):
    def make(self, name, content):
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content if isinstance(content, bytes) else content.encode())

    def make_maker(self):
        """Creates a model with meshes, and a motion of it."""
        self.make("maker/model.xml", MODEL)
        self.make("maker/assets/trunk.stl", binary_stl(1000))
        self.make("maker/assets/arm.stl", binary_stl(1000))
        self.make("maker/assets/sub/hand.obj", obj())
        self.write("a.csv", "0,0,1,0,0,0,1,0\n0.1,0,1,0,0,0,1,0.5\n")

    def page(self, *options, model="maker/model.xml", output="a.html"):
        result = self.run_tool(
            "view", "a.csv", "--robot-xml", model, "--source-quat", "xyzw",
            "--source-unit", "m", "-o", output, *options,
        )
        self.assert_done(result)
        return result

    def shown(self, output="a.html"):
        """By body: vertices, (n, 3), and triangles, (m, 3), in the body's frame."""
        page = (self.folder / output).read_text()
        header, tracks = data_of(page)[0], tracks_of(page)
        robot = header["robots"][0]
        return {
            robot["bodies"][each["body"]]["name"]: (
                tracks[each["vertices"]], tracks[each["triangles"]].astype(int)
            )
            for each in robot.get("meshes", [])
        }

    def assert_same_points(self, found, expected):
        """Asserts that both point sets are equal."""
        apart = np.linalg.norm(found[:, None] - expected[None], axis=2)
        self.assertLess(apart.min(axis=1).max(), TOLERANCE)
        self.assertLess(apart.min(axis=0).max(), TOLERANCE)

    def expected(self, mujoco, path):
        """Returns the vertices of visible geoms by body, placed by MuJoCo."""
        model = mujoco.MjModel.from_xml_path(str(path))
        bodies = {}
        for geom in range(model.ngeom):
            if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH:
                continue
            mesh = model.geom_dataid[geom]
            begin = model.mesh_vertadr[mesh]
            vertices = model.mesh_vert[begin : begin + model.mesh_vertnum[mesh]]
            turn = np.zeros(9)
            mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
            placed = vertices @ turn.reshape(3, 3).T + model.geom_pos[geom]
            name = model.body(model.geom_bodyid[geom]).name
            seen = model.geom_contype[geom] == 0 and model.geom_conaffinity[geom] == 0
            bodies.setdefault(name, []).append((seen, placed))
        return {
            name: np.concatenate(
                [placed for seen, placed in all_of if seen or not any(s for s, _ in all_of)]
            )
            for name, all_of in bodies.items()
        }

    def test_vertices_are_where_mujoco_has_them(self):
        mujoco = load_mujoco()
        self.make_maker()
        said = self.page().stderr
        self.assertIn("3 bodies", said)
        expected = self.expected(mujoco, self.folder / "maker/model.xml")
        shown = self.shown()
        self.assertEqual(shown.keys(), expected.keys())
        self.assertEqual(shown.keys(), {"base", "upper", "hand"})
        for name, vertices in expected.items():
            with self.subTest(name):
                self.assert_same_points(shown[name][0], vertices)

    def test_surfaces_look_outwards_in_mirrors_as_well(self):
        self.make_maker()
        self.page()
        for name, (vertices, triangles) in self.shown().items():
            a, b, c = (vertices[triangles[:, i]] for i in range(3))
            volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
            own = np.einsum(
                "ij,ij->i", CORNERS[FACES[:, 0]],
                np.cross(CORNERS[FACES[:, 1]], CORNERS[FACES[:, 2]]),
            ).sum() / 6
            self.assertGreater(volume * np.sign(own), 0, name)

    def test_runs_draw_meshes(self):
        self.make("robot/model.xml", (SOURCE / "robots/unitree_g1/model.xml").read_text().replace(
            "<worldbody>", '<asset><mesh file="knee.stl"/></asset><worldbody>', 1).replace(
            '<joint name="left_knee_joint"', '<geom type="mesh" mesh="knee"/>'
            '<joint name="left_knee_joint"', 1))
        self.make("robot/knee.stl", text_stl())
        self.assert_done(self.run_tool(
            SOURCE / "data/wave.bvh", "--robot-xml", "robot/model.xml", "--ik-config",
            SOURCE / "configs/lafan1_to_unitree_g1.json", "--end", 0.5,
            "-o", "run.csv", "--html", "run.html"))
        [(name, (vertices, _))] = self.shown("run.html").items()
        self.assertEqual(name, "left_knee_link")
        self.assert_same_points(vertices, CORNERS)

    def test_meshes_that_the_user_keeps(self):
        environment = self.tool_environment(XDG_DATA_HOME=str(self.folder / "own"))
        kept = "own/retarget/meshes/unitree_g1"
        self.make(f"{kept}/left_knee_link.STL", text_stl())
        run = (SOURCE / "data/wave.bvh", "--robot", "unitree_g1", "--end", 0.5, "-o", "run.csv",
               "--html", "run.html")
        self.assert_done(self.run_tool(*run, env=environment))
        [(name, (vertices, _))] = self.shown("run.html").items()
        self.assertEqual(name, "left_knee_link")
        self.assert_same_points(vertices, CORNERS)
        # Meshes that cannot be read do not stop a run.
        self.make(f"{kept}/left_knee_link.STL", b"solid x\nfacet")
        result = self.run_tool(*run, env=environment)
        self.assert_done(result)
        self.assertIn("left_knee_link.STL", result.stderr + result.stdout)
        self.assertEqual(self.shown("run.html"), {})
        # They cost only the meshes of their bodies, beside a model of the maker too.
        self.make(f"{kept}/right_knee_link.STL", text_stl())
        model = (SOURCE / "robots/unitree_g1/model.xml").read_text()
        for side in ("left", "right"):
            model = model.replace("<worldbody>", f'<asset><mesh file="{side}_knee_link.STL"/></asset><worldbody>', 1)
            model = model.replace(f'<joint name="{side}_knee_joint"', f'<geom type="mesh" mesh="{side}_knee_link"/>'
                                  f'<joint name="{side}_knee_joint"', 1)
        for text in (None, model):
            if text:
                self.make(f"{kept}/g1.xml", text)
            result = self.run_tool(*run, env=environment)
            self.assert_done(result)
            self.assertIn("the meshes of a body cannot be read: left_knee_link.STL", unwrapped(result.stderr))
            self.assertEqual(list(self.shown("run.html")), ["right_knee_link"])

    def test_urdf(self):
        self.write("g1.csv", "")
        self.make_maker()
        self.make("package/urdf/robot.urdf", """
            <robot name="maker"><link name="base"><visual><origin xyz="0.1 0 0" rpy="0.3 -0.2 0.5"/>
              <geometry><mesh filename="package://package/meshes/a.stl" scale="2 1 0.5"/></geometry>
            </visual></link>
            <link name="tip"><visual><geometry><mesh filename="../meshes/b.obj"/></geometry>
            </visual></link>
            <link name="upper"/><link name="gone"><visual><geometry>
              <mesh filename="package://package/meshes/gone.dae"/></geometry></visual></link>
            <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/></joint>
            <joint name="fix" type="fixed"><origin xyz="0 0 0.2" rpy="0 0 1.5707963267948966"/>
              <parent link="upper"/><child link="tip"/></joint></robot>""")
        self.make("package/meshes/a.stl", text_stl())
        self.make("package/meshes/b.obj", obj())
        self.page("--meshes", "package/urdf/robot.urdf")
        shown = self.shown()
        self.assertEqual(shown.keys(), {"base", "upper"})

        def turn(axis, angle):
            c, s = np.cos(angle), np.sin(angle)
            a, b = [(1, 2), (2, 0), (0, 1)][axis]
            matrix = np.eye(3)
            matrix[a, a] = matrix[b, b] = c
            matrix[a, b], matrix[b, a] = -s, s
            return matrix

        rotation = turn(2, 0.5) @ turn(1, -0.2) @ turn(0, 0.3)
        self.assert_same_points(shown["base"][0], CORNERS * [2, 1, 0.5] @ rotation.T + [0.1, 0, 0])
        self.assert_same_points(
            shown["upper"][0], CORNERS @ turn(2, np.pi / 2).T + [0, 0, 0.2]
        )

    def test_files_in_another_folder(self):
        self.make_maker()
        self.make("elsewhere/Trunk.STL", text_stl(1000))
        self.make("elsewhere/arm.stl", binary_stl(1000))
        self.make("elsewhere/hand.obj", obj())
        self.page()
        own = self.shown()
        for file in ("trunk.stl", "arm.stl", "sub/hand.obj"):
            (self.folder / "maker/assets" / file).unlink()
        self.page("--meshes", "elsewhere")
        self.assertEqual(self.shown().keys(), own.keys())
        for name, (vertices, _) in self.shown().items():
            self.assert_same_points(vertices, own[name][0])

    def test_missing_meshes_are_reported_and_drawn_as_primitives(self):
        self.make_maker()
        (self.folder / "maker/assets/sub/hand.obj").unlink()
        said = self.page().stderr
        self.assertIn("1 mesh file of 4 of model.xml is missing, such as", said)
        self.assertIn("hand.obj", said)
        self.assertEqual(self.shown().keys(), {"base", "upper"})
        self.make("maker/assets/trunk.stl", "solid\nvertex 1 2 x")
        said = self.page().stderr
        self.assertIn("the meshes of 2 bodies cannot be read: trunk.stl: expected three", said)
        self.assertEqual(self.shown().keys(), {"upper"})
        for file in ("trunk.stl", "arm.stl"):
            (self.folder / "maker/assets" / file).unlink()
        said = self.page().stderr
        self.assertIn("all mesh files of model.xml are missing", said)
        self.assertEqual(self.shown(), {})

    def test_damaged_meshes_of_a_folder_are_drawn_as_primitives(self):
        self.make_maker()
        self.make("elsewhere/trunk.stl", "solid\nvertex 1 2 x")
        self.make("elsewhere/arm.stl", binary_stl(1000))
        for model in ((), ("--meshes", "elsewhere"), ("--meshes", "other.xml")):
            self.make("maker/assets/trunk.stl", "solid\nvertex 1 2 x")
            self.make("other.xml", MODEL.replace("assets", "maker/assets"))
            said = unwrapped(self.page(*model).stderr)
            self.assertIn("cannot be read: trunk.stl: expected three", said)
            self.assertEqual(self.shown().keys(), {"upper"})
        # The folder's files named like bodies.
        self.make("bodies/base.stl", "solid\nvertex 1 2 x")
        self.make("bodies/upper.stl", binary_stl(1000))
        shutil.rmtree(self.folder / "maker/assets")
        said = unwrapped(self.page("--meshes", "bodies").stderr)
        self.assertIn("the meshes of a body cannot be read: base.stl", said)
        self.assertEqual(self.shown().keys(), {"upper"})
        (self.folder / "bodies/upper.stl").unlink()
        result = self.run_tool("view", "a.csv", "--robot-xml", "maker/model.xml", "--source-quat", "xyzw",
                               "--meshes", "bodies", "-o", "bad.html")
        self.assert_fails(result, 3, "bodies/base.stl: error: expected three")
        self.assertNotIn("primitives", result.stderr)

    def test_files_outside_the_package_are_not_opened(self):
        self.make_maker()
        self.make("secret.stl", binary_stl(1000))
        self.make("deep/er/maker/model.xml", MODEL.replace("trunk.stl", "../../../../secret.stl"))
        self.make("deep/er/maker/assets/arm.stl", binary_stl(1000))
        said = self.page(model="deep/er/maker/model.xml").stderr
        self.assertIn("lies outside the model's package", said)
        self.assertEqual(self.shown(), {})

    def test_missing_requested_meshes_are_an_error(self):
        self.make_maker()
        self.make("bare.xml", "<mujoco><worldbody><body name='base'/></worldbody></mujoco>")
        self.make("broken.urdf", "<robot")
        for named, code, words in (
            ("bare.xml", 3, "names no mesh for a body of"),
            ("broken.urdf", 4, "broken.urdf"),
            ("nothing.xml", 2, "no folder"),
        ):
            with self.subTest(named):
                result = self.run_tool(
                    "view", "a.csv", "--robot-xml", "maker/model.xml", "--source-quat", "xyzw",
                    "--meshes", named, "-o", "bad.html",
                )
                self.assert_fails(result, code, words)
                self.assertFalse((self.folder / "bad.html").exists())


if __name__ == "__main__":
    unittest.main()
