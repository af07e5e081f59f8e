"""What all tests of the tracer share: one device, and whether the long version was asked for."""

from __future__ import annotations

import os

import pytest
from truth import Tracing

from sdfc.api.renderer import GlRenderer


@pytest.fixture(scope="session")
def tracing(renderer: GlRenderer) -> Tracing:
    return Tracing(renderer)


@pytest.fixture(scope="session")
def is_full() -> bool:
    """Whether SDFC_FULL=1 asks for full sizes and many examples."""
    return os.environ.get("SDFC_FULL") == "1"
