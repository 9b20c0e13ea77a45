"""Headless Chromium, driven over the DevTools protocol with only the standard library."""

import base64
import fcntl
import itertools
import json
import os
import pathlib
import select
import shutil
import subprocess
import tempfile
import time

# Run WebGL on the processor, so that pictures do not depend on a graphics card.
FLAGS = [
    "--headless=new",
    "--remote-debugging-pipe",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--mute-audio",
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--force-color-profile=srgb",
    "--font-render-hinting=none",
]


def chromium():
    """Returns the path of the browser; None if it is missing."""
    names = [os.environ.get("CHROMIUM"), "chromium", "chromium-browser", "google-chrome"]
    return next((found for name in names if name and (found := shutil.which(name))), None)


class Browser:
    """One browser with one page at a time. Use as a context."""

    def __init__(self, program, width=1280, height=720):
        self.folder = tempfile.mkdtemp(prefix="retarget_browser_")
        self.size = (width, height)
        to_child, own_write = (fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 20) for end in os.pipe())
        own_read, from_child = (fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 20) for end in os.pipe())

        def place_pipes():
            os.dup2(to_child, 3)
            os.dup2(from_child, 4)

        sandbox = ["--no-sandbox"] if os.geteuid() == 0 else []
        self.process = subprocess.Popen(
            [
                program,
                *FLAGS,
                *sandbox,
                f"--user-data-dir={self.folder}",
                f"--window-size={width},{height}",
                "about:blank",
            ],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "HOME": self.folder},
            preexec_fn=place_pipes,
            pass_fds=(3, 4),
        )
        os.close(to_child)
        os.close(from_child)
        self.write_end, self.read_end = own_write, own_read
        self.numbers = itertools.count(1)
        self.buffer = b""
        self.session = None
        self.events = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        try:
            self.send("Browser.close", browser=True, wait=5)
        except (OSError, TimeoutError, RuntimeError):
            pass
        for end in (self.write_end, self.read_end):
            os.close(end)
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    # --- the protocol ------------------------------------------------------------------------

    def receive(self, deadline):
        """The next message."""
        while b"\0" not in self.buffer:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.read_end], [], [], left)[0]:
                raise TimeoutError("the browser does not answer")
            block = os.read(self.read_end, 1 << 20)
            if not block:
                raise RuntimeError("the browser has ended")
            self.buffer += block
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def send(self, method, params=None, browser=False, wait=60.0):
        """Calls a protocol method and returns its result. Keeps events that arrive meanwhile."""
        number = next(self.numbers)
        message = {"id": number, "method": method, "params": params or {}}
        if self.session and not browser:
            message["sessionId"] = self.session
        os.write(self.write_end, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + wait
        while True:
            answer = self.receive(deadline)
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    # --- pages -------------------------------------------------------------------------------

    def open(self, path, fragment="", size=None, features=None):
        """Opens a file in a new page and waits until it is loaded.

        features: media features by name, such as prefers-color-scheme.
        """
        if self.session:
            self.send("Target.closeTarget", {"targetId": self.target}, browser=True)
            self.session = None
        self.events = []
        self.target = self.send("Target.createTarget", {"url": "about:blank"}, browser=True)[
            "targetId"
        ]
        self.session = self.send(
            "Target.attachToTarget", {"targetId": self.target, "flatten": True}, browser=True
        )["sessionId"]
        width, height = size or self.size
        for domain in ("Page", "Runtime", "Log", "Network", "Security"):
            self.send(f"{domain}.enable")
        self.send(
            "Emulation.setDeviceMetricsOverride",
            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600},
        )
        self.send(
            "Emulation.setEmulatedMedia",
            {
                "features": [
                    {"name": name, "value": value} for name, value in (features or {}).items()
                ]
            },
        )
        self.send("Page.navigate", {"url": pathlib.Path(path).resolve().as_uri() + fragment})
        self.wait_for("document.readyState === 'complete'")

    def run(self, script, wait=60.0):
        """Evaluates a script and awaits promises; raises its exceptions."""
        result = self.send(
            "Runtime.evaluate",
            {"expression": script, "returnByValue": True, "awaitPromise": True},
            wait=wait,
        )
        if "exceptionDetails" in result:
            details = result["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return result["result"].get("value")

    def wait_for(self, condition, wait=60.0):
        deadline = time.monotonic() + wait
        while not self.run(f"Boolean({condition})"):
            if time.monotonic() > deadline:
                raise TimeoutError(f"in vain: {condition}")
            time.sleep(0.03)

    def click(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.send(
                "Input.dispatchMouseEvent",
                {"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1},
            )

    def press(self, key, code=None, text=None):
        """Presses a key by name, such as `ArrowRight`, ` ` or `f`."""
        text = key if text is None and len(key) == 1 else text
        self.send(
            "Input.dispatchKeyEvent",
            {
                "type": "keyDown",
                "key": key,
                "code": code or key,
                **({"text": text} if text else {}),
            },
        )
        self.send("Input.dispatchKeyEvent", {"type": "keyUp", "key": key, "code": code or key})

    def screenshot(self):
        """Returns a screenshot, PNG."""
        return base64.b64decode(self.send("Page.captureScreenshot", {"format": "png"})["data"])

    def complaints(self):
        """Console messages of the page, exceptions, and the browser's log entries about it."""
        self.run("0")
        found = []
        for event in self.events:
            params = event.get("params", {})
            if event.get("method") == "Runtime.exceptionThrown":
                found.append(
                    params["exceptionDetails"]["text"]
                    + " "
                    + params["exceptionDetails"].get("exception", {}).get("description", "")
                )
            elif event.get("method") == "Log.entryAdded":
                found.append(params["entry"]["text"])
            elif event.get("method") == "Runtime.consoleAPICalled":
                found.append(
                    " ".join(
                        str(each.get("value", each.get("description"))) for each in params["args"]
                    )
                )
        return found

    def requests(self):
        """Returns the addresses that the page requested."""
        self.run("0")
        return [
            event["params"]["request"]["url"]
            for event in self.events
            if event.get("method") == "Network.requestWillBeSent"
        ]
