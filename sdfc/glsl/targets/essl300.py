"""WebGL 2 and OpenGL ES 3.0, which have no compute shaders."""

from sdfc.glsl.targets.desktop import COVER, FRAGMENT, PIXEL, SUFFIXES
from sdfc.glsl.targets.record import Target

ENTRY = Target(
    name="essl300",
    doc="WebGL 2 and OpenGL ES 3.0, which have no compute shaders",
    use=COVER,
    full=FRAGMENT,
    suffix=SUFFIXES,
    pixel=PIXEL,
    is_told=True,
    version="300 es",
    precision=True,
)
