"""GLSL to be compiled to SPIR-V for Vulkan: uniforms in one block, explicit bindings."""

from __future__ import annotations

from sdfc.glsl.source import Item, Kind
from sdfc.glsl.targets.desktop import BOTH, SUFFIXES
from sdfc.glsl.targets.record import Brief, Target

_OPAQUE = ("sampler", "image")


def _in_a_block(items: list[Item], brief: Brief) -> list[Item]:
    """Uniforms are members of one std140 block; where it is bound can be set by macros in front."""
    free = [item for item in items if item.kind is Kind.UNIFORM and not any(o in item.type for o in _OPAQUE)]
    if not free:
        return items
    place, stem = next(i for i, item in enumerate(items) if item is free[0]), brief.prefix
    macros = [
        line
        for name, value in ((f"{stem}_SET", 0), (f"{stem}_BINDING", 1))
        for line in (f"#ifndef {name}", f"#define {name} {value}", "#endif")
    ]
    members = [f"    {i.type} {', '.join(i.names)};" + (f"  // {i.note}" if i.note else "") for i in free]
    head = f"layout(std140, set = {stem}_SET, binding = {stem}_BINDING) uniform {brief.prefix}_uniforms_of_scene {{"
    block = Item(Kind.UNIFORM, tuple(n for i in free for n in i.names), "", "\n".join([head, *members, "};"]))
    kept = [Item(Kind.DIRECTIVE, (), "", "\n".join(macros)), block]
    return [*items[:place], *kept, *(item for item in items[place:] if item not in free)]


ENTRY = Target(
    name="vulkan",
    doc="GLSL for SPIR-V (glslangValidator -V): uniforms in a block, bindings explicit",
    use="draw one triangle that covers the picture, and fill the block of uniforms, std140; the picture's first row is "
    "its upper one",
    full=BOTH,
    suffix=SUFFIXES,
    # y points down in Vulkan's window
    pixel={
        "fragment": "vec2(gl_FragCoord.x, window.y - gl_FragCoord.y)",
        "compute": "vec2(float(gl_GlobalInvocationID.x) + 0.5, window.y - float(gl_GlobalInvocationID.y) - 0.5)",
    },
    version="450",
    lower=_in_a_block,
)
