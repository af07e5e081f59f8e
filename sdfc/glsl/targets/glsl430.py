"""OpenGL 4.3 and later."""

from sdfc.glsl.targets.desktop import BOTH, COVER, PIXEL, SUFFIXES
from sdfc.glsl.targets.record import Target

ENTRY = Target(
    name="glsl430",
    doc="OpenGL 4.3 and later",
    use=COVER,
    full=BOTH,
    suffix=SUFFIXES,
    pixel=PIXEL,
    is_told=True,
    version="430 core",
)
