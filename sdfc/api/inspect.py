"""What there is to know without rendering: what a scene contains, the compiler's forms, the tables."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import TYPE_CHECKING

from sdfc.api.program import Program, load
from sdfc.api.request import RequestError, checked_names
from sdfc.api.source import Input

if TYPE_CHECKING:
    from sdfc.syntax.tree import FieldDeclaration
    from sdfc.tracers.record import Tracer

LISTS = ("primitives", "operations", "tracers", "targets")
_CHILD_KINDS = frozenset({"solid", "profile"})


def summary(program: Program) -> dict[str, int]:
    """How much of each thing a scene has, after checking that its shape graph holds together."""
    from sdfc.shape.graph import topological
    from sdfc.shape.verify import verify

    scene = program.scene
    verify(scene.root)
    return {
        "shapes": sum(1 for _ in topological(scene.root)),
        "params": len(scene.params),
        "lights": len(scene.lights),
        "warnings": len(scene.warnings),
    }


def listing(kind: str) -> list[tuple[str, str]]:
    """How each primitive, operation, tracer or target is written, and its one line of description."""
    (kind,) = checked_names("list", (kind,), LISTS)
    if kind == "tracers":
        from sdfc.tracers import TRACERS

        return [(_tracer_usage(tracer), _tracer_words(tracer)) for tracer in TRACERS.values()]
    if kind == "targets":
        from sdfc.glsl.targets import TARGETS

        return [(f"{t.name} ({', '.join(t.stages)})", t.doc) for t in TARGETS.values()]
    from sdfc.scene.library import declaration, standard_names

    fields = [declaration(name) for name in standard_names()]
    if kind == "primitives":
        return [(_usage(field), field.doc) for field in fields if not _is_operation(field)]
    return [*_built_in(), *((_usage(field), field.doc) for field in fields if _is_operation(field))]


def _tracer_usage(tracer: Tracer) -> str:
    """`relaxed:omega=1.4`, with the defaults of the parameters that it has."""
    return ":".join([tracer.name, *(f"{p.name}={p.default:g}" for p in tracer.parameters)])


def _tracer_words(tracer: Tracer) -> str:
    return f"{tracer.doc} ({tracer.source}) Needs {tracer.needs}; gives: {tracer.guarantee}."


def _built_in() -> list[tuple[str, str]]:
    """The operations that are the language's own: combinations, affine maps, paint."""
    from sdfc.scene.combine import OPERATIONS
    from sdfc.scene.transforms import TRANSFORMS

    combinations = [
        (
            f"{name} {{ … }}, {name}(…, blend: length)",
            f"A sharp {name}; smooth with `blend:`, bevelled with `chamfer:`.",
        )
        for name in OPERATIONS
    ]
    maps = [
        (f"solid.{name}({', '.join(parameters)})", "An affine map; of a profile too.")
        for name, (parameters, _) in TRANSFORMS.items()
    ]
    return [*combinations, *maps, ("solid.material(m)", "Gives the material to every part that has none yet.")]


def _is_operation(field: FieldDeclaration) -> bool:
    return any(parameter.kind.text in _CHILD_KINDS for parameter in field.parameters)


def _usage(field: FieldDeclaration) -> str:
    """`solid.round(radius: length >= 0)`: the children first, as in a chain, then the parameters as declared.

    What is found from a child is left out: it cannot be given.
    """
    from sdfc.syntax.walk import mentions

    text = field.span.source.text
    children = [p for p in field.parameters if p.kind.text in _CHILD_KINDS]
    names = {child.name.text for child in children}
    values = [
        text[p.span.start : p.span.end]
        for p in field.parameters
        if p.kind.text not in _CHILD_KINDS and not mentions(p.default or ()).used & names
    ]
    receiver = f"{children[0].kind.text}." if children else ""
    others = [f"{child.name.text}: {child.kind.text}" for child in children[1:]]
    return f"{receiver}{field.name.text}({', '.join(others + values)})"


def show(given: Input, form: str, after: str | None = None) -> str:
    """A scene in one of the compiler's forms; `after` names the pass after which the shape graph is shown."""
    (form,) = checked_names("form", (form,), tuple(_FORMS))
    if after is not None:
        (after,) = checked_names("pass", (after,), tuple(step.name for step in _pipeline().PASSES))
    return _FORMS[form](given, after)


def _syntax(given: Input, _: str | None) -> str:
    from sdfc.syntax.parse import parse
    from sdfc.syntax.show import show as show_syntax

    if given.kind != "sdf":
        raise RequestError("only a .sdf scene has a syntax tree to show; the others meet in the shape graph")
    return show_syntax(parse(given.source))


def _shape(given: Input, after: str | None) -> str:
    from sdfc.shape.show import show as show_shape

    scene = load(given).scene
    return show_shape(scene.root if after is None else _pipeline().normalise(scene, after)[0])


def _field(given: Input, _: str | None) -> str:
    from sdfc.field.show import show as show_field
    from sdfc.shape.lower import lower

    scene = load(given).scene
    root, _workshop = _pipeline().normalise(scene)
    with _pipeline().deep_recursion():
        return show_field([lower(root, scene.values.input("p"))])


def _plan(given: Input, _: str | None) -> str:
    return load(given).explanation()


def _glsl(given: Input, _: str | None) -> str:
    return load(given).glsl().removesuffix("\n")


def _pipeline() -> ModuleType:
    from sdfc import pipeline

    return pipeline


_FORMS: dict[str, Callable[[Input, str | None], str]] = {
    "syntax": _syntax,
    "shape": _shape,
    "field": _field,
    "plan": _plan,
    "glsl": _glsl,
}
