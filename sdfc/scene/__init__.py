"""Syntax tree to Scene: names, types, units, expansion."""
