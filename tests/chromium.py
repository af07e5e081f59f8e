"""The browser that tests draw in."""

from __future__ import annotations

import os
import shutil

import pytest

# ANGLE on Mesa: SwiftShader compiles large shaders for minutes
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--use-gl=angle",
    "--use-angle=gl-egl",
    "--ignore-gpu-blocklist",
    "--no-first-run",
)


def chromium() -> str:
    """Its path. Without it the test is skipped, unless SDFC_REQUIRE_GL=1."""
    path = shutil.which("chromium")
    if path is None:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            pytest.fail("SDFC_REQUIRE_GL=1, but chromium is not installed")
        pytest.skip("chromium is not installed")
    return path
