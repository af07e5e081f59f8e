"""sdfc: a compiler from CSG scenes to GLSL that proves its pictures right."""

__version__ = "0.1.0"
