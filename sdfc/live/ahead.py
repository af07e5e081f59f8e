"""The process that compiles shaders ahead: what `sdfc.live.worker` starts, and talks to over standard input.

A line of JSON comes for every job (`passes`: fragment, vertex, attachments; `uniforms`); a line goes back with what
became of it. The end of the input is the end of the process.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import signal
import socket
import sys
import time
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from sdfc.diagnostics import DeviceError, InternalError
from sdfc.gpu.device import Device, open_device
from sdfc.gpu.frame import Frame
from sdfc.gpu.program import FragmentProgram

_SIDE = 16  # pixels: enough to be drawn, and so compiled
_WRITING = 2.0  # seconds that the driver may take to write what it compiled
_PR_SET_PDEATHSIG = 1


def main() -> None:
    """Answer jobs until the other side is gone."""
    _die_with_parent()
    channel = socket.socket(fileno=os.dup(0))
    device = open_device()
    with channel, channel.makefile("r", encoding="utf-8") as jobs:
        for line in jobs:
            answer = _answer(device, json.loads(line))
            try:
                channel.sendall(f"{answer}\n".encode())
            except OSError:  # nobody waits any more
                return


def _answer(device: Device, job: Mapping[str, Any]) -> str:
    """The value of an `Outcome`."""
    try:
        _draw(device, job)
    except (InternalError, DeviceError):  # whoever draws the picture will see it, with the places
        return "refused"
    return "kept" if _is_kept() else "not kept"


def _draw(device: Device, job: Mapping[str, Any]) -> None:
    """Draw the passes as `GlRenderer` does, each reading the image of the one before it: drivers compile for that."""
    uniforms = {name: tuple(v) if isinstance(v, list) else v for name, v in job["uniforms"].items()}
    with ExitStack() as stack:
        for each in job["passes"]:
            program = FragmentProgram(device, each["fragment"], each["vertex"])
            stack.callback(program.release)
            frame = stack.enter_context(Frame(device, _SIDE, _SIDE, each["attachments"]))
            frame.draw_whole(program, uniforms)
            frame.bind()


def _is_kept() -> bool:
    """Whether what was compiled is where other processes find it; waits until it is.

    Mesa writes its cache in threads named `...:disk$N`, which sleep when there is nothing left to write. Where there
    are none, the driver has no such cache, or it is switched off.
    """
    until = time.monotonic() + _WRITING
    while states := _states_of("disk$"):
        if all(state == "S" for state in states):
            return True
        if time.monotonic() > until:
            return False
        time.sleep(0.001)
    return False


def _states_of(name: str) -> list[str]:
    """What the threads of this process that have this in their names do: S sleep, R run, D wait for a disk."""
    found = []
    for file in Path("/proc/self/task").glob("*/stat"):
        with contextlib.suppress(OSError):  # a thread that has just ended
            head, _, tail = file.read_text().rpartition(")")
            if name in head:
                found.append(tail.split()[0])
    return found


def _die_with_parent() -> None:
    """End with the thread that started this, at once: a compile that runs would not see the end of the input."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
