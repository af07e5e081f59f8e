"""What pages are told, as JSON (docs/watch.md has the whole of it)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from sdfc.diagnostics import Diagnostic, SceneError
from sdfc.glsl.expression import type_name
from sdfc.live.edits import Shown
from sdfc.live.parts import boxes_of
from sdfc.plan.setting import values_of
from sdfc.plan.view import uniform_name
from sdfc.scene.model import Param

Message = Mapping[str, Any]


def text_of(message: Message) -> str:
    """The frame."""
    return json.dumps(message, separators=(",", ":"), allow_nan=False)


def scene(number: int, shown: Shown) -> dict[str, Any]:
    """All that a page needs to draw what is shown."""
    compiled = shown.built.compiled
    frame, tracer = compiled.frame, compiled.plan.tracer
    hidden = exact(shown)
    return {
        "type": "scene",
        "id": number,
        "title": compiled.setting.title,
        "shaders": {entry: compiled.web(entry) for entry in ("picture", "inspect")},
        "own": {"centre": frame.centre, "radius": frame.radius},
        "camera": camera(shown),
        **boxes(shown),
        "params": [_param(p, shown.params[p.name]) for p in compiled.scene.params if p.name not in hidden],
        "values": values(shown),
        "materials": compiled.materials,
        "tracer": tracer.name,
        "guarantee": tracer.guarantee,
        "live": len(shown.built.live),
    }


def values(shown: Shown) -> dict[str, tuple[float, ...]]:
    """The value of every uniform but the camera's, by its name in the shaders."""
    params = shown.params
    return {uniform_name(p): params[p.name] for p in shown.built.compiled.scene.params}


def camera(shown: Shown) -> dict[str, Any]:
    """Where the scene is seen from; either the fov or the height is null."""
    found, params = shown.built.compiled.setting.camera, shown.params
    eye, target, up, (fov,) = (values_of(value, params) for value in (found.eye, found.target, found.up, found.fov))
    height = None if found.height is None else values_of(found.height, params)[0]
    return {"eye": eye, "target": target, "up": up, "fov": fov if height is None else None, "height": height}


def boxes(shown: Shown) -> dict[str, Any]:
    """`bounds` and `parts`: where things are for any value of the params, and for the live literals as they are."""
    found = boxes_of(shown.built.compiled, exact(shown))
    return {
        "bounds": {
            "low": found.whole.lo,
            "high": found.whole.hi,
            "holds_everything": shown.built.compiled.frame.is_finite,
        },
        "parts": [{"name": part.name, "low": part.box.lo, "high": part.box.hi} for part in found.parts],
    }


def exact(shown: Shown) -> dict[str, tuple[float, ...]]:
    """The live literals by name: unlike the params, which pages move, they are what they are."""
    params = shown.params
    return {made.name: params[made.name] for made in shown.built.live.values()}


def errors(text: str, error: Exception) -> dict[str, Any]:
    """What is wrong, as the terminal shows it and by its places."""
    found = error.diagnostics if isinstance(error, SceneError) else (Diagnostic(str(error)),)
    return {"type": "errors", "text": text, "diagnostics": [_diagnostic(d) for d in found]}


def _diagnostic(found: Diagnostic) -> dict[str, Any]:
    line, column = found.span.source.position(found.span.start) if found.span is not None else (None, None)
    file = found.span.source.name if found.span is not None else None
    return {"file": file, "line": line, "column": column, "message": found.message, "hint": found.hint}


def _param(param: Param, default: tuple[float, ...]) -> dict[str, Any]:
    return {
        "name": param.name,
        "uniform": uniform_name(param),
        "type": type_name(param.type),
        "unit": param.unit,
        "default": default,
        "low": param.low,
        "high": param.high,
    }
