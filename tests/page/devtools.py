"""A headless Chromium, driven by the DevTools protocol as by a person: mouse, keys, eyes, a look at its console."""

from __future__ import annotations

import base64
import io
import itertools
import json
import subprocess
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from chromium import FLAGS, chromium
from PIL import Image
from websockets.sync.client import connect

PATIENCE = 30.0  # seconds for anything that a page does

_CODES = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Home": 36, "Tab": 9, "Enter": 13}
_SHIFT = 8


def until(what: Callable[[], Any], words: str) -> Any:
    """The first true answer."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if answer := what():
            return answer
        time.sleep(0.02)
    raise AssertionError(f"waited {PATIENCE:g} s for: {words}")


class Open(Protocol):
    """Opens the page of the scene that is watched, or the one at `url`, in a tab, and waits for its picture."""

    def __call__(self, url: str | None = None, **seen: Any) -> Tab: ...


class Browser:
    """One process, any number of tabs one after the other."""

    def __init__(self) -> None:
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        folder = Path(self._profile.name)
        command = [chromium(), *FLAGS, "--remote-debugging-port=0", f"--user-data-dir={folder}", "about:blank"]
        self._process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        told = folder / "DevToolsActivePort"
        until(lambda: told.exists() and told.read_text().count("\n") == 1, "the browser")
        port, path = told.read_text().split("\n")
        self._held = ExitStack()
        self._connection = self._held.enter_context(
            connect(f"ws://127.0.0.1:{port}{path}", max_size=None, ping_interval=None)
        )
        self._calls = itertools.count(1)
        self.events: list[dict[str, Any]] = []
        self.call("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])

    def call(self, method: str, session: str | None = None, **params: Any) -> dict[str, Any]:
        """What the browser answers; events that come before that are kept."""
        number = next(self._calls)
        message: dict[str, Any] = {"id": number, "method": method, "params": params}
        if session is not None:
            message["sessionId"] = session
        self._connection.send(json.dumps(message))
        while True:
            heard = json.loads(self._connection.recv(timeout=PATIENCE))
            if heard.get("id") == number:
                assert "error" not in heard, f"{method}: {heard['error']}"
                return dict(heard["result"])
            self.events.append(heard)

    def open(self, **seen: Any) -> Tab:
        """A new tab."""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        return Tab(self, target, session, **seen)

    def close(self) -> None:
        self._held.close()
        self._process.terminate()
        self._process.wait(20)
        self._profile.cleanup()


class Tab:
    """A page, seen by one person: `size` of the window, pixels a point, light or dark."""

    def __init__(
        self,
        browser: Browser,
        target: str,
        session: str,
        size: tuple[int, int] = (960, 540),
        ratio: float = 1.0,
        scheme: str = "light",
        prepare: str = "",
    ) -> None:
        self._browser, self._target, self._session = browser, target, session
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setFocusEmulationEnabled", enabled=True)
        self.resize(size, ratio)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        if prepare:
            self.call("Page.addScriptToEvaluateOnNewDocument", source=prepare)

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        return self._browser.call(method, self._session, **params)

    def resize(self, size: tuple[int, int], ratio: float = 1.0) -> None:
        width, height = size
        self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=ratio, mobile=False
        )

    def go(self, url: str) -> None:
        self.call("Page.navigate", url=url)

    def run(self, expression: str) -> Any:
        """The value of a JavaScript expression; a promise is waited for."""
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def until(self, expression: str) -> Any:
        return until(lambda: self.run(expression), expression)

    def text(self, selector: str) -> str:
        return str(self.run(f"document.querySelector({json.dumps(selector)})?.textContent ?? ''"))

    # a person's hands

    def key(self, key: str, shift: bool = False) -> None:
        about = {"key": key, "modifiers": _SHIFT if shift else 0, "windowsVirtualKeyCode": _CODES.get(key, ord(key[0]))}
        typed = {"text": key} if len(key) == 1 else {"text": "\r"} if key == "Enter" else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", **about, **typed)
        self.call("Input.dispatchKeyEvent", type="keyUp", **about)

    def type(self, text: str) -> None:
        self.call("Input.insertText", text=text)

    def mouse(self, kind: str, at: tuple[float, float], **more: Any) -> None:
        self.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], **more)

    def drag(
        self, start: tuple[float, float], end: tuple[float, float], button: str = "left", shift: bool = False
    ) -> None:
        held = {"button": button, "buttons": {"left": 1, "right": 2}[button], "modifiers": _SHIFT if shift else 0}
        self.mouse("mousePressed", start, clickCount=1, **held)
        for step in range(1, 6):
            at = tuple(a + (b - a) * step / 5 for a, b in zip(start, end, strict=True))
            self.mouse("mouseMoved", at, **held)
        self.mouse("mouseReleased", end, clickCount=1, **(held | {"buttons": 0}))

    def pinch(self, middle: tuple[float, float], start: float, end: float) -> None:
        """Two fingers side by side, from one distance to another."""
        self.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        x, y = middle
        for step in range(6):
            half = (start + (end - start) * step / 5) / 2
            fingers = [{"x": x - half, "y": y, "id": 0}, {"x": x + half, "y": y, "id": 1}]
            self.call("Input.dispatchTouchEvent", type="touchMove" if step else "touchStart", touchPoints=fingers)
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def click(self, selector: str) -> None:
        box = self.box(selector)
        middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        self.mouse("mousePressed", middle, button="left", buttons=1, clickCount=1)
        self.mouse("mouseReleased", middle, button="left", clickCount=1)

    # a person's eyes

    def box(self, selector: str) -> dict[str, float]:
        found = self.run(f"document.querySelector({json.dumps(selector)}).getBoundingClientRect().toJSON()")
        return dict(found)

    def rest(self) -> None:
        """Until the picture is finished."""
        self.until("document.querySelector('#view').getAttribute('aria-busy') === 'false'")

    def seen(self, selector: str | None = None) -> np.ndarray[Any, Any]:
        """(height, width, 3): what is on the screen, of the whole page or of an element."""
        clip = {} if selector is None else {"clip": self.box(selector) | {"scale": 1}}
        answer = self.call("Page.captureScreenshot", format="png", **clip)
        picture = Image.open(io.BytesIO(base64.b64decode(answer["data"])))
        return np.asarray(picture.convert("RGB"))

    def complaints(self) -> list[str]:
        """Everything that the console has against the page since the last time."""
        self.run("0")  # its answer comes behind what was told before
        mine = [event for event in self._browser.events if event.get("sessionId") == self._session]
        self._browser.events = [event for event in self._browser.events if event not in mine]
        found = []
        for event in mine:
            about = event["params"]
            match event["method"]:
                case "Runtime.exceptionThrown":
                    found.append(str(about["exceptionDetails"]))
                case "Runtime.consoleAPICalled" if about["type"] in ("error", "warning", "assert"):
                    found.append(str(about["args"]))
                case "Log.entryAdded" if about["entry"]["level"] in ("error", "warning"):
                    found.append(str(about["entry"]))
        return found

    def close(self) -> None:
        self._browser.call("Target.closeTarget", targetId=self._target)
