"""An offscreen OpenGL context, opened here and closed by whoever opened it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from sdfc.diagnostics import DeviceError

if TYPE_CHECKING:
    import moderngl

_INSTALL_COMMAND = "apt-get install --no-install-recommends libegl1 libgl1 libgl1-mesa-dri"
MINIMUM_VERSION = 450  # `#version 450` is what the emitter writes for this device

# The versioned names are those that the run-time packages install (the plain ones come with the -dev packages only);
# naming them also spares moderngl's search, which runs ldconfig and gcc.
_EGL_LIBRARIES: tuple[dict[str, str], ...] = (
    {"libgl": "libGL.so.1", "libegl": "libEGL.so.1"},
    {"libgl": "libOpenGL.so.0", "libegl": "libEGL.so.1"},
)


@dataclass(frozen=True, slots=True, eq=False)
class Device:
    """An open OpenGL context with no window. Use it as a context manager, or call `close`."""

    context: moderngl.Context
    vendor: str
    renderer: str
    version: str
    libraries: str  # what was loaded, for `doctor`
    _closed: list[bool] = field(default_factory=list)

    @property
    def is_llvmpipe(self) -> bool:
        """Whether this is Mesa's software rasteriser: the CPU, running GLSL."""
        return "llvmpipe" in self.renderer

    @property
    def max_size(self) -> int:
        """The widest and highest frame, in pixels."""
        limits: tuple[int, ...] = (self.context.info["GL_MAX_TEXTURE_SIZE"], *self.context.info["GL_MAX_VIEWPORT_DIMS"])
        return min(limits)

    @property
    def max_attachments(self) -> int:
        """How many colour attachments a frame may have."""
        count: int = self.context.info["GL_MAX_COLOR_ATTACHMENTS"]
        return count

    def make_current(self) -> None:
        """Let what is called next be for this context: there may be others in the process, of ours or of the caller."""
        self.context.__enter__()  # type: ignore[no-untyped-call]

    def check(self, doing: str) -> None:
        """Raise DeviceError if OpenGL has reported an error since the last check."""
        error = self.context.error
        if error != "GL_NO_ERROR":
            raise DeviceError(f"{self.renderer} failed while {doing}: {error}")

    def close(self) -> None:
        """Give the context back. Closing twice is harmless."""
        if not self._closed:
            self._closed.append(True)
            self.make_current()
            self.context.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()


def _attempts() -> Iterator[tuple[str, dict[str, str]]]:
    """What to try, best first: a description and moderngl's settings."""
    if sys.platform.startswith("linux"):
        for libraries in _EGL_LIBRARIES:
            yield f"EGL with {libraries['libgl']} and {libraries['libegl']}", {"backend": "egl", **libraries}
    else:
        yield "the platform's own OpenGL", {}


def _create(settings: dict[str, str]) -> moderngl.Context:
    import moderngl

    # moderngl's annotations know neither `backend` nor the library names, which go to glcontext.
    return moderngl.create_standalone_context(require=MINIMUM_VERSION, **settings)  # type: ignore[arg-type]


def open_device() -> Device:
    """Open the first OpenGL (4.5 or later) that works without a window. The DeviceError says what to install."""
    failures: list[str] = []
    for description, settings in _attempts():
        try:
            context = _create(settings)
        except Exception as error:  # moderngl raises bare Exception for everything that can be wrong
            failures.append(f"{description}: {str(error).strip() or type(error).__name__}")
            continue
        info: dict[str, Any] = context.info
        return Device(context, info["GL_VENDOR"], info["GL_RENDERER"], info["GL_VERSION"], description)
    command = install_command()
    advice = [f"  to install it: {command}"] if command else []
    raise DeviceError("\n".join(["no usable OpenGL 4.5", *(f"  tried {failure}" for failure in failures), *advice]))


def install_command() -> str | None:
    """What installs a software OpenGL, where that is known."""
    return _INSTALL_COMMAND if sys.platform.startswith("linux") else None


@contextmanager
def device_errors(device: Device, doing: str) -> Iterator[None]:
    """Whatever moderngl raises inside (out of memory, a lost device) becomes a DeviceError that names the device."""
    import moderngl

    try:
        yield
    except moderngl.Error as error:
        raise DeviceError(f"{device.renderer} failed while {doing}: {error}") from error
    device.check(doing)
