"""Image files: PNG, OpenEXR and NumPy, encoded in memory and written atomically."""
