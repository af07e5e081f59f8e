"""Where a measurement was made: every number in it means something only beside these."""

from __future__ import annotations

import datetime
import os
import platform
import subprocess
from pathlib import Path

from sdfc import __version__
from sdfc.gpu.device import Device


def described(device: Device) -> dict[str, str]:
    """The machine, the driver (Mesa's version and LLVM's are in its names), and what of sdfc was measured."""
    return {
        "cpu": f"{_cpu()}, {os.cpu_count()} cores",
        "system": platform.platform(),
        "renderer": device.renderer,
        "opengl": device.version,
        "vendor": device.vendor,
        "python": platform.python_version(),
        "sdfc": __version__,
        "commit": commit(),
        "date": now(),
    }


def now() -> str:
    """The time, to the second, in UTC."""
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")


def commit() -> str:
    """The checkout that sdfc runs from, with a `+` where its files were changed since; `unknown` outside one."""
    folder = Path(__file__).parent
    try:
        found = _git(folder, "rev-parse", "--short=12", "HEAD")
        return found + ("+" if _git(folder, "status", "--porcelain", "--untracked-files=no") else "")
    except (OSError, subprocess.SubprocessError):
        return "unknown"


def _git(folder: Path, *arguments: str) -> str:
    command = ["git", "-C", str(folder), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
