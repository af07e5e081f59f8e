"""The process that compiles ahead: the driver's cache has what it made, and nothing that befalls it is felt."""

from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from sdfc.live.worker import Job, Outcome, Pass, Worker, share_cache

pytestmark = [
    pytest.mark.gpu,
    pytest.mark.usefixtures("opengl"),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Mesa's cache is known"),
]
ROOT = Path(__file__).parents[2]
PATIENCE = 60.0  # seconds, for a machine with much else to do
UNIFORMS = {"a": (0.1, 0.2, 0.3, 0.4)}
_numbers = itertools.count(1)

DRAW = """
import sys
from pathlib import Path
import numpy as np
from sdfc import pipeline
from sdfc.api.renderer import GlRenderer, Shot
from sdfc.api.request import View
from sdfc.api.source import from_path
from sdfc.live.worker import Outcome, Worker, job_of

scene, cache, out, ahead, tracer = sys.argv[1:]
def entries():
    return sorted(str(p) for p in Path(cache).rglob("*") if p.is_file() and p.name != "index")
given = from_path(Path(scene), None)
options = pipeline.Options(tracer=tracer, prepass=True)
compiled = pipeline.compile_scene(pipeline.load(given.source, given.folder, given.kind), options)
shot = Shot(compiled, View(), {p.name: p.default for p in compiled.scene.params}, (96, 54))
with Worker(print) as worker:
    before = entries()
    if ahead == "yes":
        assert worker.compile(job_of(shot, "radiance")).result() is Outcome.KEPT
        assert entries() > before
        before = entries()
    renderer = GlRenderer()
    np.save(out, renderer.radiance(shot, 0, None))
    renderer.close()
print("prepass" if compiled.plan.prepass else "plain", "new" if entries() > before else "known")
"""

PARENT = """
import sys, time
from sdfc.live.worker import Job, Pass, Worker
worker = Worker(print)
text = sys.argv[1]
try:
    future = worker.compile(Job((Pass(text),), {"a": (0.1, 0.2, 0.3, 0.4)}))
    while worker.process_id is None:
        time.sleep(0.001)
    print(worker.process_id, flush=True)
    future.result()
    print("it was not slow")
except KeyboardInterrupt:
    worker.close()
    sys.exit(130)
"""


def fragment(lines: int = 1) -> str:
    """A shader that no driver has seen; with hundreds of lines it compiles for seconds."""
    seed = f"{os.getpid()}.{next(_numbers)}"
    body = "\n".join(f"    v = sin(v.yzwx * {i}.25 + {seed});" for i in range(lines))
    return f"#version 450 core\nuniform vec4 a;\nout vec4 o;\nvoid main() {{\n    vec4 v = a;\n{body}\n    o = v;\n}}\n"


def job(lines: int = 1) -> Job:
    return Job((Pass(fragment(lines)),), UNIFORMS)


SLOW = 600  # lines


def is_there(process: int) -> bool:
    """Whether a process runs (one that is dead and waited for by nobody does not)."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def is_soon(what: Callable[[], object]) -> bool:
    until = time.monotonic() + PATIENCE
    while time.monotonic() < until:
        if what():
            return True
        time.sleep(0.005)
    return False


def entries(folder: Path) -> int:
    return sum(path.is_file() and path.name != "index" for path in folder.rglob("*"))


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which the driver of a worker keeps shaders."""
    folder = tmp_path / "cache"
    folder.mkdir()
    monkeypatch.setenv("MESA_SHADER_CACHE_DIR", str(folder))
    monkeypatch.delenv("MESA_SHADER_CACHE_DISABLE", raising=False)
    return folder


class Kept(Worker):
    """A worker whose notes are kept."""

    def __init__(self, patience: float = PATIENCE) -> None:
        self.notes: list[str] = []
        super().__init__(self.notes.append, patience)

    def busy_process(self) -> int:
        assert is_soon(lambda: self._process is not None and self._process.is_busy)
        assert self.process_id is not None
        return self.process_id


@pytest.fixture
def worker(cache: Path) -> Iterator[Kept]:
    with Kept() as made:
        yield made


def test_the_drivers_cache_has_what_was_compiled(worker: Kept, cache: Path) -> None:
    counts = [entries(cache)]
    for _ in range(3):
        assert worker.compile(job()).result(PATIENCE) is Outcome.KEPT
        counts.append(entries(cache))
    assert counts == sorted(set(counts)), "each added to it"
    assert worker.helps and not worker.notes


@pytest.mark.parametrize(
    ("scene", "tracer", "kind"),
    [("csg5", "proven", "plain"), ("blobs", "sphere", "prepass")],
)
def test_what_draws_afterwards_compiles_nothing_and_draws_the_same(
    cache: Path, tmp_path: Path, scene: str, tracer: str, kind: str
) -> None:
    """At another size than the worker's, with the cone prepass where there is one. Counted in entries of the cache."""
    pictures = []
    for ahead, found in [("no", "new"), ("yes", "known")]:
        for path in cache.rglob("*"):
            if path.is_file():
                path.unlink()
        out = tmp_path / f"{ahead}.npy"
        arguments = [str(ROOT / "scenes" / f"{scene}.sdf"), str(cache), str(out), ahead, tracer]
        done = subprocess.run(
            [sys.executable, "-c", DRAW, *arguments], capture_output=True, text=True, timeout=PATIENCE
        )
        assert (done.stdout, done.stderr) == (f"{kind} {found}\n", "")
        pictures.append(out.read_bytes())
    assert pictures[0] == pictures[1]


def test_what_the_driver_refuses_is_told_by_whoever_draws(worker: Kept) -> None:
    broken = Job((Pass(fragment().replace("o = v", "o = w")),), UNIFORMS)
    assert worker.compile(broken).result(PATIENCE) is Outcome.REFUSED
    without_values = Job((Pass(fragment()),), {})
    assert worker.compile(without_values).result(PATIENCE) is Outcome.REFUSED
    assert worker.compile(job()).result(PATIENCE) is Outcome.KEPT
    assert not worker.notes


def test_a_text_of_megabytes(worker: Kept) -> None:
    long = Job((Pass(fragment() + "// much to say\n" * 200_000),), UNIFORMS)
    assert worker.compile(long).result(PATIENCE) is Outcome.KEPT


def test_whoever_waits_is_called(worker: Kept) -> None:
    told: list[Outcome] = []
    futures = [worker.compile(job()) for _ in range(3)]
    futures[-1].add_done_callback(lambda future: told.append(future.result()))
    assert futures[-1].result(PATIENCE) is Outcome.KEPT
    assert all(future.done() for future in futures), "one after the other"
    assert is_soon(lambda: told) and told == [Outcome.KEPT]


def test_one_that_waits_can_be_cancelled(worker: Kept) -> None:
    slow, other = worker.compile(job(SLOW)), worker.compile(job())
    worker.busy_process()
    assert other.cancel()
    worker.stop()
    assert slow.result(PATIENCE) is Outcome.LOST
    assert not worker.notes


def test_after_a_stop_the_next_has_a_fresh_process(worker: Kept) -> None:
    slow = worker.compile(job(SLOW))
    first = worker.busy_process()
    worker.stop()
    assert slow.result(PATIENCE) is Outcome.LOST
    assert worker.compile(job()).result(PATIENCE) is Outcome.KEPT
    assert worker.process_id != first and not is_there(first)
    worker.stop()  # nothing is in hand: no effect
    assert worker.compile(job()).result(PATIENCE) is Outcome.KEPT
    assert worker.helps and not worker.notes


def test_one_that_is_killed_is_replaced(worker: Kept) -> None:
    future = worker.compile(job(SLOW))
    os.kill(worker.busy_process(), signal.SIGKILL)
    assert future.result(PATIENCE) is Outcome.LOST
    assert len(worker.notes) == 1 and "died (exit code -9)" in worker.notes[0]
    assert worker.compile(job()).result(PATIENCE) is Outcome.KEPT


def test_one_that_hangs_is_killed(cache: Path) -> None:
    with Kept(patience=1.0) as worker:
        future = worker.compile(job(SLOW))
        process = worker.busy_process()
        os.kill(process, signal.SIGSTOP)
        assert future.result(PATIENCE) is Outcome.LOST
        assert "took more than 1 s" in worker.notes[0]
        assert not is_there(process)


def test_after_two_in_a_row_it_is_left_alone(worker: Kept) -> None:
    for _ in range(2):
        assert worker.helps
        future = worker.compile(job(SLOW))
        os.kill(worker.busy_process(), signal.SIGKILL)
        assert future.result(PATIENCE) is Outcome.LOST
    assert not worker.helps and worker.process_id is None
    assert worker.compile(job()).result(0.0) is Outcome.LOST
    assert ["that shader" in note for note in worker.notes] == [True, False]


def test_a_driver_without_a_cache_is_not_asked_twice(
    worker: Kept, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MESA_SHADER_CACHE_DISABLE", "true")
    assert worker.compile(job()).result(PATIENCE) is Outcome.NOT_KEPT
    assert not worker.helps and entries(cache) == 0
    assert worker.compile(job()).result(PATIENCE) is Outcome.LOST
    assert is_soon(lambda: worker.process_id is None)


@pytest.mark.parametrize("lines", [1, SLOW])
def test_nothing_is_left_after_close(cache: Path, lines: int) -> None:
    worker = Kept()
    futures = [worker.compile(job(lines)) for _ in range(3)]
    process = worker.busy_process()
    worker.close()
    worker.close()
    assert not Path(f"/proc/{process}").exists(), "no process, and nobody who waits for one"
    assert all(future.done() for future in futures)
    assert worker.process_id is None and not worker.notes
    assert worker.compile(job()).result(0.0) is Outcome.LOST


def test_one_that_was_never_asked_starts_nothing(cache: Path) -> None:
    with Kept() as worker:
        assert worker.process_id is None


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGKILL, -9), (signal.SIGTERM, -15)])
def test_it_ends_with_its_parent(cache: Path, number: signal.Signals, code: int) -> None:
    """In the middle of a long compile; the signal goes to all of the group, as Ctrl-C in a terminal does."""
    parent = subprocess.Popen(
        [sys.executable, "-c", PARENT, fragment(SLOW)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert parent.stdout is not None
    process = int(parent.stdout.readline())
    assert is_soon(lambda: entries_of_threads(process, "llvmpipe") or not is_there(process)), "it has a device"
    os.killpg(parent.pid, number)
    said = parent.communicate(timeout=PATIENCE)
    assert (parent.returncode, *said) == (code, "", "")
    assert is_soon(lambda: not is_there(process))


def entries_of_threads(process: int, name: str) -> list[Path]:
    """The threads of a process whose name has this in it."""
    return [path for path in Path(f"/proc/{process}/task").glob("*/comm") if name in path.read_text()]


def test_the_folder_is_ours_unless_the_user_says_otherwise(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("MESA_SHADER_CACHE_DIR", "MESA_GLSL_CACHE_DIR", "MESA_SHADER_CACHE_MAX_SIZE"):
        monkeypatch.setenv(name, "")
    monkeypatch.setenv("SDFC_CACHE_DIR", str(tmp_path))
    share_cache()
    assert os.environ["MESA_SHADER_CACHE_DIR"] == str(tmp_path / "gl") and (tmp_path / "gl").is_dir()
    monkeypatch.setenv("MESA_SHADER_CACHE_DIR", "/their/own")
    share_cache()
    assert os.environ["MESA_SHADER_CACHE_DIR"] == "/their/own"
    monkeypatch.setenv("MESA_SHADER_CACHE_DIR", "")
    monkeypatch.setenv("SDFC_CACHE_DIR", "/dev/null/nowhere")
    share_cache()
    assert os.environ["MESA_SHADER_CACHE_DIR"] == ""
