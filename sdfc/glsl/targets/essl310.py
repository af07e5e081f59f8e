"""OpenGL ES 3.1."""

from sdfc.glsl.targets.desktop import BOTH, COVER, PIXEL, SUFFIXES
from sdfc.glsl.targets.record import Target

ENTRY = Target(
    name="essl310",
    doc="OpenGL ES 3.1",
    use=COVER,
    full=BOTH,
    suffix=SUFFIXES,
    pixel=PIXEL,
    version="310 es",
    precision=True,
)
