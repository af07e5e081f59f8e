"""What `explain` adds to the proofs: which way was chosen and why, and what is left out since nothing needs it."""

from __future__ import annotations

from dataclasses import replace

from sdfc.api.choose import Decision
from sdfc.api.job import FEWEST_DIGITS, FLOAT32
from sdfc.pipeline import Compiled, Options, compile_scene, normalise
from sdfc.plan.candidates import Candidate
from sdfc.plan.steps import Step, is_closed, leaves_of
from sdfc.plan.view import uniform_name
from sdfc.shape.graph import Apply, Shape, topological

_MOST_SHOWN = 8


def chosen(decision: Decision) -> list[str]:
    """The candidates with their predictions, and the choice with its reason."""
    speeds = decision.speeds
    lines = [
        f"chosen: {decision.chosen.name}: {decision.reason}",
        f"candidates, for a million pixels ({speeds.device}: {speeds.addition:.3g} ns an operation):",
    ]
    shown = [c for c in decision.candidates if not c.illegal][:_MOST_SHOWN]
    lines += [f"  {_candidate(c, decision.pilot)}" for c in shown]
    barred: dict[str, list[str]] = {}
    for name, reason in {c.tracer: c.illegal for c in decision.candidates if c.illegal}.items():
        barred.setdefault(reason, []).append(name)
    return [*lines, *(f"  {', '.join(names)}: not chosen: {reason}" for reason, names in barred.items())]


def _candidate(candidate: Candidate, pilot: dict[str, float]) -> str:
    tried = f"; pilot {pilot[candidate.name]:.2f} ms" if candidate.name in pilot else ""
    passes = f", {candidate.passes:.1f} passes of marching" if candidate.passes else ", no marching"
    return f"{candidate.name}: {candidate.milliseconds:.1f} ms{passes}{tried}"


def faint(compiled: Compiled) -> list[str]:
    """Parts that float32 cannot tell from points: small ones of a scene that is very large."""
    radius = compiled.frame.radius
    small = {leaf.part.name: max(leaf.part.box.half) for leaf in leaves_of(compiled.plan.root)}
    return [
        f"warning: {name} is {2.0 * size * radius:.2g} across, but in a scene of radius {radius:.3g} "
        f"float32 is right to {FLOAT32 * radius:.2g}: expect faults"
        for name, size in small.items()
        if size < FEWEST_DIGITS
    ]


def left_out(compiled: Compiled, options: Options) -> list[str]:
    """What is not emitted because this scene does not need it, with the bytes of GLSL that it would have been."""
    lines = [*_pruned(compiled, options), *_unneeded(compiled.plan.root), *_unlit(compiled)]
    depth, probe, radiance = (len(compiled.glsl(entry)) for entry in ("depth", "probe", "radiance"))
    lines.append(f"from a depth image: normals and materials ({_kilobytes(probe - depth)})")
    lines.append(f"from a depth image: light and shading ({_kilobytes(radiance - depth)})")
    for param in compiled.scene.params:
        if f"{uniform_name(param)};" not in compiled.glsl("radiance"):
            lines.append(f"param {param.name}: nothing that is left depends on it, so it is no uniform")
    return ["left out:", *(f"  {line}" for line in lines)]


def _pruned(compiled: Compiled, options: Options) -> list[str]:
    shape, _ = normalise(compiled.scene, after="negate")
    before, after = _solids(shape), _solids(compiled.shape)
    if before == after:
        return []
    whole = compile_scene(compiled.scene, replace(options, without=("prune",)))
    saved = len(whole.glsl("radiance")) - len(compiled.glsl("radiance"))
    return [f"{before - after} of {before} parts, which are proved to change nothing ({_kilobytes(saved)})"]


def _solids(shape: Shape) -> int:
    nodes = topological(shape)
    return sum(1 for node in nodes if isinstance(node, Apply) and node.dimension == 3 and node.definition.is_primitive)


def _unneeded(root: Step) -> list[str]:
    lines = []
    if is_closed(root):
        lines.append("marching and its tolerances: every part is solved in closed form")
    elif not any(is_closed(leaf) for leaf in leaves_of(root)):
        lines.append("events: no part is solved in closed form")
    return lines


def _unlit(compiled: Compiled) -> list[str]:
    setting = compiled.setting
    materials = compiled.plan.materials
    lines = []
    if len(materials) == 1:
        lines.append("which material is seen: there is one")
    if not setting.lights:
        lines.append("shadow rays: there is no light")
    elif compiled.plan.is_convex:
        lines.append("shadow rays, and distances for ambient occlusion: the scene is one convex solid")
    return lines


def _kilobytes(count: int) -> str:
    return f"{count / 1000:.1f} kB of GLSL"
