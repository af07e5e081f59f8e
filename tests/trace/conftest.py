"""What all tests of the tracer share: one device, and whether the long version was asked for."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest
from truth import Tracing

from sdfc.api.renderer import GlRenderer
from sdfc.diagnostics import DeviceError


@pytest.fixture(scope="session")
def tracing() -> Iterator[Tracing]:
    """A renderer. Without OpenGL the test is skipped, unless SDFC_REQUIRE_GL=1 says that it must be there."""
    try:
        renderer = GlRenderer()
    except DeviceError as error:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            raise
        pytest.skip(f"no OpenGL here: {error}")
    yield Tracing(renderer)
    renderer.close()


@pytest.fixture(scope="session")
def is_full() -> bool:
    """Whether SDFC_FULL=1 asks for full sizes and many examples."""
    return os.environ.get("SDFC_FULL") == "1"
