"""Rewrites of the shape graph; one a file. Their order, with the why of each, is `sdfc.pipeline.PASSES`."""
