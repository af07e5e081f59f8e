"""One OpenGL device for the tests of this folder that need it."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest

from sdfc.diagnostics import DeviceError
from sdfc.gpu.device import Device, open_device


@pytest.fixture(scope="session")
def device() -> Iterator[Device]:
    """An open device. Without OpenGL the test is skipped, unless SDFC_REQUIRE_GL=1 says that it must be there."""
    try:
        opened = open_device()
    except DeviceError as error:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            raise
        pytest.skip(f"no OpenGL here: {error}")
    with opened:
        yield opened
