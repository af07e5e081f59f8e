"""A scene as GLSL for other programs: what is asked for, checked, and made."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from sdfc.api.request import AUTO, RequestError, Setting, View, checked_names, checked_params, checked_tracer

if TYPE_CHECKING:
    from sdfc.api.program import Program
    from sdfc.glsl.emission import Order
    from sdfc.glsl.targets.record import Eye, Part, Target
    from sdfc.pipeline import Compiled, Options

_SIZE = (1280, 720)
_PREFIX = re.compile(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*_?\Z")


def emitted(
    program: Program,
    target: str,
    stage: str | None,
    tracer: str,
    part: str,
    prefix: str | None,
    bake: bool,
    params: Mapping[str, Setting],
) -> str:
    """One file for `target`. RequestError, with the reason, where the target cannot be had so."""
    order = ordered(program, target, stage, part, prefix, bake, params)
    if part == "field" and tracer != AUTO:
        raise RequestError("a field is not traced: a tracer goes with the parts 'tracer' and 'full'")
    return _made(program, order, checked_tracer(tracer))


def ordered(
    program: Program,
    target: str,
    stage: str | None,
    part: str,
    prefix: str | None,
    bake: bool,
    params: Mapping[str, Setting],
) -> Order:
    """What was asked for, checked."""
    from sdfc.glsl.emission import Order
    from sdfc.glsl.targets import TARGETS
    from sdfc.glsl.targets.record import PARTS

    checked_names("target", (target,), tuple(TARGETS))
    checked_names("part", (part,), PARTS)
    row, wanted = TARGETS[target], cast("Part", part)
    if wanted in row.refused:
        raise RequestError(f"target '{target}' has no part '{part}': {row.refused[wanted]}")
    if params and not bake and not row.is_baked:
        raise RequestError("params stay uniforms, which have their values when the shader runs: --set needs --bake")
    return Order(
        target,
        wanted,
        _checked_stage(row, stage),
        _checked_prefix(prefix, program.scene.source.name),
        prefix is not None,
        bake,
        checked_params(program.params, params),
    )


def files_of(
    program: Program, output: Path | None, target: str, stage: str | None, **asked: Any
) -> dict[Path | None, tuple[str, str]]:
    """The stage and text of every file that is to be written; None stands for standard output.

    Stages that belong together have a file each, named after `output`, unless one of them is asked for.
    """
    from sdfc.glsl.targets import TARGETS

    checked_names("target", (target,), tuple(TARGETS))
    row = TARGETS[target]
    if not row.is_pair or stage is not None or asked.get("part") in row.refused:
        text = program.glsl(target, stage, **asked)
        return {output: (stage or row.stages[0], text)}
    if output is None:
        raise RequestError(f"'{target}' is several files: give --stage ({', '.join(row.stages)}), or -o NAME")
    return {output.with_suffix(row.suffix[s]): (s, program.glsl(target, s, **asked)) for s in row.stages}


def _checked_stage(row: Target, stage: str | None) -> str:
    chosen = stage or row.stages[0]
    if chosen not in row.stages:
        raise RequestError(f"target '{row.name}' has no {chosen} stage (it has: {', '.join(row.stages)})")
    return chosen


def _checked_prefix(prefix: str | None, scene: str) -> str:
    if prefix is None:
        stem = re.sub(r"[^A-Za-z0-9]+", "_", scene.rsplit("/", 1)[-1].rsplit(".", 1)[0]).strip("_") or "scene"
        return stem if stem[0].isalpha() and not stem.startswith("gl_") else f"scene_{stem}"
    if not _PREFIX.match(prefix) or prefix.startswith("gl_"):
        raise RequestError(f"'{prefix}' cannot begin names in GLSL: a prefix is letters, digits and single underscores")
    return prefix.removesuffix("_")


def _made(program: Program, order: Order, tracer: str) -> str:
    from sdfc.glsl.emission import About, emit
    from sdfc.pipeline import deep_recursion

    compiled = program.compiled_as(_options(order, tracer))
    frame, uniforms = compiled.frame, compiled.uniforms(View(), order.params, _SIZE)

    def other(target: str, stage: str) -> str:
        return _made(program, replace(order, target=target, stage=stage), tracer)

    (lx, ly, lz), (hx, hy, hz) = frame.box.lo, frame.box.hi
    names = ("eye", "axis_x", "axis_y", "axis_z", "window", "pixel")
    camera = {n: v for n in names if isinstance(v := uniforms[n], tuple)}
    eye = _eye(compiled, order)
    about = About((lx, ly, lz), (hx, hy, hz), frame.is_finite, frame.is_of_parts, eye, camera, other)
    with deep_recursion():
        return emit(compiled.scene.values, compiled.plan, compiled.setting, order, about)


def _options(order: Order, tracer: str) -> Options:
    """What to compile for: a field alone needs the bounds on its distance that a sphere tracer does."""
    from sdfc.glsl.targets import TARGETS
    from sdfc.pipeline import Options

    part = TARGETS[order.target].full_part if order.part == "full" else order.part
    if part == "field":
        return Options(tracer="sphere", field=True, own_unit=False)
    chosen = "proven" if tracer == AUTO else tracer
    return Options(tracer=chosen, field=part == "tracer")


def _eye(compiled: Compiled, order: Order) -> Eye:
    from sdfc.glsl.targets.record import Eye
    from sdfc.plan.setting import values_of

    camera, (_, rows) = compiled.setting.camera, _SIZE
    uniforms = compiled.uniforms(View(), order.params, _SIZE)
    pixel = cast("tuple[float, float, float]", uniforms["pixel"])
    is_parallel = pixel[2] == 0.0
    half = pixel[0] * rows * compiled.frame.radius if is_parallel else pixel[1] * rows
    eye, target, up = (values_of(v, order.params) for v in (camera.eye, camera.target, camera.up))
    assert math.isfinite(half)
    return Eye(
        eye=(eye[0], eye[1], eye[2]),
        target=(target[0], target[1], target[2]),
        up=(up[0], up[1], up[2]),
        half=half,
        is_parallel=is_parallel,
    )
