"""OpenGL 3.3, which has no compute shaders."""

from sdfc.glsl.targets.desktop import COVER, FRAGMENT, PIXEL, SUFFIXES
from sdfc.glsl.targets.record import Target

ENTRY = Target(
    name="glsl330",
    doc="OpenGL 3.3, which has no compute shaders",
    use=COVER,
    full=FRAGMENT,
    suffix=SUFFIXES,
    pixel=PIXEL,
    version="330 core",
)
