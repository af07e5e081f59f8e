"""Time against error: every tracer on every scene, judged by certified truth (`sdfc bench`)."""
