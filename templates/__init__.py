"""The GLSL templates, as package data."""
