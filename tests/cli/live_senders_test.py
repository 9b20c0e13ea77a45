"""retarget live: permitted senders. Strangers change nothing for the sender; addresses that cannot be are refused."""

import contextlib
import json
import re
import signal
import socket
import threading
import time
import unittest

from live_test import LiveTest, free_port
from tool import sample

SILENCE = 1.3  # seconds after which the next one is the sender


class SendersTest(LiveTest):
    def setUp(self):
        super().setUp()
        self.lines = [line.encode() + b"\n" for line in self.played("lines", "walk").splitlines()]

    @contextlib.contextmanager
    def sender(self, host="127.0.0.1", port=0):
        """Returns a UDP socket with a separate address."""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as made:
            made.bind((host, port))
            yield made

    def send(self, sender, port, lines):
        for line in lines:
            sender.sendto(line, ("127.0.0.1", port))
            time.sleep(0.01)

    def packets(self, process):
        """Ends a run, also a stopped one; returns the number of packets, that of malformed ones, and the messages."""
        _, messages = self.end(process)
        found = re.search(r"packets +(\d+), (\d+) malformed", messages)
        return int(found[1]), int(found[2]), messages


class Connections(SendersTest):
    def connect(self, port):
        connection = socket.create_connection(("127.0.0.1", port))
        self.addCleanup(connection.close)
        return connection

    def test_other_senders_do_not_displace_the_sender(self):
        process, port = self.listen("-o", "live.csv", transport="tcp")
        sender = self.connect(port)
        for i, line in enumerate(self.lines[:120]):
            sender.sendall(line)
            if i % 20 == 10:
                self.connect(port).close()
            if i == 30:
                self.connect(port)
            if i == 40:
                self.connect(port).sendall(b"GET / HTTP/1.0\r\n\r\n")
            time.sleep(0.01)
        taken, malformed, messages = self.packets(process)
        self.assertEqual((taken, malformed), (120, 0), messages)
        self.assertEqual(messages.count("ignoring 127.0.0.1:"), 1, messages)

    def test_many_strangers(self):
        process, port = self.listen("-o", "live.csv", transport="tcp")
        sender = self.connect(port)
        sender.sendall(self.lines[0])
        # While the program is stopped, a sender on a busy machine is not silent for a second.
        process.send_signal(signal.SIGSTOP)
        for line in self.lines[1:40]:
            self.connect(port).sendall(b"{}\n")
            sender.sendall(line)
        self.assertEqual(self.packets(process)[:2], (40, 0))

    def test_connects_at_once_while_the_receiver_is_busy(self):
        process, port = self.listen("-o", "live.csv", transport="tcp")
        process.send_signal(signal.SIGSTOP)
        self.addCleanup(process.send_signal, signal.SIGCONT)
        # The system retries a refused connection after a second.
        for _ in range(40):
            connection = socket.create_connection(("127.0.0.1", port), timeout=0.7)
            self.addCleanup(connection.close)
        process.send_signal(signal.SIGCONT)
        self.end(process)

    def test_next_sender_replaces_one_that_ends(self):
        process, port = self.listen("-o", "live.csv", transport="tcp")
        first, second = self.connect(port), None
        first.sendall(b"".join(self.lines[:60]))
        second = self.connect(port)
        second.sendall(b"".join(self.lines[:50]))
        first.sendall(self.lines[60])
        first.close()
        self.assertEqual(self.packets(process)[:2], (111, 0))

    def test_paused_sender_is_accepted_again(self):
        process, port = self.listen("-o", "live.csv", transport="tcp")
        sender = self.connect(port)
        sender.sendall(b"".join(self.lines[:60]))
        self.wait_until_read(port, "tcp")
        time.sleep(SILENCE)
        # A silent connection does not become the sender.
        self.connect(port)
        self.wait_until_read(port, "tcp")
        sender.sendall(b"".join(self.lines[60:80]))
        self.wait_until_read(port, "tcp")
        time.sleep(SILENCE)
        with socket.create_connection(("127.0.0.1", port)) as other:
            other.sendall(b"".join(self.lines[:10]))
            self.wait_until_read(port, "tcp")
        sender.sendall(b"".join(self.lines[80:90]))
        self.assertEqual(self.packets(process)[:2], (100, 0))

    def test_forbidden_address(self):
        process, port = self.listen("-o", "live.csv", transport="tcp", extras="?from=127.0.0.2")
        with socket.create_connection(("127.0.0.1", port)) as other:
            other.sendall(self.lines[0])
            time.sleep(0.3)
            with self.assertRaises(OSError):
                for line in self.lines[1:20]:
                    other.sendall(line)
                    time.sleep(0.02)
        with socket.create_connection(("127.0.0.1", port), source_address=("127.0.0.2", 0)) as sender:
            sender.sendall(b"".join(self.lines[:30]))
        self.assertEqual(self.packets(process)[:2], (30, 0))


class Datagrams(SendersTest):
    def test_the_first_address_is_kept_while_it_sends(self):
        process, port = self.listen("-o", "live.csv")
        with self.sender() as first, self.sender() as other, self.sender("127.0.0.2") as far:
            self.send(first, port, self.lines[:5])
            for line in self.lines[5:60]:
                self.send(first, port, [line])
                other.sendto(b"{}\n", ("127.0.0.1", port))
                far.sendto(b"{}\n", ("127.0.0.1", port))
            # Once it is silent, the next sender is accepted.
            time.sleep(SILENCE)
            self.send(other, port, self.lines[60:70])
            self.send(first, port, [b"{}\n"])
        taken, malformed, messages = self.packets(process)
        self.assertEqual((taken, malformed), (70, 0), messages)
        self.assertEqual(messages.count("ignoring 127.0.0."), 1, messages)

    def test_another_machine_replaces_a_failed_one(self):
        process, port = self.listen("-o", "live.csv")
        with self.sender() as first, self.sender("127.0.0.2") as other:
            self.send(first, port, self.lines[:30])
            time.sleep(SILENCE)
            self.send(other, port, self.lines[:20])
        self.assertEqual(self.packets(process)[:2], (50, 0))

    def test_a_sender_that_restarts_is_read_with_its_own_skeleton(self):
        # The same joints, in metres: with the old body's unit, the robot would leap.
        header = json.loads(self.lines[0])
        header["skeleton"]["unit"] = 1
        restarted = [header, *map(json.loads, self.lines[1:])]
        for message in restarted:
            poses = message["joints"].values() if "joints" in message else (
                joint["rest"] for joint in message["skeleton"]["joints"])
            for pose in poses:
                pose[:3] = [0.01 * x for x in pose[:3]]
        process, port = self.listen("-o", "live.jsonl", "--stats", "stats.jsonl", "--record", "kept")
        with self.sender() as first, self.sender() as second:
            self.send(first, port, self.lines[:60])
            # Its predecessor has just ended, so its first lines are refused; they arrive at once, because a busy
            # machine may take a second for lines with pauses.
            text = [json.dumps(message).encode() + b"\n" for message in restarted]
            for line in text[:20]:
                second.sendto(line, ("127.0.0.1", port))
            self.wait_until_read(port)
            time.sleep(SILENCE)
            for line in text[60:160]:
                self.send(second, port, [line])
                time.sleep(0.02)
        taken, malformed, messages = self.packets(process)
        self.assertEqual((taken, malformed), (160, 0), messages)
        frames = [json.loads(line) for line in (self.folder / "live.jsonl").read_text().splitlines()[1:]]
        self.assertEqual(frames[-1]["state"], "following")
        self.assertLess(max(abs(x) for frame in frames for x in frame["root_position"][:2]), 5.0)
        stats = json.loads((self.folder / "stats.jsonl").read_text().splitlines()[-1])
        self.assertEqual((stats["dropped"]["foreign"], stats["skeletons"]["told"]), (0, 2))
        self.assert_done(self.run_tool("live", "--replay", "kept", "-o", "again.jsonl"))
        self.assertEqual((self.folder / "again.jsonl").read_bytes(), (self.folder / "live.jsonl").read_bytes())

    def test_frames_of_a_new_sender_wait_for_its_skeleton(self):
        process, port = self.listen("-o", "live.jsonl", "--stats", "stats.jsonl")
        with self.sender() as first, self.sender() as second:
            self.send(first, port, self.lines[:60])
            time.sleep(SILENCE)
            self.send(second, port, self.lines[60:90])
            time.sleep(SILENCE)
        taken, malformed, messages = self.packets(process)
        self.assertEqual((taken, malformed), (90, 0), messages)
        self.assertIn("a new sender, whose skeleton is missing", messages)
        stats = json.loads((self.folder / "stats.jsonl").read_text().splitlines()[-1])
        self.assertEqual((stats["dropped"]["foreign"], stats["received"]), (30, 59))

    def test_a_stalled_program_keeps_its_sender(self):
        process, port = self.listen("-o", "live.csv")
        with self.sender() as first, self.sender() as other:
            self.send(first, port, self.lines[:30])
            self.wait_until_read(port)
            process.send_signal(signal.SIGSTOP)
            other.sendto(b"{}\n", ("127.0.0.1", port))
            self.send(first, port, self.lines[30:60])
            time.sleep(SILENCE)
            process.send_signal(signal.SIGCONT)
            self.send(first, port, self.lines[60:70])
        self.assertEqual(self.packets(process)[:2], (70, 0))

    def test_a_port_for_every_datagram(self):
        process, port = self.listen("-o", "live.csv")
        for line in self.lines[:60]:
            with self.sender() as sender:
                self.send(sender, port, [line])
        self.assertEqual(self.packets(process)[:2], (60, 0))

    def test_two_programs_of_one_machine(self):
        process, port = self.listen("-o", "live.csv")
        with self.sender() as first, self.sender() as second:
            for line in self.lines[:40]:
                self.send(first, port, [line])
                self.send(second, port, [line])
        taken, malformed, messages = self.packets(process)
        # One of them, and the first one of the other.
        self.assertLessEqual(abs(taken - 41), 1, messages)
        self.assertEqual(malformed, 0, messages)

    def test_permitted_address(self):
        process, port = self.listen("-o", "live.csv", extras="?from=127.0.0.2")
        with self.sender() as other, self.sender("127.0.0.2") as sender:
            for line in self.lines[:30]:
                other.sendto(b"{}\n", ("127.0.0.1", port))
                self.send(sender, port, [line])
        self.assertEqual(self.packets(process)[:2], (30, 0))

    def test_an_address_with_a_port(self):
        own = free_port()
        process, port = self.listen("-o", "live.csv", extras=f"?from=127.0.0.1:{own}")
        with self.sender() as other, self.sender(port=own) as sender:
            for line in self.lines[:30]:
                other.sendto(b"{}\n", ("127.0.0.1", port))
                self.send(sender, port, [line])
        self.assertEqual(self.packets(process)[:2], (30, 0))

    def test_from_any_accepts_all_senders(self):
        process, port = self.listen("-o", "live.csv", extras="?from=any")
        with self.sender() as first, self.sender("127.0.0.2") as second:
            for line in self.lines[:20]:
                self.send(first, port, [line])
                self.send(second, port, [line])
        self.assertEqual(self.packets(process)[:2], (40, 0))


class Ends(SendersTest):
    """A program without CPU time reads its input late, also that before Ctrl-C."""

    def test_input_before_ctrl_c_is_read(self):
        for transport in ("udp", "tcp"):
            with self.subTest(transport):
                process, port = self.listen("-o", "live.csv", transport=transport)
                kind = socket.SOCK_DGRAM if transport == "udp" else socket.SOCK_STREAM
                with socket.socket(socket.AF_INET, kind) as sender:
                    sender.connect(("127.0.0.1", port))
                    process.send_signal(signal.SIGSTOP)
                    for line in self.lines[:20]:
                        sender.sendall(line)
                    self.assertEqual(self.packets(process)[:2], (20, 0))

    def test_ctrl_c_ends_a_run_while_its_sender_goes_on(self):
        process, port = self.listen("-o", "live.csv")
        with self.sender() as sender, contextlib.ExitStack() as stack:
            ended = threading.Event()

            def flood():
                while not ended.is_set():
                    sender.sendto(self.lines[1], ("127.0.0.1", port))
            thread = threading.Thread(target=flood)
            stack.callback(thread.join)
            stack.callback(ended.set)
            thread.start()
            self.packets(process)


class Usage(LiveTest):
    def refused(self, address, *messages):
        self.assert_fails(self.run_tool("live", "--robot", "unitree_g1", "--input", address), 2, *messages)

    def test_unknown_parts_of_an_input(self):
        self.refused("udp:0?format=bvh&fsp=30", "no option fsp=30", 'did you mean "fps"')
        self.refused("udp:0?format=vmd", 'unknown stream format "vmd" (did you mean "vmc"?)', "stream formats are")
        self.refused("udp:0?format=vmc&actor=2", "no option actor=2")
        self.refused("tcp:0?form=127.0.0.1", 'did you mean "from"')
        self.refused("stdin?format=bvh&from=127.0.0.1", "no option from")
        self.refused("tcp:0?format=natnet&multicast=239.255.42.99", "no option multicast")
        self.refused("motion.bvh", "udp:PORT")

    def test_values_of_an_input(self):
        self.refused("udp:0?format=bvh&fps=fast", "fps=")
        self.refused("udp:0?format=mvn&actor=Anna", "actor=")
        self.refused("udp:0?format=natnet&version=2.7", "version=")
        self.refused("udp:0?format=natnet&coordinates=world", "local or global")
        self.refused("udp:0?from=motive", "from=ADDRESS")
        self.refused("udp:0?from=127.0.0.1:0", "from=ADDRESS")

    def test_unknown_parts_of_outputs_and_of_a_player(self):
        g1 = ("live", "--robot", "unitree_g1", "--input", "udp:0", "-o")
        self.assert_fails(self.run_tool(*g1, "udp:9000?fromat=csv"), 2, 'did you mean "format"')
        self.assert_fails(self.run_tool(*g1, "live.csv?frames=5"), 2, "no option frames=5")
        player = self.run_tool("live", "--play", sample("walk"), "--to", "udp:9000?fps=30")
        self.assert_fails(player, 2, "no option fps=30")


if __name__ == "__main__":
    unittest.main()
