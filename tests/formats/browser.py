"""Chromium without a window, driven by the WebDriver protocol: requests of JSON to chromedriver."""

import base64
import io
import json
import socket
import subprocess
import time
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np

FLAGS = (
    "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--window-size=1200,800",
)  # fmt: skip
PATIENCE = 60.0


class Browser:
    """A browser with a profile of its own in `folder`."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self._root = f"http://127.0.0.1:{port}"
        self._driver = subprocess.Popen(
            ["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        options = {"args": [*FLAGS, f"--user-data-dir={folder}"]}
        wanted = {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        begun = time.monotonic()
        while not self._answers():
            assert time.monotonic() - begun < PATIENCE
            time.sleep(0.05)
        session = self._call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})
        self._session = f"/session/{session['sessionId']}"

    def close(self) -> None:
        """End it."""
        try:
            self._call("DELETE", self._session)
        finally:
            self._driver.terminate()
            self._driver.wait()

    def open(self, page: Path) -> None:
        """Open a page, and wait for it to be drawn."""
        self.load(page.resolve().as_uri())
        self.wait("return document.body.dataset.ready")
        assert self.run("return document.body.dataset.ready") == "yes", self.run(
            "return document.querySelector('#trouble').textContent"
        )
        self.settle()

    def load(self, address: str) -> None:
        """Open an address."""
        self._call("POST", f"{self._session}/url", {"url": address})

    def run(self, script: str, *arguments: Any) -> Any:
        """Run a script in the page and return what it does."""
        return self._call("POST", f"{self._session}/execute/sync", {"script": script, "args": arguments})

    def wait(self, script: str) -> None:
        """Wait until a script returns something true."""
        begun = time.monotonic()
        while not self.run(script):
            assert time.monotonic() - begun < PATIENCE, script
            time.sleep(0.02)

    def settle(self) -> None:
        """Wait until no more frames are drawn."""
        self.wait("return meshonet.camera.flight === null")
        frames = None
        while (now := self.run("return document.body.dataset.frames")) != frames:
            frames = now
            time.sleep(0.15)

    def click(self, selector: str) -> None:
        """Click an element, and wait for what follows."""
        self.run("document.querySelector(arguments[0]).click()", selector)
        self.settle()

    def mouse(self, *actions: dict[str, Any]) -> None:
        """Let the mouse do something, and wait for what follows."""
        pointer = {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}}
        body = {"actions": [pointer | {"actions": list(actions)}]}
        self._call("POST", f"{self._session}/actions", body)
        self.settle()

    def wheel(self, x: int, y: int, turn: int) -> None:
        """Turn the wheel over a place."""
        action = {
            "type": "scroll",
            "x": x,
            "y": y,
            "deltaX": 0,
            "deltaY": turn,
            "duration": 0,
            "origin": "viewport",
        }
        self._call(
            "POST",
            f"{self._session}/actions",
            {"actions": [{"type": "wheel", "id": "wheel", "actions": [action]}]},
        )
        self.settle()

    def picture(self) -> np.ndarray:
        """Return what is seen, (rows, columns, 3) from 0 to 1."""
        data = base64.b64decode(self._call("GET", f"{self._session}/screenshot"))
        return np.asarray(matplotlib.image.imread(io.BytesIO(data)))[..., :3]

    def complaints(self) -> list[str]:
        """Return what the page has written to the console since the last call."""
        entries = self._call("POST", f"{self._session}/se/log", {"type": "browser"})
        return [entry["message"] for entry in entries]

    def _answers(self) -> bool:
        try:
            return bool(self._call("GET", "/status")["ready"])
        except urllib.error.URLError:
            return False

    def _call(self, method: str, path: str, body: Any = None) -> Any:
        data = None if body is None else json.dumps(body).encode()
        headers = {"Content-Type": "application/json"}
        request = urllib.request.Request(self._root + path, data, headers, method=method)  # noqa: S310
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as reply:  # noqa: S310
                return json.load(reply)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(error.read().decode()[:600]) from None
