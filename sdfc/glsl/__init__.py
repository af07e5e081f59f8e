"""Printing: expressions, functions, whole shaders."""
