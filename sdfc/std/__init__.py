"""The standard library, in the scene language (*.sdf)."""
