"""Scenes for tests of tracers, and what they are judged by (sdfc.measure)."""

from __future__ import annotations

from pathlib import Path

from sdfc import pipeline
from sdfc.diagnostics import Source
from sdfc.measure.judge import FAR, THIN, certified, footprint, tolerance, verdict, wrong
from sdfc.measure.picture import Picture, Tracing, every
from sdfc.pipeline import Compiled, Options

__all__ = [
    "FAR",
    "THIN",
    "Picture",
    "Tracing",
    "certified",
    "compiled_file",
    "compiled_text",
    "every",
    "footprint",
    "tolerance",
    "verdict",
    "wrong",
]


def compiled_file(path: Path, tracer: str = "proven") -> Compiled:
    """A scene's file, compiled."""
    kind: pipeline.Kind = "csg" if path.suffix == ".csg" else "sdf"
    scene = pipeline.load(Source(path.name, path.read_text()), path.parent, kind)
    return pipeline.compile_scene(scene, Options(tracer))


def compiled_text(text: str, tracer: str = "proven") -> Compiled:
    """A scene's text, compiled."""
    return pipeline.compile_scene(pipeline.load(Source("test.sdf", text), None), Options(tracer))
