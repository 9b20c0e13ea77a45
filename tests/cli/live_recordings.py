"""Recordings of live runs that are replayed as if their packets had arrived on time."""

import io
import json

from live_test import LiveTest


class RecordingTest(LiveTest):
    def regular_times(self, recording):
        """Rewrites the arrival times of a recording to those of a network without delays; the sender runs at 30 fps."""
        file = self.folder / recording / "input.stream"
        recorded, events, frames = io.BytesIO(file.read_bytes()), [], 0
        while line := recorded.readline():
            letter, _, size = line.decode().split()
            data = recorded.read(int(size))
            recorded.read(1)
            if letter in "SP":
                events.append(b"%s %d %d\n%s\n" % (letter.encode(), round(frames * 1e6 / 30), len(data), data))
                # A packet of the lines' skeleton arrives with the first frame.
                frames += letter == "P" and b"skeleton" not in data
        events.append(b"E %d 0\n\n" % round((frames + 3) * 1e6 / 30))
        file.write_bytes(b"".join(events))
        return frames

    def followed(self, name):
        """Returns the robot frames of a file that follow the human at times of 30 fps, by their numbers."""
        frames = [json.loads(line) for line in (self.folder / name).read_text().splitlines()[1:]]
        return {round(30 * frame["time"]): frame for frame in frames if frame["state"] == "following"
                and abs(30 * frame["time"] - round(30 * frame["time"])) < 1e-4}
