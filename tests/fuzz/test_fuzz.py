"""Whatever the text is, the command line answers: a clean error or a shader, soon, in bounded memory.

The normal run is a sample. `SDFC_FUZZ=full pytest tests/fuzz` is the whole: 10 000 byte strings, 2 000 mutated scenes.
"""

from __future__ import annotations

import os
import random
import re
import resource
import shutil
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

import pytest
from click.testing import CliRunner
from mutations import mutated, random_bytes

from sdfc.cli.verbs import command

SCENES = Path(__file__).parent.parent.parent / "scenes"
FULL = os.environ.get("SDFC_FUZZ") == "full"
BYTE_STRINGS, MUTATED = (10_000, 2_000) if FULL else (300, 100)
BUDGET = float("inf") if FULL else 25.0  # seconds, for each of the two tests of a normal run
CASE_LIMIT = 10.0  # seconds of the processor's time: other programs' load is nobody's hang
MEMORY = 2 << 30  # bytes above what the process holds already
CLEAN = (0, 1)  # exit codes: a shader, or errors of the scene


class HangError(BaseException):
    """Not an Exception, so that nothing under test can catch it."""


def _hang(_signal: int, _frame: FrameType | None) -> None:
    raise HangError(f"more than {CASE_LIMIT} s")


@pytest.fixture(autouse=True)
def bounded() -> Iterator[None]:
    """Time and memory limits for the process while the test runs."""
    before = signal.signal(signal.SIGPROF, _hang)
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + MEMORY, hard))
    yield
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
    signal.signal(signal.SIGPROF, before)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The scenes, copied: mutated ones keep their imports and tables."""
    return Path(shutil.copytree(SCENES, tmp_path / "scenes"))


def answer(path: Path, content: bytes) -> str | None:
    """What went wrong when `content` was compiled; None where the answer was clean."""
    path.write_bytes(content)
    signal.setitimer(signal.ITIMER_PROF, CASE_LIMIT)
    try:
        result = CliRunner().invoke(command, ["emit-glsl", str(path)], prog_name="sdfc")
    except HangError as error:
        return str(error)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    if result.exit_code in CLEAN and (result.exception is None or isinstance(result.exception, SystemExit)):
        said = result.output
        if result.exit_code == 0 or ": error: " in said or said.startswith("error: "):
            return None
    return f"exit {result.exit_code}, {result.exception!r}\n{result.output[-2000:]}"


def report(failures: list[tuple[bytes, str]]) -> str:
    """One example, the shortest, of each way to fail."""
    kinds: dict[str, list[bytes]] = {}
    for content, what in failures:
        kinds.setdefault(re.sub(r"/\S+|\d+", "", what), []).append(content)
    shown = [
        f"{len(found)} times, as with {min(found, key=len)[:3000]!r}\n  -> {kind}" for kind, found in kinds.items()
    ]
    return f"{len(failures)} failed\n" + "\n\n".join(shown[:12])


def test_random_bytes(folder: Path) -> None:
    chance, failures, end = random.Random(20261122), [], time.monotonic() + BUDGET
    for _ in range(BYTE_STRINGS):
        if time.monotonic() > end:
            break
        content, suffix = random_bytes(chance), chance.choice(("sdf", "csg"))
        if what := answer(folder / f"fuzz.{suffix}", content):
            failures.append((content, what))
    assert not failures, report(failures)


def test_mutated_scenes(folder: Path) -> None:
    chance, failures, end = random.Random(20261123), [], time.monotonic() + BUDGET
    scenes = sorted(p for p in folder.iterdir() if p.suffix in (".sdf", ".csg"))
    texts = [p.read_text() for p in scenes]
    for _ in range(MUTATED):
        if time.monotonic() > end:
            break
        chosen = chance.randrange(len(scenes))
        content = mutated(chance, texts[chosen], texts).encode(errors="replace")
        if what := answer(folder / f"fuzz{scenes[chosen].suffix}", content):
            failures.append((content, what))
    assert not failures, report(failures)
