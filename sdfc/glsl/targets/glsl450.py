"""OpenGL 4.5 and later."""

from sdfc.glsl.targets.desktop import BOTH, COVER, PIXEL, SUFFIXES
from sdfc.glsl.targets.record import Target

ENTRY = Target(
    name="glsl450",
    doc="OpenGL 4.5 and later",
    use=COVER,
    full=BOTH,
    suffix=SUFFIXES,
    pixel=PIXEL,
    version="450 core",
)
