"""The shape graph: the scene as meant."""
