"""The Python interface: compile a scene, render it, get its GLSL. The command line is made of the same calls."""

from sdfc.api.animation import Sweep
from sdfc.api.program import Program, compile, load
from sdfc.api.request import RequestError, View
from sdfc.image.picture import AOVS, Image

__all__ = ["AOVS", "Image", "Program", "RequestError", "Sweep", "View", "compile", "load"]
