"""A headless Chromium, driven over the pipe of its DevTools protocol: no port, no further package."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "chrome")
PROGRAM = next((found for found in map(shutil.which, NAMES) if found), None)
WITHOUT = f"needs a browser: one of {', '.join(NAMES)}"
SECONDS = 60.0
"""After which a browser that does not reply is given up."""


class Browser:
    """One page of one browser; what it complains of and what it asks the network for is kept."""

    def __init__(self, profile: Path) -> None:
        assert PROGRAM is not None, WITHOUT
        from_us, self._to = os.pipe()
        self._from, to_us = os.pipe()
        # The protocol reads from descriptor 3 and writes to 4.
        arrange = f'exec 3<&{from_us} 4>&{to_us}; exec "$@"'
        flags = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
            "--no-first-run",
        ]
        command = [PROGRAM, *flags, "--remote-debugging-pipe", f"--user-data-dir={profile}"]
        self._process = subprocess.Popen(
            ["bash", "-c", arrange, "browser", *command, "about:blank"],
            pass_fds=(from_us, to_us),
            stderr=subprocess.DEVNULL,
        )
        os.close(from_us)
        os.close(to_us)
        os.set_blocking(self._from, False)
        self._buffer, self._number, self._session = b"", 0, ""
        self._loaded: set[str] = set()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        (page,) = (
            target
            for target in self.ask("Target.getTargets")["targetInfos"]
            if target["type"] == "page"
        )
        attached = self.ask("Target.attachToTarget", targetId=page["targetId"], flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")
        self.ask("Page.setLifecycleEventsEnabled", enabled=True)

    def ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        """The result of one command of the protocol."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        while (reply := self._next()).get("id") != self._number:
            self._note(reply)
        assert "error" not in reply, f"{method}: {reply['error']}"
        result: dict[str, Any] = reply["result"]
        return result

    def open(self, path: Path, *, at: str = "", width: int = 1280, height: int = 800) -> None:
        """Load a file, with `at` behind the # of its address, in a window of that size."""
        self.ask(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=height, deviceScaleFactor=1, mobile=width < 600,
        )  # fmt: skip
        # From elsewhere, for only another # would not load the page anew.
        for url in ("about:blank", f"{path.as_uri()}#{at}"):
            loader = self.ask("Page.navigate", url=url)["loaderId"]
            while loader not in self._loaded:
                self._note(self._next())

    def prefer(self, **features: str) -> None:
        """Set media features, such as ``prefers_color_scheme="dark"``."""
        listed = [{"name": k.replace("_", "-"), "value": v} for k, v in features.items()]
        self.ask("Emulation.setEmulatedMedia", features=listed)

    def run(self, script: str) -> Any:
        """The value of a script, once it is there."""
        done = self.ask(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in done, done["exceptionDetails"]
        return done["result"].get("value")

    def press(self, key: str, *, shift: bool = False) -> None:
        """Press and release a key, by its name in the browser."""
        text = {"text": key} if len(key) == 1 else {}
        for kind in ("keyDown", "keyUp"):
            self.ask(
                "Input.dispatchKeyEvent",
                type=kind, key=key, code="Space" if key == " " else key,
                modifiers=8 * shift, **(text if kind == "keyDown" else {}),
            )  # fmt: skip

    def mouse(self, kind: str, x: float, y: float) -> None:
        """``Moved``, ``Pressed`` or ``Released`` at a place of the window."""
        button = "none" if kind == "Moved" else "left"
        self.ask(
            "Input.dispatchMouseEvent", type=f"mouse{kind}", x=x, y=y, button=button, clickCount=1
        )

    def click(self, x: float, y: float) -> None:
        """Click at a place of the window."""
        for kind in ("Moved", "Pressed", "Released"):
            self.mouse(kind, x, y)

    def picture(self, path: Path, *, whole: bool = False) -> None:
        """Write a PNG of the window, or of the whole page."""
        shot = self.ask("Page.captureScreenshot", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(shot["data"]))

    def close(self) -> None:
        """End the browser."""
        self._session = ""
        self.ask("Browser.close")
        self._process.wait(SECONDS)
        os.close(self._to)
        os.close(self._from)

    def _note(self, event: dict[str, Any]) -> None:
        method, about = event.get("method"), event.get("params", {})
        if method == "Page.lifecycleEvent" and about["name"] == "load":
            self._loaded.add(about["loaderId"])
        elif method == "Runtime.exceptionThrown":
            self.complaints.append(json.dumps(about["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and about["type"] in (
            "error",
            "warning",
            "assert",
        ):
            self.complaints.append(json.dumps(about["args"]))
        elif method == "Log.entryAdded" and about["entry"]["level"] in ("error", "warning"):
            self.complaints.append(about["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(about["request"]["url"])

    def _next(self) -> dict[str, Any]:
        """The next message of the browser."""
        end = time.monotonic() + SECONDS
        while b"\0" not in self._buffer:
            try:
                read = os.read(self._from, 1 << 20)
                assert read, "the browser has ended"
                self._buffer += read
            except BlockingIOError:
                assert time.monotonic() < end, "the browser does not reply"
                time.sleep(0.002)
        message, _, self._buffer = self._buffer.partition(b"\0")
        parsed: dict[str, Any] = json.loads(message)
        return parsed
