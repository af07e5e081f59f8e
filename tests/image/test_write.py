"""Files are there whole or not at all."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from sdfc.image import write as writing
from sdfc.image.write import OutputError, check_writable, write, write_all


def test_a_file_is_written_and_replaced_with_nothing_beside_it(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    write(path, b"one")
    write(path, b"two")
    assert path.read_bytes() == b"two"
    assert os.listdir(tmp_path) == ["a.png"]


def test_a_new_file_has_the_rights_of_the_umask(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write(tmp_path / "a", b"")
    finally:
        os.umask(before)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_a_failure_leaves_the_old_files_and_no_debris(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: BaseException
) -> None:
    (tmp_path / "a").write_bytes(b"old")

    synced = 0

    def fail_at_the_second(_: int) -> None:
        nonlocal synced
        synced += 1
        if synced == 2:
            raise failure

    monkeypatch.setattr(writing.os, "fsync", fail_at_the_second)
    with pytest.raises((OutputError, KeyboardInterrupt)):
        write_all({tmp_path / "a": b"new", tmp_path / "b": b"new"})
    assert os.listdir(tmp_path) == ["a"]
    assert (tmp_path / "a").read_bytes() == b"old"


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to("real")
    write(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_devices_are_written_to_and_never_replaced(tmp_path: Path) -> None:
    write(Path(os.devnull), b"gone")
    assert not Path(os.devnull).is_file()


def test_what_cannot_be_written_is_one_clear_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    cases = {
        tmp_path / "absent" / "a.png": f"there is no folder '{tmp_path / 'absent'}'",
        tmp_path / "file" / "a.png": f"'{tmp_path / 'file'}' is not a folder",
        tmp_path: "it is a folder",
    }
    for path, message in cases.items():
        with pytest.raises(OutputError) as caught:
            check_writable(path)
        assert str(caught.value) == f"cannot write '{path}': {message}"


def test_killed_while_writing_there_is_no_half_file(tmp_path: Path) -> None:
    script = textwrap.dedent("""
        import sys
        from pathlib import Path
        from sdfc.image.write import write
        print("ready", flush=True)
        while True:
            write(Path(sys.argv[1]), bytes(3_000_000))
    """)
    path = tmp_path / "a.png"
    for _ in range(3):
        process = subprocess.Popen([sys.executable, "-c", script, str(path)], stdout=subprocess.PIPE)
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(0.05)
        process.send_signal(signal.SIGKILL)
        process.wait()
        process.stdout.close()
        assert not path.exists() or path.stat().st_size == 3_000_000
