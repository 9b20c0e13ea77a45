"""`retarget view`: a strip of poses as SVG or PNG."""

import shutil
import struct
import unittest
import xml.etree.ElementTree as xml
import zlib

import numpy as np

import noise
from tool import SOURCE, ToolTest, sample, short_clip

SVG = "{http://www.w3.org/2000/svg}"


def pixels(png):
    """Width, height and the filtered rows of a PNG, checked: the same for the same pixels."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, size = 8, b"", (0, 0)
    while at < len(png):
        length, kind = struct.unpack_from(">I4s", png, at)
        content = png[at + 8:at + 8 + length]
        assert zlib.crc32(kind + content) == struct.unpack_from(">I", png, at + 8 + length)[0]
        if kind == b"IHDR":
            size = struct.unpack_from(">II", content)
        packed += content if kind == b"IDAT" else b""
        at += 12 + length
    rows = zlib.decompress(packed)
    assert len(rows) == size[1] * (3 * size[0] + 1)
    return *size, rows


class View(ToolTest):
    def motion(self, name="walk.csv", clip=None, robot="unitree_g1"):
        self.assert_done(self.retarget("--method", "gmr", robot=robot, output=name,
                                       bvh=clip or self.write("walk.bvh", short_clip("walk", 61))))
        return self.folder / name

    def strip(self, motion, *options, robot="unitree_g1", output="strip.svg"):
        result = self.run_tool("view", motion, "--robot", robot, "-o", output, *options)
        self.assert_done(result)
        return (self.folder / output).read_bytes()

    def poses(self, svg):
        """Returns the times below the poses; fails for malformed XML."""
        return [text.text for text in xml.fromstring(svg).iter(SVG + "text")]

    def shapes(self, svg):
        return len(list(xml.fromstring(svg).iter(SVG + "path")))

    def test_poses_from_the_first_frame_to_the_last(self):
        motion = self.motion()
        self.assertEqual(self.poses(self.strip(motion, "--strip", 5)),
                         ["0 s", "0.5 s", "1 s", "1.5 s", "2 s"])
        self.assertEqual(len(self.poses(self.strip(motion))), 6)
        # There are no more poses than frames.
        self.assertEqual(len(self.poses(self.strip(motion, "--strip", 100))), 61)

    def test_the_human_is_above_the_robot(self):
        motion = self.motion()
        alone = self.strip(motion, "--strip", 3)
        both = self.strip(motion, "--strip", 3, "--bvh", "walk.bvh")
        # 19 bones, and a head, three times with an outline; a floor.
        self.assertGreater(self.shapes(both), self.shapes(alone) + 3 * 2 * 15)
        self.assertEqual(self.poses(both), self.poses(alone))

    def test_the_source_is_read_as_in_the_run(self):
        clip = noise.Motion(self.write("walk.bvh", short_clip("walk", 61)))
        motion = self.motion(clip="walk.bvh")
        self.write("names.txt", "".join(f"{joint['name']}\n" for joint in clip.joints))
        self.write("points.npy", noise.npy(noise.keypoints(clip)))
        alone = self.strip(motion)
        points = ("--bvh", "points.npy", "--joint-names", "names.txt", "--source-fps")
        both = self.strip(motion, *points, 30)
        self.assertGreater(self.shapes(both), self.shapes(alone) + 6 * 2 * 15)
        # The rate is that of the source, not that of the motion.
        slower = self.strip(motion, *points, 15, output="slower.svg")
        self.assertEqual(self.poses(slower), self.poses(both))
        self.assertNotEqual(slower, both)
        self.strip(motion, *points, 30, output="page.html")
        # A BVH has no takes, but the option is known.
        view = ("view", motion, "--robot", "unitree_g1", "-o", "s.svg", "--bvh", "walk.bvh")
        for option in (("--take", "9"), ("--root", "x"), ("--lenient",)):
            self.assertNotIn("unknown option", self.run_tool(*view, *option).stderr)

    def test_same_bytes_every_time_and_on_standard_output(self):
        motion = self.motion()
        first = self.strip(motion, "--bvh", "walk.bvh")
        self.assertEqual(first, self.strip(motion, "--bvh", "walk.bvh", output="again.svg"))
        printed = self.run_tool("view", motion, "--robot", "unitree_g1", "--bvh", "walk.bvh", "-o", "-")
        self.assertEqual(first.decode(), printed.stdout)

    def test_names_do_not_break_the_file(self):
        motion = self.motion("a<b> & \"c\".csv")
        title = next(xml.fromstring(self.strip(motion)).iter(SVG + "title"))
        self.assertEqual(title.text, "a<b> & \"c\".csv, unitree_g1")

    def test_a_robot_without_shapes_and_another_rate(self):
        model = (SOURCE / "robots/unitree_g1/model.xml").read_text()
        bare = self.write("bare.xml", model.replace('<geom type="capsule"',
                                                    '<geom contype="0" conaffinity="0" type="capsule"'))
        motion = self.motion()
        result = self.run_tool("view", motion, "--robot-xml", bare, "--source-fps", 60, "-o", "s.svg")
        self.assert_done(result)
        svg = (self.folder / "s.svg").read_bytes()
        self.assertEqual(self.poses(svg)[-1], "1 s")
        self.assertGreater(self.shapes(svg), 6 * 20)

    def test_the_extension_selects_the_image_format(self):
        motion = self.motion()
        width, height, _ = pixels(self.strip(motion, output="strip.png"))
        self.assertAlmostEqual(width, 1200, delta=1)
        both = pixels(self.strip(motion, "--bvh", "walk.bvh", output="both.PNG"))
        self.assertGreater(both[1], 1.5 * height)
        again = self.strip(motion, "--bvh", "walk.bvh", output="again.png")
        self.assertEqual((self.folder / "both.PNG").read_bytes(), again)
        few = pixels(self.strip(motion, "--strip", 2, output="few.png"))
        self.assertLess(few[0], width)
        # A strip and a picture in one call.
        self.strip(motion, "--png", "beside.png", "--strip", 2)
        self.assertEqual(pixels((self.folder / "beside.png").read_bytes()), few)
        view = ("view", motion, "--robot", "g1", "-o", "s.svg", "--png")
        self.assert_fails(self.run_tool(*view, "no/x.png"), 2, "no")
        self.assert_fails(self.run_tool(*view, "s.svg"), 2, "s.svg")

    def test_other_extensions_are_rejected(self):
        motion = self.motion()
        for name in ("v.pdf", "v.csv", "v.jpg", "v.bvh"):
            self.assert_fails(self.run_tool("view", motion, "--robot", "g1", "-o", name), 2,
                              "which is a page or a picture", "use one of .html, .htm, .png, .svg")
        view = ("view", motion, "--robot", "g1", "-o", "s.svg", "--png", "s.jpg")
        self.assert_fails(self.run_tool(*view), 2, "in the format PNG")
        self.assertTrue(self.strip(motion, output="strip").startswith(b"<svg"))

    def test_a_run_renders_its_motion(self):
        shutil.copy(sample("walk"), self.folder / "walk.bvh")
        run = ("walk.bvh", "unitree_g1", "-o", "walk.csv", "--method", "gmr", "--png", "run.png")
        self.assert_done(self.run_tool(*run))
        own = self.strip("walk.csv", "--bvh", "walk.bvh", output="view.png")
        drawn, again = pixels((self.folder / "run.png").read_bytes()), pixels(own)
        self.assertEqual(drawn[:2], again[:2])
        # The file has six digits, which may decide about a pixel at an edge.
        same = np.frombuffer(drawn[2], np.uint8) == np.frombuffer(again[2], np.uint8)
        self.assertGreater(same.mean(), 0.999)
        self.assert_done(self.run_tool(*run, "--strip", 3, "--normalize-start"))
        few = self.strip("walk.csv", "--bvh", "walk.bvh", "--strip", 3, output="few.png")
        # The six digits may also decide about the last row or column.
        drawn = pixels((self.folder / "run.png").read_bytes())
        for found, expected in zip(drawn[:2], pixels(few)[:2]):
            self.assertLessEqual(abs(found - expected), 1)
        # Nothing is written if any output cannot be written.
        for file in ("run.png", "walk.csv"):
            (self.folder / file).unlink()
        for arguments, words in (
            (("--strip", 3), "--strip needs a PNG"),
            (("--png", "-"), "--png needs a file"),
            (("--png", "no/x.png"), "no"),
            (("--png", "walk.bvh"), "overwrite the input"),
            (("--png", "walk.csv"), "two outputs"),
        ):
            self.assert_fails(self.run_tool(*run[:6], *arguments), 2, words)
            self.assertFalse((self.folder / "walk.csv").exists())
        self.assert_fails(self.run_tool("batch", "walk.bvh", "-o", "out", "--png", "x.png"), 2, "--png")

    def test_faults_are_explained(self):
        motion = self.motion()
        view = ("view", motion, "--robot", "unitree_g1")
        self.assert_fails(self.run_tool(*view), 2, "--output")
        self.assert_fails(self.run_tool(*view, "-o", "s.svg", "--strip", 0), 2, "--strip")
        self.assert_fails(self.run_tool(*view, "-o", motion), 2, "walk.csv")
        self.assert_fails(self.run_tool(*view, "-o", "no/s.svg"), 2, "no")
        self.assert_fails(self.run_tool(*view, "-o", "s.svg", "--start", 1), 2, "--bvh")
        self.assert_fails(self.run_tool("view", motion, "-o", "s.svg"), 2, "--robot")
        self.assert_fails(self.run_tool("view", "no.csv", "--robot", "g1", "-o", "s.svg"), 3, "no.csv")

    def test_the_readme_image_is_up_to_date(self):
        shutil.copy(sample("walk"), self.folder / "walk.bvh")
        self.assert_done(self.retarget(bvh="walk.bvh", output="walk.csv"))
        self.assertEqual(
            self.strip("walk.csv", "--bvh", "walk.bvh", "--strip", 9, "--start", 0),
            (SOURCE / "docs/pictures/walk_strip.svg").read_bytes(),
            "draw it again: retarget data/walk.bvh g1 -o walk.csv && retarget view walk.csv "
            "--robot g1 --bvh data/walk.bvh --strip 9 -o docs/pictures/walk_strip.svg")

    def test_the_picture_of_the_readme_as_well(self):
        shutil.copy(sample("walk"), self.folder / "walk.bvh")
        self.assert_done(self.retarget(bvh="walk.bvh", output="walk.csv"))
        # Compare pixels, because versions of zlib compress them differently.
        self.assertTrue(
            pixels(self.strip("walk.csv", "--bvh", "walk.bvh", "--strip", 9, output="s.png"))
            == pixels((SOURCE / "docs/pictures/walk_strip.png").read_bytes()),
            "draw it again: retarget data/walk.bvh g1 -o walk.csv && retarget view walk.csv "
            "--robot g1 --bvh data/walk.bvh --strip 9 -o docs/pictures/walk_strip.png")


if __name__ == "__main__":
    unittest.main()
