"""Whoever comes to the server of `sdfc watch --serve`: pages, and those who should not get in."""

from __future__ import annotations

import contextlib
import json
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from http import HTTPStatus
from typing import Any

from websockets.sync.client import ClientConnection, connect

PATIENCE = 30.0  # seconds, for a machine with much else to do


class Visitor:
    """A page, as the server sees it. `meanwhile` is called while it waits for messages: what a watch does."""

    def __init__(self, connection: ClientConnection, meanwhile: Callable[[], None] | None = None) -> None:
        self.connection = connection
        self.meanwhile = meanwhile

    def message(self) -> dict[str, Any]:
        """The next one."""
        text = self._received()
        assert isinstance(text, str), "a picture that nobody asked for"
        told = json.loads(text)
        assert isinstance(told, dict)
        return told

    def _received(self) -> str | bytes:
        until = time.monotonic() + PATIENCE
        while self.meanwhile is not None and time.monotonic() < until:
            self.meanwhile()
            with contextlib.suppress(TimeoutError):
                return self.connection.recv(timeout=0.01)
        return self.connection.recv(timeout=PATIENCE)

    def hears(self, kind: str) -> dict[str, Any]:
        """The next message, which is of this kind."""
        told = self.message()
        assert told["type"] == kind, told
        return told

    def until_note(self) -> list[dict[str, Any]]:
        """The messages of one save, without the note at its end."""
        told = [self.message()]
        while told[-1]["type"] != "note":
            told.append(self.message())
        return told[:-1]

    def asks(self, request: int, **wish: object) -> None:
        self.connection.send(json.dumps({"type": "draw", "request": request, "params": {}, "size": [64, 36], **wish}))

    def picture(self, request: int) -> bytes:
        """What was drawn for that request."""
        assert self.hears("picture") == {"type": "picture", "request": request}
        data = self.connection.recv(timeout=PATIENCE)
        assert isinstance(data, bytes)
        return data


@contextmanager
def visitors(port: int, meanwhile: Callable[[], None] | None = None) -> Iterator[Callable[[], Visitor]]:
    """Makes visitors, who all leave at the end."""
    with ExitStack() as stack:

        def visitor() -> Visitor:
            origin = f"http://127.0.0.1:{port}"
            return Visitor(stack.enter_context(connect(f"ws://127.0.0.1:{port}/live", origin=origin)), meanwhile)  # type: ignore[arg-type]

        yield visitor


def head(port: int, path: str, method: str = "GET", host: str | None = None, *headers: str) -> bytes:
    """A request as it goes over the wire. `host`: of this machine, if not given; none, if empty."""
    named = [f"Host: {f'127.0.0.1:{port}' if host is None else host}"] if host != "" else []
    return "\r\n".join([f"{method} {path} HTTP/1.1", *named, *headers, "", ""]).encode()


def reply(port: int, request: bytes) -> tuple[int, dict[str, str], bytes]:
    """Status, headers by their names in small letters, and body. Status 0: the connection was closed without a word."""
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as stranger:
        stranger.sendall(request)
        data = b""
        try:
            while not _is_whole(data) and (more := stranger.recv(65536)):
                data += more
        except ConnectionResetError:
            pass
    if not data:
        return 0, {}, b""
    top, _, body = data.partition(b"\r\n\r\n")
    status, *lines = top.decode().split("\r\n")
    pairs = (line.partition(": ") for line in lines)
    return int(status.split()[1]), {name.lower(): value for name, _, value in pairs}, body


def _is_whole(data: bytes) -> bool:
    """Whether it is the beginning of a WebSocket: nobody closes that."""
    return data.startswith(f"HTTP/1.1 {HTTPStatus.SWITCHING_PROTOCOLS.value}".encode()) and b"\r\n\r\n" in data


def upgrade(port: int, *headers: str, host: str | None = None, path: str = "/live") -> bytes:
    """A request for the WebSocket."""
    return head(
        port,
        path,
        "GET",
        host,
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Version: 13",
        *headers,
    )
