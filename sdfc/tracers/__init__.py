"""The table of tracers."""
