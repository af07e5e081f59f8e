"""What `sdfc doctor` finds out."""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path

from sdfc.cache import folder as cache_folder
from sdfc.diagnostics import DeviceError
from sdfc.gpu.device import Device, install_command, open_device
from sdfc.gpu.examine import Finding
from sdfc.gpu.examine import examine as try_device


@dataclass(frozen=True, slots=True)
class Health:
    """The machine, as sdfc sees it."""

    versions: dict[str, str]
    device: dict[str, str]
    folders: dict[str, str]
    trials: tuple[Finding, ...] = ()
    failure: str | None = None
    install: str | None = field(default=None)
    """The command that installs what is missing, where that is known."""

    @property
    def is_usable(self) -> bool:
        """Whether scenes can be rendered with OpenGL here."""
        return self.failure is None and all(trial.works for trial in self.trials)

    @property
    def verdict(self) -> str:
        """All of it in a line or a few."""
        if self.is_usable:
            return "all is well: scenes render with OpenGL"
        lines = [self.failure or "this OpenGL does not do what sdfc needs"]
        lines += [f"to install what is missing:\n  {self.install}"] if self.install else []
        return "\n".join([*lines, "until then scenes render with NumPy on the CPU, which is much slower"])


def examine() -> Health:
    """Look at the machine: versions, the OpenGL device and what works there, cache folders."""
    versions = {"sdfc": _version("sdfc"), "python": f"{platform.python_version()} on {platform.platform()}"}
    versions |= {name: _version(name) for name in ("moderngl", "numpy", "lark", "jinja2", "click")}
    try:
        device = open_device()
    except DeviceError as error:
        failure = "\n".join(line for line in str(error).splitlines() if "to install" not in line)
        return Health(versions, {"opengl": "none"}, _folders(), failure=failure, install=install_command())
    with device:
        return Health(versions, _described(device), _folders(), try_device(device))


def _described(device: Device) -> dict[str, str]:
    kind = "a software rasteriser on the CPU" if device.is_llvmpipe else "a GPU"
    return {
        "opengl": device.version,
        "renderer": f"{device.renderer} ({kind})",
        "vendor": device.vendor,
        "libraries": device.libraries,
        "largest frame": f"{device.max_size} pixels across",
    }


def _folders() -> dict[str, str]:
    """Where compiled shaders and grammars are kept between runs."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    mesa = Path(os.environ.get("MESA_SHADER_CACHE_DIR") or cache) / "mesa_shader_cache"
    disabled = os.environ.get("MESA_SHADER_CACHE_DISABLE", "").lower() in ("1", "true")
    return {"driver's cache": "switched off" if disabled else _state(mesa), "sdfc's cache": _state(cache_folder())}


def _state(folder: Path) -> str:
    if not folder.exists():
        return f"{folder} (not there yet)"
    return f"{folder}" if os.access(folder, os.W_OK) else f"{folder} (cannot be written)"


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"
