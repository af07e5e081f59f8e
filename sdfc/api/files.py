"""A render's files: the picture, and the other images beside it."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from sdfc.api.request import RequestError, checked_names
from sdfc.image.picture import AOVS, Image, format_of
from sdfc.image.write import check_writable, write_all

STDOUT = Path("-")


def check_files(output: Path, aovs: Iterable[str], aov_format: str) -> None:
    """Raise RequestError or OutputError for files that could not be written, before anything is rendered."""
    wanted = checked_names("image", aovs, AOVS)
    if output == STDOUT:
        if wanted:
            raise RequestError("images beside the picture need its file's name: give -o a name")
        if sys.stdout.isatty():
            raise RequestError("a picture is not written to a terminal: give -o a name")
        return
    _picture_format(output)
    for path in [output, *(aov_path(output, name, aov_format) for name in wanted)]:
        check_writable(path)


def write_files(image: Image, output: Path, aov_format: str, quick: bool = False) -> list[Path]:
    """Write the picture and its other images, all whole or none; returns what was written. `quick`: as Image.encode."""
    if output == STDOUT:
        sys.stdout.buffer.write(image.encode("png"))
        sys.stdout.buffer.flush()
        return [output]
    files = {output: image.encode(_picture_format(output), quick)}
    for name in image.aovs:
        files[aov_path(output, name, aov_format)] = image.encode_aov(name, aov_format)
    write_all(files)
    return list(files)


def aov_path(output: Path, name: str, aov_format: str) -> Path:
    """`out.depth.npy` beside `out.png`."""
    return output.with_name(f"{output.stem}.{name}.{aov_format}")


def _picture_format(output: Path) -> str:
    try:
        return format_of(output)
    except ValueError as error:
        raise RequestError(str(error)) from error
