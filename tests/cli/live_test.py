"""retarget live over loopback: players and receivers, files and pipes, recordings, faults."""

import json
import re
import signal
import socket
import subprocess
import time
import unittest

from tool import MEGABYTE, TOOL, ToolTest, difference, is_sanitized, read_rows, sample, short_clip, unwrapped


class LiveTest(ToolTest):
    """A test that may leave a live run behind; it is ended then."""

    def start(self, *arguments):
        process = subprocess.Popen([TOOL, "live", *map(str, arguments)], cwd=self.folder, text=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def listen(self, *arguments, transport="udp", extras=""):
        """A live run of the G1 that listens, and its port."""
        process = self.start("--robot", "unitree_g1", "--input", f"{transport}:0{extras}", *arguments)
        for line in process.stderr:
            found = re.search(r"listening at \w+:127\.0\.0\.1:(\d+)", line)
            if found:
                return process, int(found.group(1))
        self.fail("nobody listens")
        return None

    def end(self, process):
        """What it printed, after Ctrl-C."""
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, err)
        return out, unwrapped(err)

    def played(self, form, clip="wave", speed=0):
        """A sample as a player sends it."""
        result = self.run_tool("live", "--play", sample(clip), "--to", f"stdout?format={form}",
                               "--speed", speed)
        self.assert_done(result)
        return result.stdout

    def live(self, text, *arguments):
        """What a live run makes of standard input."""
        self.write("input.txt", text)
        with open(self.folder / "input.txt") as stream:
            return self.run_tool("live", "--robot", "unitree_g1", *arguments, stdin=stream)


class Pipes(LiveTest):
    def test_plain_frames_are_those_of_the_published_method(self):
        rows = self.played("bvh", "walk")
        offline = self.retarget("--method", "gmr", "--fps", "source", "--lead-in", "keep", bvh=sample("walk"))
        self.assert_done(offline)
        result = self.live(rows, "--input", "stdin?format=bvh&fps=30", "--skeleton", sample("walk"),
                           "--method", "gmr", "--plain", "--fps", "30", "-o", "live.csv")
        self.assert_done(result)
        found = read_rows((self.folder / "live.csv").read_text())
        expected = read_rows((self.folder / "out.csv").read_text())
        self.assertIsNone(difference(found, expected, 1e-9))

    def test_lines_carry_their_skeleton(self):
        result = self.live(self.played("lines"), "--mode", "lag", "--lag", "0.1")
        self.assert_done(result)
        lines = [json.loads(line) for line in result.stdout.splitlines()]
        self.assertEqual(lines[0]["robot"], "unitree_g1")
        self.assertEqual(len(lines[0]["joints"]), 29)
        frames = lines[1:]
        self.assertEqual([frame["frame"] for frame in frames], list(range(len(frames))))
        self.assertEqual({frame["state"] for frame in frames}, {"following"})
        self.assertAlmostEqual(frames[10]["time"] - frames[9]["time"], 0.02, places=9)
        self.assertEqual(len(frames[0]["joints"]), 29)

    def test_malformed_lines_are_counted_and_told_once(self):
        text = self.played("lines").splitlines()
        for place in (5, 50, 100):
            text.insert(place, '{"time": 1, "joints": \x1b[31m')
        result = self.live("\n".join(text) + "\n")
        self.assert_done(result)
        self.assertIn("3 malformed", result.stderr)
        self.assertEqual(result.stderr.count("a packet is left out"), 1)
        self.assertNotIn("\x1b[31m", result.printed)

    def test_usage(self):
        self.assertIn("bvh", self.run_tool("live", "--list").stdout)
        self.assert_fails(self.run_tool("live"), 2, "robot")
        g1 = ("live", "--robot", "unitree_g1")
        self.assert_fails(self.run_tool(*g1, "--input", "udp:x"), 2, "port")
        self.assert_fails(self.run_tool(*g1, "--input", "udp:0?format=bhv"), 2, "bvh")
        self.assert_fails(self.run_tool(*g1, "-o", "no/where.csv"), 2, "no")
        self.assert_fails(self.run_tool(*g1, "--mode", "lag", "--method", "gmr", "--skeleton", sample("walk")), 2,
                          "gmr")
        self.assert_fails(self.run_tool(*g1, "--replay", "nothing"), 4, "live.json")
        self.assert_fails(self.run_tool("live", "--play", "none.bvh"), 3, "none.bvh")

    def test_memory_does_not_grow_with_a_stream(self):
        rows = sample("walk").read_text().split("Frame Time:")[1].splitlines()[1:]
        there_and_back = rows + rows[-2:0:-1]
        peaks = []
        for seconds in (20, 160):
            frames = 50 * seconds
            # row by row: a child is taken for as large as its parent was
            with open(self.folder / "rows.txt", "w") as stream:
                for frame in range(frames):
                    stream.write(there_and_back[frame % len(there_and_back)] + "\n")
            with open(self.folder / "rows.txt") as stream:
                result = self.run_measured("live", "-q", "--robot", "unitree_g1", "--input",
                                           "stdin?format=bvh&fps=50", "--skeleton", sample("walk"), "--mode", "lag",
                                           "-o", "live.csv", seconds=240, stdin=stream)
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(self.folder / "live.csv") as written:
                self.assertEqual(sum(1 for _ in written), frames)
            peaks.append(result.peak)
        if not is_sanitized():
            self.assertLess(peaks[1] - peaks[0], 4 * MEGABYTE, peaks)

    def test_a_stream_without_frames_is_no_error(self):
        result = self.live("")
        self.assert_done(result)
        self.assertIn("0 frames", result.stderr)


class Sockets(LiveTest):
    def test_player_and_receiver_over_udp(self):
        taken = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(taken.close)
        taken.bind(("127.0.0.1", 0))
        taken.settimeout(30)
        process, port = self.listen("-o", f"udp:{taken.getsockname()[1]}", "-o", "live.csv",
                                    extras="?format=bvh")
        self.write("short.bvh", short_clip("walk", 120))
        player = self.run_tool("live", "--play", "short.bvh", "--to", f"udp:{port}?format=bvh")
        self.assert_done(player)
        self.assertIn("120 of 120 frames", player.stderr)
        self.assertIn("unitree_g1", json.loads(taken.recv(65536))["robot"])
        frame = json.loads(taken.recv(65536))
        self.assertEqual(frame["frame"], 0)
        _, messages = self.end(process)
        self.assertRegex(messages, r"packets +\d+, 0 malformed")
        self.assertRegex(messages, r"latency .*p99 [\d.]+ ms")
        self.assertGreater(len(read_rows((self.folder / "live.csv").read_text())), 80)

    def test_a_connection_after_another(self):
        process, port = self.listen("-o", "live.csv", transport="tcp")
        text = self.played("lines")
        for _ in range(2):
            with socket.create_connection(("127.0.0.1", port)) as connection:
                connection.sendall(text.encode())
            time.sleep(0.3)
        _, messages = self.end(process)
        self.assertIn("0 malformed", messages)

    def test_binds_to_this_machine_alone(self):
        _, port = self.listen()
        with open("/proc/net/udp") as table:
            places = [line.split()[1] for line in table if f":{port:04X} " in line]
        self.assertEqual(places, [f"0100007F:{port:04X}"])

    def test_a_port_that_is_taken(self):
        _, port = self.listen()
        self.assert_fails(self.run_tool("live", "--robot", "unitree_g1", "--input", f"udp:{port}"), 1,
                          "port cannot be had")

    def test_a_recording_gives_the_same_bytes_again(self):
        process, port = self.listen("--record", "kept", "--mode", "lag", "--lag", "0.1",
                                    "--skeleton", sample("walk"), "-o", "live.csv", extras="?format=bvh")
        self.write("short.bvh", short_clip("walk", 90))
        self.assert_done(self.run_tool("live", "--play", "short.bvh", "--to", f"udp:{port}?format=bvh"))
        time.sleep(0.5)  # the stream is held meanwhile
        self.end(process)
        (self.folder / "elsewhere").mkdir()
        (self.folder / "kept").rename(self.folder / "elsewhere/kept")
        replay = self.run_tool("live", "--replay", "elsewhere/kept", "-o", "again.csv", "-o", "again.jsonl")
        self.assert_done(replay)
        self.assertEqual((self.folder / "again.csv").read_bytes(), (self.folder / "live.csv").read_bytes())
        self.assertEqual((self.folder / "again.jsonl").read_bytes(),
                         (self.folder / "elsewhere/kept/output.jsonl").read_bytes())
        self.assertIn('"holding"', (self.folder / "again.jsonl").read_text())

    def test_ends_by_itself(self):
        started = time.monotonic()
        process, _ = self.listen("--seconds", "0.5")
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 0)
        self.assertLess(time.monotonic() - started, 20)


if __name__ == "__main__":
    unittest.main()
