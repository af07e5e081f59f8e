"""The field graph: arithmetic in a point, with many meanings."""
