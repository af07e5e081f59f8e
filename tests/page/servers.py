"""A scene that is watched: by `sdfc watch --serve` itself, or by a server that says what a test wants it to."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from http import HTTPStatus
from pathlib import Path
from typing import Any

from websockets.datastructures import Headers
from websockets.http11 import Request, Response
from websockets.sync.client import connect
from websockets.sync.server import ServerConnection, serve

from sdfc import page

SCENE = """\
param size = 0.5 in 0.2..0.8
param turn = 30deg in -180deg..180deg
param paint = #c8452f
material block { color: paint, roughness: 0.5 }
material ball { color: #2f6fc8 }
camera { eye: [2, 1.6, 3], target: [0.1, 0, 0], fov: 34deg }
light sun { direction: [-1, -2, -1.2], intensity: 3.5 }
scene {
    box(size: [1, 1, 1]).material(block).rotate(y: turn)
    sphere(radius: size).translate([0.75, 0.3, 0.2]).material(ball)
}
"""


class Watch:
    """`sdfc watch --serve 0` of a file of its own."""

    def __init__(self, folder: Path, name: str = "model.sdf", text: str = SCENE) -> None:
        self.scene = folder / name
        self.scene.write_text(text)
        command = [sys.executable, "-m", "sdfc", "watch", str(self.scene), "--serve", "0"]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        assert self._process.stdout is not None
        first = self._process.stdout.readline()
        assert first.startswith("serving "), first
        self.url = first.split()[1]
        # what it says of saves is told to the page too
        threading.Thread(target=self._process.stdout.read, daemon=True).start()

    def save(self, text: str) -> None:
        self.scene.write_text(text)

    def edit(self, old: str, new: str) -> None:
        text = self.scene.read_text()
        assert old in text
        self.save(text.replace(old, new))

    def told(self) -> dict[str, Any]:
        """The message that a page gets first."""
        origin = self.url.rstrip("/")
        with connect(f"{origin.replace('http', 'ws')}/live", origin=origin, max_size=None) as connection:  # type: ignore[arg-type]
            return dict(json.loads(connection.recv(timeout=30)))

    def close(self) -> None:
        self._process.terminate()
        self._process.wait(20)


class Actor:
    """Serves the page, and plays the part of the watch."""

    def __init__(self, scene: dict[str, Any], port: int = 0) -> None:
        self.scene = scene  # the message that a page gets first
        self.heard: list[dict[str, Any]] = []
        self._pages: list[ServerConnection] = []
        self._server = serve(self._talk, "127.0.0.1", port, process_request=_answer, compression=None)
        self.port = self._server.socket.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}/"
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def _talk(self, connection: ServerConnection) -> None:
        connection.send(json.dumps(self.scene))
        self._pages.append(connection)
        for message in connection:
            self.heard.append(json.loads(message))

    def say(self, message: dict[str, Any]) -> None:
        """To every page."""
        for connection in self._pages:
            connection.send(json.dumps(message))

    def show(self, request: int, picture: bytes) -> None:
        """The answer to a page that asked for a picture."""
        self.say({"type": "picture", "request": request})
        for connection in self._pages:
            connection.send(picture)

    def close(self) -> None:
        for connection in self._pages:
            connection.close()
        self._server.shutdown()


def _answer(_: ServerConnection, request: Request) -> Response | None:
    if request.path == "/live":
        return None
    name = request.path.removeprefix("/") or "index.html"
    is_known = name in page.FILES
    status = HTTPStatus.OK if is_known else HTTPStatus.NOT_FOUND
    body = page.content(name) if is_known else b""
    headers = {"Content-Type": page.FILES.get(name, "text/plain"), "Content-Length": str(len(body))}
    return Response(status.value, status.phrase, Headers(headers | {"Connection": "close"}), body)
