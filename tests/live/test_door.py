"""Nobody gets in but pages that came from this server, by the names of this machine; and nobody can hold it up."""

from __future__ import annotations

import json
import socket
import threading
import time
from collections.abc import Callable, Iterator

import pytest
from visitor import PATIENCE, Visitor, head, reply, upgrade, visitors
from websockets.exceptions import ConnectionClosed

from sdfc import page
from sdfc.api.request import RequestError
from sdfc.live.door import LARGEST_FRAME, MOST_GUESTS
from sdfc.live.guest import MOST_WAITING
from sdfc.live.pages import Pages

CAMERA = {"eye": [0, 0, 4], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 0.6, "height": None}
DRAW = {"type": "draw", "request": 1, "camera": CAMERA, "params": {}, "size": [64, 36]}


@pytest.fixture
def wishes() -> threading.Semaphore:
    """How many pictures were asked for."""
    return threading.Semaphore(0)


@pytest.fixture
def pages(wishes: threading.Semaphore) -> Iterator[Pages]:
    before = threading.active_count()
    made = Pages(0, wishes.release)
    yield made
    made.close()
    for thread in threading.enumerate():
        if thread is not threading.current_thread():
            thread.join(PATIENCE)
    assert threading.active_count() <= before


@pytest.fixture
def port(pages: Pages) -> int:
    return int(pages.address.rstrip("/").rsplit(":", 1)[1])


@pytest.fixture
def visitor(port: int) -> Iterator[Callable[[], Visitor]]:
    with visitors(port) as made:
        yield made


def test_the_files_of_the_table_are_served_with_what_keeps_a_page_safe(port: int) -> None:
    for path, name in [("/", "index.html"), *((f"/{name}", name) for name in page.FILES)]:
        status, headers, body = reply(port, head(port, path))
        assert (status, body) == (200, page.content(name))
        assert headers["content-type"] == page.FILES[name]
        assert headers["content-length"] == str(len(body))
        policy = headers["content-security-policy"].split("; ")
        assert {"default-src 'self'", "connect-src 'self'", "img-src 'self' blob: data:", "style-src 'self'"} <= {
            *policy
        }
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["cache-control"] == "no-store"
        assert headers["referrer-policy"] == "no-referrer"
        assert headers["cross-origin-opener-policy"] == "same-origin"


@pytest.mark.parametrize("query", ["?", "?x=1", "?/../secret", "?a?b"])
def test_what_a_link_adds_to_a_name_is_ignored(port: int, query: str) -> None:
    for path, name in [("/", "index.html"), ("/page.css", "page.css")]:
        status, _, body = reply(port, head(port, path + query))
        assert (status, body) == (200, page.content(name))
    assert reply(port, head(port, f"/secret{query}"))[0] == 404


@pytest.mark.parametrize(
    "path",
    [
        "/__init__.py",
        "/../__init__.py",
        "/../../pyproject.toml",
        "/%2e%2e/%2e%2e/pyproject.toml",
        "//etc/passwd",
        "/index.html/",
        "/./index.html",
        "/index.html%00",
        "/INDEX.HTML",
        "*",
        "index.html",
        "http://127.0.0.1/index.html",
        "/live/",
        "/scene.sdf",
    ],
)
def test_nothing_else_is(port: int, path: str) -> None:
    status, _, body = reply(port, head(port, path))
    assert (status, body) == (404, b"Not Found\n")


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE", "get", "HEAD"])
def test_there_is_only_get(port: int, method: str) -> None:
    status, _, body = reply(port, head(port, "/", method))
    assert status in (0, 400, 405)
    assert page.content("index.html") not in body


def hosts(port: int) -> list[str]:
    return [f"127.0.0.1:{port}", f"localhost:{port}", f"LocalHost:{port}", f"[::1]:{port}"]


def strange_hosts(port: int) -> list[str]:
    return [
        "",
        f"evil.example:{port}",  # a name that a stranger's server gave this address: DNS rebinding
        f"127.0.0.1.evil.example:{port}",
        f"localhost.:{port}",
        f"127.0.0.2:{port}",
        f"0.0.0.0:{port}",
        "127.0.0.1",
        f"127.0.0.1:{port + 1}",
        f"127.0.0.1:{port}, evil.example",
        f"127.0.0.1:{port}\r\nHost: 127.0.0.1:{port}",
        f"a@127.0.0.1:{port}",
    ]


def test_the_host_must_be_this_machine(port: int) -> None:
    for host in hosts(port):
        assert reply(port, head(port, "/", "GET", host))[0] == 200, host
    for host in strange_hosts(port):
        assert reply(port, head(port, "/", "GET", host))[0] == 403, host
        assert reply(port, upgrade(port, f"Origin: http://127.0.0.1:{port}", host=host))[0] == 403, host


def test_the_origin_must_be_our_page(port: int) -> None:
    for host in hosts(port):
        assert reply(port, upgrade(port, f"Origin: http://{host}"))[0] == 101, host
    ours = f"http://127.0.0.1:{port}"
    strange = [f"http://{host}" for host in strange_hosts(port) if host] + ["null", f"https://127.0.0.1:{port}"]
    strange += [f"{ours}/", f"{ours}\r\nOrigin: {ours}", "", "file://", f"http://evil.example/{ours}"]
    for origin in strange:
        assert reply(port, upgrade(port, f"Origin: {origin}"))[0] == 403, origin
    assert reply(port, upgrade(port))[0] == 403, "no origin: no browser"
    assert reply(port, upgrade(port, f"Origin: {ours}", path="/"))[0] == 200, "a WebSocket is only at /live"


@pytest.mark.parametrize("address", ["127.0.0.2", "::1"])
def test_it_listens_at_one_address_of_this_machine_alone(port: int, address: str) -> None:
    """Were it at all of them, it would be at these too."""
    with pytest.raises(OSError):
        socket.create_connection((address, port), timeout=PATIENCE)


@pytest.mark.parametrize(
    ("message", "code"),
    [
        ("", 1008),
        ("draw", 1008),
        ("null", 1008),
        ("[]", 1008),
        ("{}", 1008),
        ("[" * 60_000, 1008),
        ('{"a":' * 10_000, 1008),
        (b"\x00", 1008),
        (json.dumps(DRAW).encode(), 1008),
        (json.dumps({**DRAW, "type": "read"}), 1008),
        (json.dumps({**DRAW, "path": "/etc/passwd"}), 1008),
        (json.dumps({name: value for name, value in DRAW.items() if name != "params"}), 1008),
        (json.dumps({**DRAW, "request": -1}), 1008),
        (json.dumps({**DRAW, "request": 1.5}), 1008),
        (json.dumps({**DRAW, "request": True}), 1008),
        (json.dumps({**DRAW, "request": 2**60}), 1008),
        (json.dumps({**DRAW, "size": [64]}), 1008),
        (json.dumps({**DRAW, "size": [64, 15]}), 1008),
        (json.dumps({**DRAW, "size": [1921, 64]}), 1008),
        (json.dumps({**DRAW, "size": [64.0, 64]}), 1008),
        (json.dumps({**DRAW, "size": "64x64"}), 1008),
        (json.dumps({**DRAW, "camera": {**CAMERA, "eye": [0, 0]}}), 1008),
        (json.dumps({**DRAW, "camera": {**CAMERA, "eye": [0, 0, "4"]}}), 1008),
        (json.dumps({**DRAW, "camera": {**CAMERA, "eye": [0, 0, None]}}), 1008),
        (json.dumps({**DRAW, "camera": {**CAMERA, "eye": [0, 0, float("nan")]}}), 1008),
        (json.dumps({**DRAW, "camera": {**CAMERA, "fov": float("inf")}}), 1008),
        (json.dumps({**DRAW, "camera": {**CAMERA, "roll": 1}}), 1008),
        (json.dumps(DRAW).replace("0.6", "1e999"), 1008),
        (json.dumps(DRAW).replace("0.6", "-1e39"), 1008),
        (json.dumps(DRAW).replace("0.6", "1" * 400), 1008),
        (json.dumps(DRAW).replace("0.6", "1" * 5000), 1008),
        (json.dumps({**DRAW, "params": []}), 1008),
        (json.dumps({**DRAW, "params": {"a": 1}}), 1008),
        (json.dumps({**DRAW, "params": {"a": [[1]]}}), 1008),
        (json.dumps({**DRAW, "params": {"a": [False]}}), 1008),
        (json.dumps({**DRAW, "params": {"a" * LARGEST_FRAME: [1]}}), 1009),
        (" " * (LARGEST_FRAME + 1), 1009),
    ],
    ids=str,
)
def test_what_is_not_understood_ends_the_connection(
    visitor: Callable[[], Visitor], wishes: threading.Semaphore, message: str | bytes, code: int
) -> None:
    stranger, other = visitor(), visitor()
    stranger.connection.send(message)
    with pytest.raises(ConnectionClosed) as closed:
        stranger.connection.recv(timeout=PATIENCE)
    assert closed.value.rcvd is not None and closed.value.rcvd.code == code
    assert not wishes.acquire(blocking=False), "nothing was asked for"
    other.connection.send(json.dumps(DRAW))
    assert wishes.acquire(timeout=PATIENCE), "and others are heard"


def test_a_page_that_takes_nothing_is_let_go_and_holds_nobody_up(
    pages: Pages, port: int, visitor: Callable[[], Visitor], wishes: threading.Semaphore
) -> None:
    with socket.socket() as stalled:
        stalled.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        stalled.settimeout(PATIENCE)
        stalled.connect(("127.0.0.1", port))
        stalled.sendall(upgrade(port, f"Origin: http://127.0.0.1:{port}"))
        assert b" 101 " in stalled.recv(4096)
        other = visitor()
        other.connection.send(json.dumps(DRAW))
        assert wishes.acquire(timeout=PATIENCE), "it is in"
        words = "x" * 500_000
        for number in range(2 * MOST_WAITING):
            pages.tell(f"{number} {words}")
            assert other.hears("note")["text"] == f"{number} {words}"
        told = 0
        while more := _received(stalled):
            told += len(more)
    assert told < MOST_WAITING * len(words), "it was not sent what it did not take"


def _received(guest: socket.socket) -> bytes:
    """Nothing where the connection has ended; by a reset, if the server had not even accepted it."""
    try:
        return guest.recv(1 << 20)
    except ConnectionResetError:
        return b""


def test_those_who_say_nothing_make_room_the_first_of_them_first(
    port: int, visitor: Callable[[], Visitor], pages: Pages
) -> None:
    seen = visitor()
    silent = [socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) for _ in range(MOST_GUESTS)]
    try:
        for _ in range(MOST_GUESTS):  # more than a page has files
            assert reply(port, head(port, "/"))[0] == 200
        pages.tell("still here")
        assert seen.hears("note")["text"] == "still here", "a page stays"
        for stranger in silent:
            assert _received(stranger) == b"", "who says nothing is sent away at last"
    finally:
        for stranger in silent:
            stranger.close()


def test_pages_make_no_room(
    port: int, visitor: Callable[[], Visitor], pages: Pages, wishes: threading.Semaphore
) -> None:
    seen = [visitor() for _ in range(MOST_GUESTS)]
    for one in seen:
        one.connection.send(json.dumps(DRAW))
        assert wishes.acquire(timeout=PATIENCE), "it is in"
    assert reply(port, head(port, "/"))[0] == 0
    pages.tell("all here")
    for one in seen:
        one.hears("note")
    seen[0].connection.close()
    until = time.monotonic() + PATIENCE
    while reply(port, head(port, "/"))[0] != 200:
        assert time.monotonic() < until, "who leaves does"


def test_it_closes_with_everybody_in_it_and_the_port_is_free(
    pages: Pages, port: int, visitor: Callable[[], Visitor]
) -> None:
    seen = visitor()
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as silent:
        pages.close()
        assert _received(silent) == b""
    with pytest.raises(ConnectionClosed):
        seen.connection.recv(timeout=PATIENCE)
    again = Pages(port, lambda: None)
    assert reply(port, head(port, "/"))[0] == 200
    again.close()


def test_a_port_that_is_taken_is_said_to_be(pages: Pages, port: int) -> None:
    with pytest.raises(RequestError, match=rf"cannot serve on port {port} \(.*in use\): give another, or 0"):
        Pages(port, lambda: None)
