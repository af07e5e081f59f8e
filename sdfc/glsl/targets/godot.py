"""Godot 4: a spatial shader on a box, lit by Godot; an include file for the parts."""

from __future__ import annotations

import re
from dataclasses import replace

from sdfc.glsl.names import literal
from sdfc.glsl.source import Item, Kind
from sdfc.glsl.targets.record import Brief, Control, Target
from sdfc.glsl.threaded import threaded

_HEX = re.compile(r"\b0x([0-9A-Fa-f]+)\b")


def _lowered(items: list[Item], brief: Brief) -> list[Item]:
    """No globals that change, no hexadecimal above the largest int, and uniforms with Godot's hints and defaults."""
    by_name = {c.uniform: c for c in brief.controls}
    made = [
        replace(item, text=_uniform(by_name[item.names[0]]))
        if item.kind is Kind.UNIFORM
        else replace(item, text=_HEX.sub(_decimal, item.text))
        for item in items
    ]
    return threaded(made)


def _uniform(control: Control) -> str:
    numbers = ", ".join(literal(n) for n in control.default)
    value = numbers if control.type == "float" else f"{control.type}({numbers})"
    low, high = control.low, control.high
    hint = ""
    if control.type == "float" and low is not None and high is not None:
        hint = f" : hint_range({literal(low)}, {literal(high)}, 0.0001)"
    return f"uniform {control.type} {control.uniform}{hint} = {value};"


def _decimal(found: re.Match[str]) -> str:
    bits = int(found[1], 16)
    return str(bits - (1 << 32) if bits >= 1 << 31 else bits)


ENTRY = Target(
    name="godot",
    doc="Godot 4.4 and later: a spatial shader for a box, lit by Godot; a .gdshaderinc (field, tracer)",
    use="put it on a MeshInstance3D with the BoxMesh that the next lines give",
    full={"fragment": "target/part/tracer.glsl"},
    suffix={"fragment": ".gdshader"},
    full_part="tracer",
    is_prefixed=True,
    lower=_lowered,
    hands_state=True,
    page={"full": "target/godot.gdshader"},
)
