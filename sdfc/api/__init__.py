"""The Python interface: compile a scene, render it, get its GLSL. The command line is made of the same calls."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sdfc.api.animation import Sweep
    from sdfc.api.program import Program, compile, load
    from sdfc.api.request import RequestError, View
    from sdfc.image.picture import AOVS, Image

__all__ = ["AOVS", "Image", "Program", "RequestError", "Sweep", "View", "compile", "load"]

_HOMES = {
    **dict.fromkeys(("Program", "compile", "load"), "sdfc.api.program"),
    **dict.fromkeys(("RequestError", "View"), "sdfc.api.request"),
    **dict.fromkeys(("AOVS", "Image"), "sdfc.image.picture"),
    "Sweep": "sdfc.api.animation",
}


def __getattr__(name: str) -> Any:
    """The public names, imported when first asked for: a scene is checked without what draws it."""
    if name not in _HOMES:
        raise AttributeError(f"module 'sdfc.api' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
