"""The pages that show a scene: told of every edit, and drawn for where they ask."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any

from websockets.sync.server import ServerConnection

from sdfc.api.renderer import Shot
from sdfc.api.request import RequestError, checked_params
from sdfc.live import messages
from sdfc.live.door import Door
from sdfc.live.edits import Shown
from sdfc.live.guest import Guest
from sdfc.live.messages import Message, text_of
from sdfc.live.painter import Painter, StoppedError
from sdfc.live.wishes import Wish


class Pages:
    """Any number of them. One that comes late is told what the others see.

    What a page needs to begin is dear to make, and nobody makes it where no page is or comes; and it is made in the
    thread of the watch alone (`greet`), since it adds to the scene's own graphs.
    """

    def __init__(self, port: int, wanted: Callable[[], None]) -> None:
        self._wanted = wanted  # called, in any thread, when a page is to be told the scene, or asks for a picture
        self._lock = threading.Lock()
        self._guests: list[Guest] = []  # those who are told
        self._coming: list[Guest] = []  # those who wait for `greet`
        self._is_expecting = False  # a browser is loading the page
        self._shown: Shown | None = None
        self._number = 0  # of the scene that is shown
        self._scene: dict[str, Any] = {}  # its message, with what was told since; empty until a page needs it
        self._errors: Message | None = None
        self._door = Door(port, self._welcome, self._expect)

    @property
    def address(self) -> str:
        """What to open in a browser."""
        return self._door.address

    def _expect(self) -> None:
        self._is_expecting = True
        self._wanted()

    def _welcome(self, connection: ServerConnection) -> None:
        guest = Guest(connection)
        with self._lock:
            is_at_hand = bool(self._scene) or self._shown is None
            if is_at_hand:
                self._begin_with(guest)
            else:
                self._coming.append(guest)
        if not is_at_hand:
            self._wanted()
        try:
            guest.listen(self._wanted)
        finally:
            with self._lock:
                (self._guests if guest in self._guests else self._coming).remove(guest)

    def _begin_with(self, guest: Guest) -> None:
        """From now on it is told what the others are. For who has the lock."""
        for message in (self._scene, self._errors):
            if message:
                guest.send(text_of(message))
        self._guests.append(guest)

    def greet(self) -> None:
        """Tell the scene to those who have come since. Where it cannot be told, they wait for the next."""
        with self._lock:
            is_wanted, self._is_expecting = bool(self._coming) or self._is_expecting, False
        if not is_wanted:
            return
        try:
            if self._shown is not None and not self._scene:
                self._scene = messages.scene(self._number, self._shown)
        finally:
            with self._lock:
                coming, self._coming = self._coming, []
                for guest in coming:
                    self._begin_with(guest)

    def show(self, shown: Shown) -> None:
        """Tell what has changed since the last time."""
        before = self._shown
        is_other = before is None or before.built.compiled.plan is not shown.built.compiled.plan
        with self._lock:
            self._number += is_other
            if not self._guests:
                self._shown, self._scene, self._errors = shown, {}, None
                return
        if before is None or is_other or not self._scene:
            self._publish([messages.scene(self._number, shown)])
        else:
            changes = self._changes(before, shown)
            self._publish(changes or ([{"type": "well"}] if self._errors is not None else []))
            if messages.exact(before) != messages.exact(shown):  # last: what is drawn does not wait for them
                self._publish([{"type": "boxes", "id": self._number, **messages.boxes(shown)}])
        self._shown = shown

    def _publish(self, changes: Sequence[Message]) -> None:
        with self._lock:
            self._errors = None
            for message in changes:
                self._scene = _after(self._scene, message)
                self._send(message)

    def _changes(self, before: Shown, shown: Shown) -> list[Message]:
        """Between two that are drawn by one shader."""
        told: list[Message] = []
        old = messages.values(before)
        values = {name: value for name, value in messages.values(shown).items() if value != old[name]}
        if values:
            told.append({"type": "values", "id": self._number, "values": values})
        camera = messages.camera(shown)
        # one that frames the scene would follow every number: whoever looks around is left where they are
        if shown.built.compiled.scene.camera is not None and camera != messages.camera(before):
            told.append({"type": "camera", "id": self._number, "camera": camera})
        return told

    def tell_errors(self, text: str, error: Exception) -> None:
        """What is wrong with the last save, as the terminal shows it."""
        message = messages.errors(text, error)
        with self._lock:
            self._errors = message
            self._send(message)

    def tell(self, line: str) -> None:
        """The line that the terminal has for a save."""
        with self._lock:
            self._send({"type": "note", "text": line})

    def _send(self, message: Message) -> None:
        text = text_of(message) if self._guests else ""
        for guest in self._guests:
            guest.send(text)

    def answer(self, painter: Painter, is_needed: Callable[[], bool]) -> bool:
        """Draw for one page that asks for it and whose shader is there; whether there was one. Pages take turns.

        `is_needed` is asked now and then whether there is something better to do: then the page is drawn for later.
        """
        with self._lock:
            asking = [(guest, wish) for guest in self._guests if (wish := guest.wish) is not None]
        for guest, wish in asking:
            try:
                frames = self._answered(guest, wish, painter, is_needed)
            except StoppedError:
                return True
            if frames:
                guest.done(wish)
                guest.send(*frames)
                self._puts_last(guest)
                return True
        return False

    def _answered(
        self, guest: Guest, wish: Wish, painter: Painter, is_needed: Callable[[], bool]
    ) -> tuple[str | bytes, ...]:
        """The frames of an answer; none while its shader is compiled. Raises StoppedError."""
        try:
            shot = _shot(self._shown, wish)
            if not painter.is_ready(shot):
                return ()
            picture = painter.draw(shot, lambda: is_needed() or guest.wish is None).encode("png", quick=True)
        except StoppedError:
            raise
        except Exception as error:  # its fault, the device's, or a bug in sdfc: the watch goes on
            return (text_of({"type": "refused", "request": wish.request, "text": str(error)}),)
        return text_of({"type": "picture", "request": wish.request}), picture

    def _puts_last(self, guest: Guest) -> None:
        with self._lock:
            if guest in self._guests:  # it may have left
                self._guests.remove(guest)
                self._guests.append(guest)

    def close(self) -> None:
        """Every page is let go, and the port is free."""
        self._door.close()


def _shot(shown: Shown | None, wish: Wish) -> Shot:
    """What is asked for. Raises RequestError for what the scene does not have."""
    if shown is None:
        raise RequestError("there is no picture of the scene yet")
    scene, params = shown.built.compiled.scene, shown.params
    hidden = messages.exact(shown)
    declared = tuple(p for p in scene.params if p.name not in hidden)
    given = {p.name: params[p.name] for p in declared} | dict(wish.params)
    return Shot(shown.built.compiled, wish.camera.view(), params | checked_params(declared, given), wish.size)


def _after(scene: dict[str, Any], message: Message) -> dict[str, Any]:
    """The scene as one who comes after that message is told it."""
    match message["type"]:
        case "scene":
            return dict(message)
        case "values":
            values = {**scene["values"], **message["values"]}
            params = [{**p, "default": values[p["uniform"]]} for p in scene["params"]]
            return {**scene, "values": values, "params": params}
        case _:  # a part of it, renewed
            return {**scene, **{name: value for name, value in message.items() if name in scene and name != "type"}}
