"""The command as a process: pipes, signals, starting."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

COMMAND = [sys.executable, "-m", "sdfc"]
SLOW = ("--size", "1600x1200", "--samples", "5000")
SCENE = "scene { sphere(0.5) - box(size: [0.2, 2, 0.2]) }\n"


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A scene's file."""
    path = tmp_path / "s.sdf"
    path.write_text(SCENE)
    return path


def run(*arguments: str | Path, stdin: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run([*COMMAND, *map(str, arguments)], input=stdin, capture_output=True, text=True, timeout=60)


def test_the_version_imports_neither_numpy_nor_opengl_nor_grammars() -> None:
    loaded = "import sys; from sdfc.cli.verbs import command; print(*[m for m in {} if m in sys.modules])".format(
        ("numpy", "moderngl", "lark", "jinja2", "sdfc.pipeline", "sdfc.api", "sdfc.cli.render")
    )
    done = subprocess.run([sys.executable, "-c", loaded], capture_output=True, text=True, timeout=60)
    assert done.stdout.strip() == ""
    assert run("--version").stdout == f"sdfc {_version()}\n"


def _version() -> str:
    import sdfc

    return sdfc.__version__


def test_emitting_opens_no_device(scene: Path) -> None:
    script = (
        "import sys; from sdfc.api import compile; compile(sys.argv[1]).glsl();"
        " print(*[m for m in ('moderngl', 'sdfc.gpu.device') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script, str(scene)], capture_output=True, text=True, timeout=60)
    assert (done.stdout.strip(), done.stderr) == ("", "")


@pytest.mark.parametrize(
    ("verb", "unwanted"),
    [
        (("emit-glsl",), {"numpy", "moderngl", "PIL", "sdfc.api.renderer", "sdfc.syntax.mistakes"}),
        (("check",), {"numpy", "moderngl", "jinja2", "sdfc.api.renderer", "sdfc.glsl", "importlib.resources"}),
    ],
)
def test_a_verb_imports_nothing_heavy_that_it_does_not_need(scene: Path, verb: tuple[str], unwanted: set[str]) -> None:
    run(*verb, scene)  # the grammar's tables are there now
    script = (
        "import sys; from sdfc.cli.verbs import command; command.main(sys.argv[1:], standalone_mode=False);"
        f"print('---', *sorted({unwanted!r} & sys.modules.keys()))"
    )
    done = subprocess.run([sys.executable, "-c", script, *verb, scene], capture_output=True, text=True, timeout=60)
    assert (done.stdout.splitlines()[-1].strip(), done.stderr) == ("---", "")


def test_a_reader_that_leaves_is_no_failure(scene: Path) -> None:
    command = f"{' '.join(COMMAND)} check {scene} --show glsl | head -1; echo ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60)
    assert done.stdout == "#version 450 core\n0\n"
    assert done.stderr == ""


@pytest.mark.gpu
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_stopped_while_rendering_it_leaves_nothing(
    scene: Path, opengl: None, number: signal.Signals, code: int
) -> None:
    arguments = [*COMMAND, "render", str(scene), "-o", str(scene.with_name("out.png")), *SLOW]
    process = subprocess.Popen(arguments, stderr=subprocess.PIPE, text=True)
    time.sleep(1.5)
    assert process.poll() is None, "it is still rendering"
    process.send_signal(number)
    _, told = process.communicate(timeout=20)
    assert process.returncode == code
    assert "Traceback" not in told
    assert os.listdir(scene.parent) == ["s.sdf"]


@pytest.mark.gpu
def test_no_progress_in_a_pipe(scene: Path, opengl: None) -> None:
    done = run("render", scene, "-o", scene.with_name("out.png"), "--size", "400x300", "--samples", "60")
    assert (done.returncode, done.stderr, done.stdout) == (0, "", "")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission(scene: Path) -> None:
    scene.parent.chmod(0o555)
    try:
        done = run("render", scene, "-o", scene.with_name("out.png"))
    finally:
        scene.parent.chmod(0o755)
    assert done.returncode == 2
    assert done.stderr == f"error: cannot write '{scene.with_name('out.png')}': permission denied\n"


def test_completion_completes_verbs_and_options(scene: Path) -> None:
    environment = {**os.environ, "_SDFC_COMPLETE": "bash_complete", "COMP_WORDS": "sdfc em", "COMP_CWORD": "1"}
    script = "from sdfc.cli import main; main()"
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, timeout=60)
    assert done.stdout.split() == ["plain,emit-glsl"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full here")
@pytest.mark.parametrize("arguments", [["list"], ["emit-glsl", "s.sdf"], ["emit-glsl", "s.sdf", "-o", "/dev/full"]])
def test_a_full_disk_is_an_error_and_no_bug(arguments: list[str], tmp_path: Path) -> None:
    (tmp_path / "s.sdf").write_text("scene { sphere(radius: 1) }")
    with open("/dev/full", "wb") as full:
        result = subprocess.run(
            [sys.executable, "-m", "sdfc", *arguments], stdout=full, stderr=subprocess.PIPE, cwd=tmp_path, text=True
        )
    assert result.returncode == 2
    assert "No space left on device" in result.stderr and "bug" not in result.stderr and "None" not in result.stderr


def test_a_closed_standard_output_is_no_bug(tmp_path: Path) -> None:
    command = f"{sys.executable} -m sdfc list tracers >&-"
    result = subprocess.run(["sh", "-c", command], stderr=subprocess.PIPE, cwd=tmp_path, text=True)
    assert (result.returncode, result.stderr) == (0, "")
