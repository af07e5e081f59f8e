"""The way in for pages: loopback only, a few files and one WebSocket, for nobody but pages that came from here."""

from __future__ import annotations

import contextlib
import logging
import os
import socket
import threading
from collections.abc import Callable
from http import HTTPStatus
from typing import Any

from websockets.datastructures import Headers
from websockets.http11 import Request, Response
from websockets.sync.server import Server, ServerConnection, serve

from sdfc import page
from sdfc.api.request import RequestError

LARGEST_FRAME = 64 * 1024  # bytes, from a page
MOST_GUESTS = 64  # connections at a time, those of files among them
LIVE = "/live"
_HOST = "127.0.0.1"
_NAMES = (_HOST, "localhost", "[::1]")  # by which a browser here may call this machine
_FILES = {"/": "index.html"} | {f"/{name}": name for name in page.FILES}  # by their paths, of which there are no others
_PATIENCE = 5.0  # seconds, for the opening of a connection and for its close

_HEADERS = {
    "Content-Security-Policy": (
        "default-src 'self'; connect-src 'self'; img-src 'self' blob: data:; style-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Connection": "close",
}

Talk = Callable[[ServerConnection], None]


class Door:
    """Open from the start. `talk` has a page's WebSocket until it returns, in a thread of that page's own.

    `expects` is called, in any thread, when a browser asks for the page: its WebSocket comes soon.
    """

    def __init__(self, port: int, talk: Talk, expects: Callable[[], None]) -> None:
        self._expects = expects
        self._sockets: dict[socket.socket, bool] = {}  # in the order in which they came; whether it is a page's
        self._lock = threading.Lock()
        self._is_closed = False
        self._server = self._opened(port, talk)
        self.port: int = self._server.socket.getsockname()[1]
        hosts = {f"{name}:{self.port}" for name in _NAMES} | (set(_NAMES) if self.port == 80 else set())
        self._hosts = frozenset(hosts)
        self._origins = frozenset(f"http://{host}" for host in hosts)
        # a daemon, and so are the threads that it starts: none of them keeps the process alive
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """What to open in a browser."""
        return f"http://{_HOST}:{self.port}/"

    def _opened(self, port: int, talk: Talk) -> Server:
        door = self

        class Counted(ServerConnection):
            def __init__(self, sock: socket.socket, *rest: Any, **options: Any) -> None:
                door._come(sock)
                super().__init__(sock, *rest, **options)

        try:
            return serve(
                talk,
                _HOST,
                port,
                process_request=self._answer,
                server_header=None,
                compression=None,
                max_size=LARGEST_FRAME,
                open_timeout=_PATIENCE,
                close_timeout=_PATIENCE,
                logger=_silent(),
                create_connection=Counted,
            )
        except OSError as error:
            words = os.strerror(error.errno) if error.errno else str(error)
            raise RequestError(f"cannot serve on port {port} ({words}): give another, or 0 for any free one") from None

    def _come(self, guest: socket.socket) -> None:
        """Remember who is in. What this raises turns them away.

        Where it is full, the one who came first of those that are no pages has to go: they have had their file, or they
        say nothing.
        """
        with self._lock:
            self._sockets = {known: is_page for known, is_page in self._sockets.items() if known.fileno() >= 0}
            if not self._is_closed and len(self._sockets) >= MOST_GUESTS:
                passing = [known for known, is_page in self._sockets.items() if not is_page]
                for known in passing[:1]:
                    del self._sockets[known]
                    shut(known)
            if self._is_closed or len(self._sockets) >= MOST_GUESTS:
                raise ConnectionRefusedError("nobody else gets in")
            self._sockets[guest] = False

    def _stays(self, guest: socket.socket) -> None:
        """It is a page's."""
        with self._lock:
            if guest in self._sockets:
                self._sockets[guest] = True

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """An HTTP response; None for a page that may have the WebSocket."""
        if getattr(request, "method", "GET") != "GET":  # old versions of websockets refuse others themselves
            return _plain(HTTPStatus.METHOD_NOT_ALLOWED)
        if not _is_one_of(self._hosts, request.headers.get_all("Host")):
            return _plain(HTTPStatus.FORBIDDEN)
        if request.path == LIVE:
            if not _is_one_of(self._origins, request.headers.get_all("Origin")):
                return _plain(HTTPStatus.FORBIDDEN)
            self._stays(connection.socket)
            return None
        name = _FILES.get(request.path.partition("?")[0])  # what a link may have added is nobody's
        if name is None:
            return _plain(HTTPStatus.NOT_FOUND)
        if name == "index.html":
            self._expects()
        return _response(HTTPStatus.OK, page.FILES[name], page.content(name))

    def close(self) -> None:
        """Let nobody in, and everybody out, at once."""
        with self._lock:
            self._is_closed = True
            guests = list(self._sockets)
        for guest in guests:
            shut(guest)
        self._server.shutdown()
        self._thread.join()


def shut(guest: socket.socket) -> None:
    """End a connection from any thread, whatever others wait for on it."""
    with contextlib.suppress(OSError):  # it has ended by itself
        guest.shutdown(socket.SHUT_RDWR)


def _is_one_of(known: frozenset[str], given: list[str]) -> bool:
    """Whether a header was given once, with one of these values."""
    return len(given) == 1 and given[0].lower() in known


def _plain(status: HTTPStatus) -> Response:
    return _response(status, "text/plain; charset=utf-8", f"{status.phrase}\n".encode())


def _response(status: HTTPStatus, content_type: str, body: bytes) -> Response:
    headers = Headers({"Content-Type": content_type, "Content-Length": str(len(body)), **_HEADERS})
    return Response(status.value, status.phrase, headers, body)


def _silent() -> logging.Logger:
    """What strangers do at the door is nothing to tell on a terminal."""
    logger = logging.getLogger("sdfc.live.door")
    logger.setLevel(logging.CRITICAL + 1)
    logger.propagate = False
    return logger
