"""Scenes for tests of tracers, and what they are judged by (sdfc.measure)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sdfc import pipeline
from sdfc.diagnostics import Source
from sdfc.measure.judge import FAR, THIN, certified, footprint, judge, tolerance, verdict, wrong
from sdfc.measure.picture import Picture, Tracing, every
from sdfc.measure.truth import Truth, truth_of
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
    "judge",
    "perfect",
    "random_rays",
    "tolerance",
    "truth_of",
    "unanswered",
    "verdict",
    "wrong",
]

Array: TypeAlias = NDArray[np.float64]


def compiled_file(path: Path, tracer: str = "proven") -> Compiled:
    """A scene's file, compiled."""
    kind: pipeline.Kind = "csg" if path.suffix == ".csg" else "sdf"
    scene = pipeline.load(Source(path.name, path.read_text()), path.parent, kind)
    return pipeline.compile_scene(scene, Options(tracer))


def compiled_text(text: str, tracer: str = "proven") -> Compiled:
    """A scene's text, compiled."""
    return pipeline.compile_scene(pipeline.load(Source("test.sdf", text), None), Options(tracer))


def random_rays(count: int, seed: int, distance: float = 3.0) -> tuple[Array, Array]:
    """Rays from a sphere around the origin to points near it, in float32 numbers: (3, count) each."""
    random = np.random.default_rng(seed)
    o = random.normal(size=(3, count))
    o *= distance / np.linalg.norm(o, axis=0)
    d = random.uniform(-0.8, 0.8, (3, count)) - o
    d /= np.linalg.norm(d, axis=0)
    return o.astype(np.float32).astype(float), d.astype(np.float32).astype(float)


def unanswered(o: Array, d: Array) -> Picture:
    """Rays to be asked about."""
    count = o.shape[1]
    none, nothing = np.zeros(count, bool), np.zeros(count)
    return Picture(o, d, none, np.full(count, np.nan), np.zeros((3, count)), nothing, nothing, none)


def perfect(picture: Picture, truth: Truth) -> Picture:
    """What a tracer without any error would have answered."""
    return replace(picture, hit=truth.hit, depth=np.where(truth.hit, truth.t, np.nan), normal=truth.normal)
