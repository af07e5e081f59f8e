"""A second way in: the flattened CSG that OpenSCAD writes."""
