"""Float64: certified first roots, and the renderer for machines without OpenGL."""
