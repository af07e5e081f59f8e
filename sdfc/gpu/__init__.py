"""Running GLSL: an offscreen device, programs, frames. Knows nothing of scenes."""
