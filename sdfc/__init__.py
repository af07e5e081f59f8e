"""sdfc: a compiler from CSG scenes to GLSL that proves its pictures right."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sdfc.api import Image, Program, compile
    from sdfc.diagnostics import SceneError

__version__ = "0.1.0"
__all__ = ["Image", "Program", "SceneError", "__version__", "compile"]

_HOMES = {"Image": "sdfc.api", "Program": "sdfc.api", "SceneError": "sdfc.diagnostics", "compile": "sdfc.api"}


def __getattr__(name: str) -> Any:
    """The public names, imported when first asked for: `sdfc --version` needs none of them."""
    if name not in _HOMES:
        raise AttributeError(f"module 'sdfc' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
