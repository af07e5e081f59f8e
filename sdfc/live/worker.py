"""A process that compiles shaders ahead, so that this one finds them finished in the driver's cache.

OpenGL drivers compile in the process that draws, and hold Python's lock meanwhile: no thread can hide it. Mesa keeps
what it has compiled in a folder, which another process may fill: then to load a shader takes milliseconds (GL.md 1).
Other drivers may keep nothing, or not for other processes; there (the worker looks for Mesa's cache) `helps` turns
False with the first job, and whoever draws compiles, as without a worker.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import asdict, dataclass
from enum import Enum
from types import TracebackType
from typing import TYPE_CHECKING, Self

from sdfc import cache
from sdfc.api.renderer import is_near
from sdfc.gpu.program import COVERING

if TYPE_CHECKING:
    from sdfc.api.renderer import Shot
    from sdfc.gpu.program import Value

_PATIENCE = 120.0  # seconds for one job
_MOST_LOST = 2  # jobs, then it is left alone
_OWN_SETTINGS = ("MESA_SHADER_CACHE_DIR", "MESA_GLSL_CACHE_DIR")  # of a user who says where Mesa keeps shaders
_LARGEST = "256M"  # of our folder


class Outcome(Enum):
    """What became of a job. Whoever draws does the same after each: it makes the program, and sees what is wrong."""

    KEPT = "kept"  # the driver's cache has it: this process loads it in milliseconds
    NOT_KEPT = "not kept"  # it was compiled for nothing: this driver has no cache
    REFUSED = "refused"  # the driver, or the device, failed
    LOST = "lost"  # the process died, took too long or was told to stop; or there is none


@dataclass(frozen=True, slots=True)
class Pass:
    """A program, and how many images it draws at once. It reads the image of the pass before it as texture 0."""

    fragment: str
    vertex: str = COVERING
    attachments: int = 1


@dataclass(frozen=True, slots=True)
class Job:
    """The programs of one picture, in the order in which they are drawn, and their uniforms (of all of them)."""

    passes: tuple[Pass, ...]
    uniforms: Mapping[str, Value]


def job_of(shot: Shot, entry: str, attachments: int = 1) -> Job:
    """What `GlRenderer` will need for the shot: the cone prepass, where the plan has one, and the entry."""
    compiled = shot.compiled
    uniforms = compiled.uniforms(shot.view, shot.params, shot.size)
    last = Pass(compiled.glsl(entry, "fragment", is_near(uniforms)), compiled.vertex(), attachments)
    cone = (Pass(compiled.glsl("cone")),) if compiled.plan.prepass else ()
    return Job((*cone, last), uniforms)


def share_cache() -> None:
    """Let Mesa keep compiled shaders in a folder of ours, unless the user has set one. Of use before any OpenGL."""
    if any(os.environ.get(name) for name in _OWN_SETTINGS):
        return
    folder = cache.folder() / "gl"
    with contextlib.suppress(OSError):  # then Mesa keeps them where it always does
        folder.mkdir(parents=True, exist_ok=True)
        os.environ["MESA_SHADER_CACHE_DIR"] = str(folder)
        os.environ.setdefault("MESA_SHADER_CACHE_MAX_SIZE", _LARGEST)


class Worker:
    """Compiles jobs, one after the other, in a process that is started for the first of them.

    Make it before any device is opened in this process. `note` is told, once for each, what became of a process that
    died or hung; callbacks of the futures are called in a thread of the worker's.
    """

    def __init__(self, note: Callable[[str], None], patience: float = _PATIENCE) -> None:
        share_cache()
        self.helps = sys.platform.startswith("linux")  # while it is worth asking
        self._note = note
        self._patience = patience
        self._jobs: queue.SimpleQueue[tuple[Job, Future[Outcome]] | None] = queue.SimpleQueue()
        self._lock = threading.Lock()  # of the three below
        self._process: _Process | None = None
        self._closed = False
        self._stopped = False  # the job in hand was told to stop
        self._lost = 0
        self._thread = threading.Thread(target=self._run, name="sdfc worker", daemon=True)

    @property
    def process_id(self) -> int | None:
        """Of the process, while there is one."""
        with self._lock:
            return None if self._process is None else self._process.id

    def compile(self, job: Job) -> Future[Outcome]:
        """Have a job compiled after those that wait already. The future never raises; what waits can be cancelled."""
        future: Future[Outcome] = Future()
        if self._closed or not self.helps:
            future.set_result(Outcome.LOST)
            return future
        self._jobs.put((job, future))
        with self._lock:
            if not self._thread.is_alive():
                self._thread.start()
        return future

    def stop(self) -> None:
        """Give the job in hand up, if there is one: the next has a fresh process at once."""
        with self._lock:
            if self._process is not None and self._process.is_busy:
                self._stopped = True
                self._process.kill()

    def close(self) -> None:
        """End the process, whatever it does. Futures that are not done are cancelled or LOST."""
        with self._lock:
            self._closed = True
            if self._process is not None:
                self._process.kill()
        self._jobs.put(None)
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        """The thread: jobs, as they come. The process ends when this thread does."""
        try:
            while (item := self._jobs.get()) is not None:
                job, future = item
                if self._closed:
                    future.cancel()
                if future.set_running_or_notify_cancel():
                    future.set_result(self._asked(job))
        finally:
            self._end()

    def _asked(self, job: Job) -> Outcome:
        if not self.helps:
            return Outcome.LOST
        try:
            process = self._started()
            outcome = Outcome(process.ask(job, self._patience))
        except Exception as error:  # whatever it is: somebody waits to be told
            self._fails(error)
            return Outcome.LOST
        self._lost = 0
        if outcome is Outcome.NOT_KEPT:
            self.helps = False
            self._end()
        return outcome

    def _started(self) -> _Process:
        with self._lock:
            if self._closed:
                raise OSError("closed")
            if self._stopped and self._process is not None:  # it was killed after it had answered
                self._process.end()
                self._process = None
            self._stopped = False
            if self._process is None:
                self._process = _Process()
            return self._process

    def _fails(self, error: Exception) -> None:
        """The process is of no use any more. Not worth a word where it was we who ended it."""
        code = self._end()
        if self._closed or self._stopped:
            return
        self._lost += 1
        self.helps = self._lost < _MOST_LOST
        what = f"took more than {self._patience:g} s" if isinstance(error, TimeoutError) else f"died (exit code {code})"
        with contextlib.suppress(OSError):  # nobody reads it: whoever waits for the job is told all the same
            self._note(
                f"the process that compiles shaders ahead {what}; this one compiles "
                + ("that shader" if self.helps else "all shaders")
            )

    def _end(self) -> int | None:
        with self._lock:
            process, self._process = self._process, None
        return None if process is None else process.end()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()


class _Process:
    """`sdfc.live.ahead` in a process of its own, and the channel to it."""

    def __init__(self) -> None:
        self._channel, theirs = socket.socketpair()
        # The parent's modules, and no others: the folder in which a user stands may have files of any name.
        program = f"import sys; sys.path[:] = {sys.path!r}; from sdfc.live.ahead import main; main()"
        with theirs:
            self._popen = subprocess.Popen(
                [sys.executable, "-P", "-c", program],
                stdin=theirs.fileno(),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                process_group=0,  # Ctrl-C is for the parent
            )
        self.is_busy = False

    @property
    def id(self) -> int:
        return self._popen.pid

    def ask(self, job: Job, seconds: float) -> str:
        """The answer, without its line's end. Raises OSError (TimeoutError) where there is none."""
        self.is_busy = True
        self._channel.settimeout(seconds)
        text = {"passes": [asdict(each) for each in job.passes], "uniforms": dict(job.uniforms)}
        self._channel.sendall(json.dumps(text).encode() + b"\n")
        answer = b""
        while not answer.endswith(b"\n"):
            received = self._channel.recv(4096)
            if not received:
                raise ConnectionResetError("the process is gone")
            answer += received
        self.is_busy = False
        return answer.decode().strip()

    def kill(self) -> None:
        self._popen.kill()

    def end(self) -> int:
        """Its exit code. It is killed if it runs."""
        self._channel.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            return self._popen.wait(0.2)  # it may be dying: then its own code is the one to tell
        self._popen.kill()
        return self._popen.wait()
