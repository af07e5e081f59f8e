"""What README.md and docs/adding.md show runs as it is shown: the commands, the scenes, the Python."""

from __future__ import annotations

import itertools
import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from click import Context

from sdfc.cli import verbs

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
PAGES = (README, ROOT / "docs" / "adding.md")
NEED_OPENGL = ("doctor", "stress")


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of that language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)


def commands() -> list[str]:
    """Every `sdfc` line of the README's shell blocks, without its comment."""
    lines = "\n".join(blocks(README, "sh")).splitlines()
    return [line.split("  #")[0].strip() for line in lines if line.startswith("sdfc ")]


SCENES = [(page.name, text) for page in PAGES for text in blocks(page, "sdf")]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder like the repository's, to run commands in."""
    shutil.copytree(ROOT / "scenes", tmp_path / "scenes")
    return tmp_path


def is_endless(command: str) -> bool:
    return command.startswith("sdfc watch ")


@pytest.mark.parametrize("command", list(filter(is_endless, commands())))
def test_commands_that_go_on_for_ever(command: str, folder: Path) -> None:
    """They say what they have made, and go on until they are interrupted."""
    free = command.replace("--serve", "--serve=0")  # any port: the one that is meant may be taken here
    program = [sys.executable, "-m", "sdfc", *shlex.split(free)[1:]]
    with subprocess.Popen(program, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        said = next((line for line in process.stdout if "shader: " in line), "")
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 130
    assert "shader: " in said
    for made in re.findall(r"-o (\S+)", command):
        assert (folder / made).stat().st_size > 0


@pytest.mark.parametrize("command", list(itertools.filterfalse(is_endless, commands())))
def test_commands(command: str, folder: Path) -> None:
    program = [sys.executable, "-m", "sdfc"]
    done = subprocess.run(
        [*program, *shlex.split(command)[1:]], cwd=folder, capture_output=True, text=True, timeout=120
    )
    fine = (0, 3) if command.split()[1] in NEED_OPENGL else (0,)  # 3: there is none, which they say
    assert done.returncode in fine, done.stdout + done.stderr
    for made in re.findall(r"-o (\S+)", command):
        assert (folder / made).stat().st_size > 0


@pytest.mark.parametrize(("page", "text"), SCENES, ids=[f"{page}-{n}" for n, (page, _) in enumerate(SCENES)])
def test_scenes(page: str, text: str, folder: Path) -> None:
    (folder / "shown.sdf").write_text(text)
    program = [sys.executable, "-m", "sdfc"]
    done = subprocess.run([*program, "emit-glsl", "shown.sdf"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, f"{page}:\n{done.stdout}{done.stderr}"
    assert "warning" not in done.stderr


def test_python(folder: Path) -> None:
    (text,) = blocks(README, "python")
    done = subprocess.run([sys.executable, "-c", text], cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def test_the_two_commands_are_shown() -> None:
    shown = "\n".join(blocks(README, "sh"))
    assert "pip install . && sdfc render scenes/die.sdf -o die.png" in shown
    assert "pip install -e '.[test]' && pytest" in shown


def test_every_verb_is_shown() -> None:
    text = README.read_text()
    assert [name for name in verbs.command.list_commands(Context(verbs.command)) if f"sdfc {name}" not in text] == []


def test_links_and_pictures_exist() -> None:
    for page in (README, *(ROOT / "docs").glob("*.md"), ROOT / "CONTRIBUTING.md"):
        for target in re.findall(r"\]\(([^)#:]+)\)|src=\"([^\":]+)\"", page.read_text()):
            assert (page.parent / (target[0] or target[1])).exists(), f"{page.name}: {target}"


def test_every_scene_is_described() -> None:
    text = README.read_text()
    scenes = [p.name for p in (ROOT / "scenes").iterdir() if p.suffix in (".sdf", ".csg")]
    assert [name for name in scenes if f"`{name}`" not in text] == []
