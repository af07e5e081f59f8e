"""One page that is connected: what it is sent, in order and without waiting for it, and what it asks for."""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Callable, Sequence

from websockets.exceptions import ConnectionClosed
from websockets.frames import CloseCode
from websockets.sync.server import ServerConnection

from sdfc.live.door import shut
from sdfc.live.wishes import Wish, WishError, wish_of

MOST_WAITING = 64  # messages that a page has not taken yet: one that is slower is let go

Frames = Sequence[str | bytes]


class Guest:
    """Sent to by any thread. Its wishes are read in the thread that calls `listen`; the newest one counts."""

    def __init__(self, connection: ServerConnection) -> None:
        self._connection = connection
        self._waiting: queue.Queue[Frames | None] = queue.Queue(MOST_WAITING)
        self._wish: Wish | None = None
        self._lock = threading.Lock()

    def send(self, *frames: str | bytes) -> None:
        """Frames that follow one another. A page that does not take what it is sent is let go."""
        try:
            self._waiting.put_nowait(frames)
        except queue.Full:
            self.drop()

    def drop(self) -> None:
        """End the connection."""
        shut(self._connection.socket)

    @property
    def wish(self) -> Wish | None:
        """What it asked for last, until that is done, or it is gone."""
        with self._lock:
            return self._wish

    def done(self, wish: Wish) -> None:
        """It has what it asked for; what it has asked for since, it has not."""
        with self._lock:
            if self._wish is wish:
                self._wish = None

    def listen(self, asked: Callable[[], None]) -> None:
        """Until the page is gone, or says what it should not. `asked` is called for every wish."""
        sender = threading.Thread(target=self._send_all, daemon=True)
        sender.start()
        try:
            for message in self._connection:
                wish = wish_of(message)
                with self._lock:
                    self._wish = wish
                asked()
        except WishError as error:
            self._connection.close(CloseCode.POLICY_VIOLATION, str(error))
        except ConnectionClosed:
            pass
        finally:
            self.drop()
            with self._lock:
                self._wish = None
            with contextlib.suppress(queue.Full):  # then the sender does not wait for more, and finds out
                self._waiting.put_nowait(None)

    def _send_all(self) -> None:
        try:
            while (frames := self._waiting.get()) is not None:
                for frame in frames:
                    self._connection.send(frame)
        except (ConnectionClosed, OSError):
            return
