"""Files that come with sdfc. Importing importlib.resources would take longer than reading them."""

from importlib import import_module
from pathlib import Path


def folder(package: str) -> Path:
    """Where the files of a package are."""
    return Path(import_module(package).__path__[0])
