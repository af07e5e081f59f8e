"""Rewrites of the shape graph; one a file."""
