"""The page of `sdfc watch --serve`: plain HTML, CSS and ES modules, no build step, nothing from elsewhere."""

from __future__ import annotations

from importlib.resources import files
from types import MappingProxyType

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}


def _served() -> MappingProxyType[str, str]:
    names = sorted(entry.name for entry in files(__name__).iterdir() if entry.is_file())
    endings = {name: f".{name.rpartition('.')[2]}" for name in names}
    return MappingProxyType({name: _TYPES[ending] for name, ending in endings.items() if ending in _TYPES})


FILES = _served()
"""The content type of every file that may be asked for, by its name. `index.html` is the page itself."""


def content(name: str) -> bytes:
    """One of FILES."""
    assert name in FILES, name
    return files(__name__).joinpath(name).read_bytes()
