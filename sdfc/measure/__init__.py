"""How right and how fast: pictures against certified truth, benchmarks, stress."""
