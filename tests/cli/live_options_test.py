"""retarget live: options that contradict each other or have no effect are refused before anything is opened."""

import json
import unittest

from live_test import LiveTest, free_port
from tool import SOURCE, difference, sample


class OptionsTest(LiveTest):
    def refused(self, *arguments, code=2, messages=()):
        """Runs a live run that must fail, with an output that it must not touch."""
        self.write("keep.csv", "kept\n")
        result = self.run_tool("live", "--robot", "unitree_g1", "-o", "keep.csv", *arguments)
        self.assert_fails(result, code, *messages)
        self.assertEqual((self.folder / "keep.csv").read_text(), "kept\n", arguments)


class Outputs(OptionsTest):
    def test_a_wrong_command_line_destroys_no_output(self):
        self.refused("--mode", "lag", "--method", "gmr", messages=["gmr", "--method"])
        self.refused("--input", "stdin?foo=1", messages=["foo=1"])
        self.refused("--input", "udp:0?format=bhv", messages=["bvh"])
        self.refused("--input", "udp:0?from=motive", messages=["from=ADDRESS"])
        self.refused("-o", "udp:door", messages=["port"])
        self.refused("-o", "again.csv?frames=5", messages=["no option frames=5"])
        self.refused("-o", "udp:9000?format=sonic", messages=["sonic"])
        self.refused("-o", "no/where.csv", messages=["no/where.csv"])
        self.refused("--stats", "no/where", messages=["no/where"])
        self.refused("--rest", "first", "--tpose-file", sample("walk"), messages=["--tpose-file"])
        self.refused("--skeleton", "none.bvh", code=3, messages=["none.bvh"])
        self.refused("--fit-config", "none.json", "--mode", "lag", code=4, messages=["none.json"])
        # A missing receiver.
        self.refused("-o", "tcp:9", code=1, messages=["start the receiver first"])

    def test_a_port_that_is_taken_destroys_no_output(self):
        _, port = self.listen()
        self.refused("--input", f"udp:{port}", code=1, messages=["cannot bind the port"])

    def test_a_recording_is_not_overwritten(self):
        self.assert_done(self.live(self.played("lines"), "--record", "take", "-o", "live.csv"))
        before = {file.name: file.read_bytes() for file in (self.folder / "take").iterdir()}
        self.refused("--record", "take", "--fps", "100", messages=["already contains a recording"])
        after = {file.name: file.read_bytes() for file in (self.folder / "take").iterdir()}
        self.assertEqual(before, after)

    def test_a_missing_file_is_named_at_the_start(self):
        self.refused("--map", "nope", code=4, messages=["nope"])
        self.write("map.json", '{"hips": "Hips"}')
        self.refused("--map", "map.json", code=4, messages=["map.json", 'no bone "hips"'])
        self.refused("--tpose-file", "nope.bvh", code=4, messages=["nope.bvh"])


class Robots(LiveTest):
    def test_a_model_needs_a_configuration_as_in_a_run(self):
        model = self.write("unitree_g1.xml", (SOURCE / "robots/unitree_g1/model.xml").read_text())
        needs = "--robot-xml has no retargeting configuration"
        self.assert_fails(self.run_tool(sample("walk"), "--robot-xml", model, "-o", "x.csv"), 2, needs)
        self.assert_fails(self.run_tool("live", "--robot-xml", model, "-o", "x.csv"), 2, needs)
        self.assertEqual(self.files(), ["unitree_g1.xml"])


class Effects(OptionsTest):
    def test_options_of_the_other_mode(self):
        self.write("weights.json", '{"hand_position": 2, "max_joint_speed": 5}')
        self.write("limits.json", '{"max_joint_speed": 5, "contact_speed": 0.2}')
        self.refused("--lag", "0.2", messages=["--lag requires --mode lag"])
        self.refused("--mode", "frame", "--lag", "0.1", messages=["--lag requires --mode lag"])
        self.refused("--without", "floor", messages=["--without requires --mode lag"])
        self.refused("--fit-config", "weights.json", messages=["hand_position", "--mode lag"])
        for arguments in (("--mode", "lag", "--lag", "0.1", "--without", "floor"), ("--mode", "lag"),
                          ("--mode", "lag", "--fit-config", "weights.json"), ("--fit-config", "limits.json"),
                          ("--mode", "lag", "--plain")):
            self.assert_done(self.live("", *arguments, "-o", "live.csv"))

    def test_limits_of_the_fit_apply_to_single_frames(self):
        self.write("limits.json", '{"max_joint_speed": 0.5}')
        for arguments in ((), ("--fit-config", "limits.json")):
            self.assert_done(self.live(self.played("lines"), *arguments, "-o", f"{len(arguments)}.csv"))
        self.assertNotEqual((self.folder / "0.csv").read_bytes(), (self.folder / "2.csv").read_bytes())

    def test_calibration_after_a_time(self):
        self.refused("--after", "3", messages=["--after requires --calibrate"])
        self.assert_done(self.live("", "--calibrate", "tpose", "--after", "3", "-o", "live.csv"))

    def test_options_of_a_player(self):
        self.refused("--to", "stdout", messages=["--to", "require --play"])
        self.refused("--speed", "1", messages=["--speed require --play"])
        player = ("live", "--play", sample("wave"), "--to", "stdout")
        self.assert_fails(self.run_tool(*player, "--robot", "unitree_g1", "-o", "live.csv"), 2, "--robot", "--output")
        self.assertFalse((self.folder / "live.csv").exists())
        self.assert_done(self.run_tool(*player, "--speed", "0", "--up", "y", "--height", "1.7"))

    def test_options_of_a_recording(self):
        self.assert_done(self.live(self.played("lines"), "--record", "take", "--fps", "30", "-o", "live.csv"))

        def replayed(*arguments):
            return self.run_tool("live", "--replay", "take", "-o", "again.csv", *arguments)

        for arguments in (("--robot", "unitree_g1"), ("--robot", "nosuch"), ("--fps", "50"), ("--mode", "frame"),
                          ("--seconds", "1"), ("--silent", "1"), ("--stats", "-"), ("--input", "stdin"), ("--plain",)):
            self.assert_fails(replayed(*arguments), 2, "--replay", "omit " + arguments[0])
        self.assertFalse((self.folder / "again.csv").exists())
        self.assert_done(replayed())
        self.assertEqual((self.folder / "again.csv").read_bytes(), (self.folder / "live.csv").read_bytes())

    def test_packets_do_not_fit_into_pipes(self):
        self.refused("--input", "stdin?format=vmc", messages=["vmc needs packets", "udp:39539"])
        player = self.run_tool("live", "--play", sample("wave"), "--to", "stdout?format=vmc")
        self.assert_fails(player, 2, "vmc needs packets", "udp:39539")


class Pipes(OptionsTest):
    def frames(self, text, *arguments):
        result = self.live(text, *arguments)
        self.assert_done(result)
        return [json.loads(line) for line in result.stdout.splitlines()[1:]], result.stderr

    def test_frames_of_a_file_have_the_times_of_the_file(self):
        played, _ = self.frames(self.played("lines", "walk"))
        self.assertEqual(len(played), 501)
        for i, frame in enumerate(played):
            self.assertAlmostEqual(frame["time"], 0.02 * i, places=6)
        # The whole file, not a stream of a player.
        for address in ("stdin?format=bvh", "stdin?format=bvh&fps=30"):
            found, messages = self.frames(sample("walk").read_text(), "--input", address)
            self.assertIsNone(difference([frame["joints"] for frame in found],
                                         [frame["joints"] for frame in played], 1e-6))
            self.assertNotIn("no timestamps", messages)

    def test_a_pipe_without_a_usable_frame_is_an_error(self):
        walk = sample("walk").read_text()
        rows = walk.count("\n")
        for text, address, messages in (
                (walk, "stdin", [f"{rows} of {rows} packets malformed", "looks like bvh: use stdin?format=bvh"]),
                (self.played("rokoko", "walk"), "stdin", ["looks like rokoko: use stdin?format=rokoko"]),
                (self.played("lines", "walk"), "stdin?format=bvh", ["looks like lines: use stdin?format=lines"]),
                (self.played("smplx", "walk"), "stdin?format=xrobot", ["looks like smplx: use stdin?format=smplx"])):
            result = self.live(text, "--input", address, "-o", "live.csv")
            self.assert_fails(result, 3, "no frame of the stream is usable", *messages)

    def test_a_pipe_that_ends_too_early_names_what_is_missing(self):
        walk = sample("walk").read_text()
        for text, message in ((walk[:300], "the skeleton is incomplete: its line MOTION is missing"),
                              (walk[:walk.index("Frame Time:")], "the skeleton has no rows")):
            result = self.live(text, "--input", "stdin?format=bvh", "-o", "live.csv")
            self.assert_fails(result, 3, message)

    def test_a_pipe_may_end_before_the_first_robot_frame(self):
        """In lag mode at clock pace, frames leave only after the window has filled."""
        short = "".join(self.played("lines", "walk").splitlines(keepends=True)[:10])
        for arguments in (("--mode", "lag", "--lag", "1"), ("--mode", "frame")):
            result = self.live(short, *arguments, "-o", f"udp:{free_port()}")
            self.assert_done(result)
        result = self.live("{}\n" * 10, "--mode", "lag", "-o", f"udp:{free_port()}")
        self.assert_fails(result, 3, "no frame of the stream is usable")

    def test_frames_without_any_times(self):
        lines = []
        for line in self.played("lines", "walk").splitlines():
            frame = json.loads(line)
            frame.pop("time", None)
            lines.append(json.dumps(frame))
        _, messages = self.frames("\n".join(lines) + "\n")
        self.assertIn("no timestamps", messages)
        self.assertIn("frames 0 lost", messages)

    def test_a_skeleton_file_may_have_other_axes_than_the_stream(self):
        lines = []
        for line in self.played("lines", "walk").splitlines():
            message = json.loads(line)
            if "skeleton" in message:
                message["skeleton"] |= {"unit": 1, "up": "z"}
                for joint in message["skeleton"]["joints"]:
                    joint["rest"] = in_metres_z_up(joint["rest"])
            else:
                message["joints"] = {name: in_metres_z_up(pose) for name, pose in message["joints"].items()}
            lines.append(json.dumps(message))
        text = "\n".join(lines) + "\n"
        expected, _ = self.frames(text, "--height", "1.75")
        found, _ = self.frames(text, "--height", "1.75", "--skeleton", sample("walk"))
        self.assertEqual(len(found), len(expected))
        for place in (0, 250, 500):
            self.assertAlmostEqual(found[place]["root_position"][2], expected[place]["root_position"][2], delta=0.02)
            for a, b in zip(found[place]["joints"], expected[place]["joints"]):
                self.assertAlmostEqual(a, b, delta=0.02)


def in_metres_z_up(pose):
    """Converts a pose from a Y-up world in centimetres; joint axes do not change."""
    x, y, z, w, qx, qy, qz = pose
    # The rotation that maps y to z, z to x and x to y: (0.5, 0.5, 0.5, 0.5).
    turned = [0.5 * (w - qx - qy - qz), 0.5 * (w + qx + qz - qy), 0.5 * (w + qy + qx - qz), 0.5 * (w + qz + qy - qx)]
    return [0.01 * z, 0.01 * x, 0.01 * y, *turned]


if __name__ == "__main__":
    unittest.main()
