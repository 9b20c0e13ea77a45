"""Robots whose base frame has other axes: the motion of all bodies is the same."""

import math
import unittest
import xml.etree.ElementTree as ElementTree

from tool import SOURCE, ToolTest, sample


def product(a, b):
    """Product of two quaternions w x y z."""
    return [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]


def inverse(q):
    return [q[0], -q[1], -q[2], -q[3]]


def rotated(q, point):
    return product(product(q, [0.0, *point]), inverse(q))[1:]


def turn_base(model, turn):
    """The text of a model whose base frame is turned by a quaternion; everything else stays in place."""
    tree = ElementTree.parse(model)
    base = next(body for body in tree.iter("body") if body.find("freejoint") is not None)
    back = inverse(turn)

    def numbers(element, name, usual):
        text = element.get(name)
        return [float(x) for x in text.split()] if text else usual

    def put(element, name, values):
        element.set(name, " ".join(repr(x) for x in values))

    for child in base:
        if child.tag == "freejoint":
            continue
        unknown = {"euler", "axisangle", "xyaxes", "zaxis", "fullinertia"} & set(child.attrib)
        assert not unknown, unknown
        if "fromto" in child.attrib:
            ends = numbers(child, "fromto", None)
            put(child, "fromto", rotated(back, ends[:3]) + rotated(back, ends[3:]))
            continue
        put(child, "pos", rotated(back, numbers(child, "pos", [0.0] * 3)))
        put(child, "quat", product(back, numbers(child, "quat", [1.0, 0.0, 0.0, 0.0])))
    put(base, "quat", product(numbers(base, "quat", [1.0, 0.0, 0.0, 0.0]), turn))
    return ElementTree.tostring(tree.getroot(), encoding="unicode")


class TurnedBase(ToolTest):
    def add(self, name, model):
        self.assert_done(self.run_tool("robots", "add", name, "--model", model, "-o", "."))

    def test_a_torso_as_base_with_other_axes_than_the_pelvis(self):
        model = SOURCE / "robots/booster_t1/model.xml"
        (self.folder / "turned.xml").write_text(turn_base(model, [0.0, 0.0, 0.0, 1.0]))
        self.add("plain", model)
        self.add("backward", "turned.xml")
        for robot in ("plain", "backward"):
            self.assert_done(
                self.retarget("--frames", "0:60", bvh=sample("walk"), robot=f"./{robot}", output=f"{robot}.csv"))
        for expected, found in zip(self.rows("plain.csv"), self.rows("backward.csv"), strict=True):
            self.assertLess(math.dist(expected[:3], found[:3]), 0.01)
            for a, b in zip(expected[7:], found[7:], strict=True):
                self.assertAlmostEqual(a, b, delta=0.02)

    def test_the_order_of_the_quaternion_of_a_base_with_z_down(self):
        model = SOURCE / "robots/unitree_g1/model.xml"
        (self.folder / "down.xml").write_text(turn_base(model, [0.0, 1.0, 0.0, 0.0]))
        self.add("down", "down.xml")
        for name in ("wave", "walk"):
            self.assert_done(
                self.retarget("--frames", "0:90", bvh=sample(name), robot="./down", output=f"{name}.csv"))
            self.assert_done(
                self.run_tool("convert", f"{name}.csv", "--robot", "./down", "--csv-quat", "wxyz", "-o", "w.csv"))
            for file, order in ((f"{name}.csv", "xyzw"), ("w.csv", "wxyz")):
                found = self.run_tool("evaluate", file, "--robot", "./down")
                self.assertIn(f"quaternion {order}", found.stderr + found.stdout)


if __name__ == "__main__":
    unittest.main()
