"""Devices, programs and frames; knows nothing of scenes."""
