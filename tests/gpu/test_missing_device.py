"""A machine without OpenGL."""

from __future__ import annotations

import sys

import pytest

from sdfc.diagnostics import DeviceError
from sdfc.gpu import device


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems bring their OpenGL with them")
def test_the_error_says_what_was_tried_and_the_exact_command(monkeypatch: pytest.MonkeyPatch) -> None:
    libraries = (
        {"libgl": "libNoSuchGL.so.1", "libegl": "libEGL.so.1"},
        {"libgl": "libGL.so.1", "libegl": "libNone.so"},
    )
    monkeypatch.setattr(device, "_EGL_LIBRARIES", libraries)
    with pytest.raises(DeviceError) as caught:
        device.open_device()
    lines = str(caught.value).splitlines()
    assert lines[0] == "no usable OpenGL 4.5"
    assert lines[1].startswith("  tried EGL with libNoSuchGL.so.1 and libEGL.so.1: ")
    assert lines[2].startswith("  tried EGL with libGL.so.1 and libNone.so: ")
    assert lines[3] == "  to install it: apt-get install --no-install-recommends libegl1 libgl1 libgl1-mesa-dri"
