"""Many like parts: a line of GLSL each, and one record of the nearest, whose surface is computed once."""

from __future__ import annotations

from dataclasses import dataclass

from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.glsl.body import Body
from sdfc.glsl.expression import type_name
from sdfc.glsl.functions import Functions, Role
from sdfc.glsl.live import Live
from sdfc.plan.steps import Closed, Many
from sdfc.shape.material import Material


@dataclass(frozen=True, slots=True)
class Record:
    """The globals that hold the nearest member that a ray has met."""

    meet: str  # the function that meets one member
    at: str
    values: tuple[str, ...]
    material: str


class ManyWriter:
    """Writes, for each Many, the record's globals and `meet_NAME`."""

    def __init__(self, graph: FieldGraph, functions: Functions, live: Live, materials: list[Material]) -> None:
        self._graph = graph
        self._functions = functions
        self._live = live
        self._materials = materials
        self.records: dict[int, Record] = {}
        self.texts: list[str] = []

    def write(self, many: Many, body: Body) -> None:
        """One call a member, into `body`, where o, d, start and first are at hand."""
        record = self.records[id(many)] = self._record(many)
        for member in many.members:
            part = member.part
            texts = body.texts([self._centre(member), *(a for a in part.shape.arguments if isinstance(a, Expr))])
            material = f"{float(self._materials.index(part.material))}"
            body.add(f"{record.meet}(o, d, start, first, {', '.join([*texts, material])});", part.span)

    def _centre(self, member: Closed) -> Expr:
        inverse = member.part.inverse
        return self._graph.constant(0.0, 0.0, 0.0) if inverse is None else self._graph.vector(*(-e for e in inverse.offset))

    def _record(self, many: Many) -> Record:
        first = many.members[0].part
        name, fresh = many.name, self._functions.names.fresh
        parameters = [(p.name, a) for p, a in zip(first.shape.definition.values, first.shape.arguments, strict=True)]
        values = [(fresh(f"{name}_{n}"), a.type) for n, a in parameters if isinstance(a, Expr)]
        record = Record(fresh(f"meet_{name}"), fresh(f"{name}_at"), tuple(n for n, _ in values), fresh(f"{name}_material"))
        call = self._functions.of_part(first, Role.RAY)
        formal = "".join(f", {type_name(t)} {n}_here" for n, t in values)
        actual = "".join(f", {n}_here" for n, _ in values)
        keep = "".join(f" {n} = {n}_here;" for n, _ in values)
        lines = [
            f"// the nearest {name} that the ray has met: where it is, what it measures, its material",
            f"vec3 {record.at} = vec3(FAR);",
            *(f"{type_name(t)} {n} = {type_name(t)}({0.0});" for n, t in values),
            f"float {record.material} = 0.0;",
            f"void {record.meet}(vec3 o, vec3 d, float start, inout float first, vec3 at{formal}, float material) {{",
            f"    float t = enter({call.name}(o - at, d, GROW{actual}), start);",
            f"    if (t < first) {{ first = t; {record.at} = at;{keep} {record.material} = material; }}",
            "}",
            "",
        ]
        self.texts.append("\n".join(lines))
        return record

    def surface_text(self, many: Many, body: Body) -> str:
        """The record's gradient and value at p."""
        record = self.records[id(many)]
        call = self._functions.of_part(many.members[0].part, Role.SURFACE)
        name = f"field_{record.at}"
        body.declare(Type.VEC4, name, f"{call.name}({', '.join([f'p - {record.at}', *record.values])})")
        return name
