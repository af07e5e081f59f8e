"""Many like parts: a row of a table each, one loop, and one record of the nearest, whose surface is computed once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.glsl.body import Body, place
from sdfc.glsl.expression import literal, type_name
from sdfc.glsl.functions import Functions, Role
from sdfc.glsl.live import Live
from sdfc.plan.steps import Closed, Many
from sdfc.shape.material import Material

_LOOPS = 2000  # rows are taken several at a time where there are more: llvmpipe stops all loops at 65 535 (GL.md 0)
_LETTERS = "xyzw"


@dataclass(frozen=True, slots=True)
class Record:
    """The globals that hold the nearest member that a ray has met, and the table of all."""

    meet: str  # the function that meets one member
    at: str
    values: tuple[tuple[str, Type], ...]
    material: str
    table: str
    rows: int
    width: int  # vec4s a row
    at_once: int


class ManyWriter:
    """Writes, for each Many, its table, the record's globals and `meet_NAME`."""

    def __init__(
        self,
        graph: FieldGraph,
        functions: Functions,
        live: Live,
        materials: Sequence[Material],
    ) -> None:
        self._graph = graph
        self._functions = functions
        self._live = live
        self._materials = list(materials)
        self._records: dict[int, Record] = {}
        self.tables: list[str] = []
        self.meetings: list[str] = []

    def loop(self, many: Many, body: Body, statement: str) -> None:
        """A loop over the table's rows; `statement` may use `{at}`, `{values}` (each after a comma) and `{material}`."""
        record = self.record(many)
        count = f"row_{record.table}"
        body.add(f"int {count} = 0;")
        body.add("do {")
        for _ in range(record.at_once):
            cells = [f"{record.table}_{i}" for i in range(record.width)]
            body.add("    {")
            for i, cell in enumerate(cells):
                index = f"{record.width} * {count} + {i}" if record.width > 1 else count
                body.add(f"        vec4 {cell} = {record.table}[{index}];")
            body.add(f"        {self._filled(record, cells, statement)}")
            body.add("    }")
            body.add(f"    {count}++;")
        body.add(f"}} while ({count} < {record.rows});")

    def _filled(self, record: Record, cells: list[str], statement: str) -> str:
        letters = [f"{cell}.{letter}" for cell in cells for letter in _LETTERS]
        texts, start = [], 3
        for _, type_ in record.values:
            part = letters[start : start + type_.size]
            texts.append(part[0] if type_.size == 1 else f"{type_name(type_)}({', '.join(part)})")
            start += type_.size
        material = letters[start] if len(self._materials) > 1 else "0.0"
        values = "".join(f", {t}" for t in texts)
        return statement.format(at=f"{cells[0]}.xyz", values=values, material=material)

    def meet(self, many: Many, body: Body) -> None:
        """The events of every member, into `body`, where o, d, start and first are at hand."""
        record = self.record(many)
        if not any(record.meet in text for text in self.meetings):
            self.meetings.append(self._meeting(many, record))
        self.loop(many, body, f"{record.meet}(o, d, start, first, {{at}}{{values}}, {{material}});")

    def value(self, many: Many, body: Body, name: str) -> None:
        """The least of the members' formulas at p, into a new variable."""
        call = self._functions.of_part(many.members[0].part, Role.VALUE)
        body.add(f"float {name} = FAR;")
        self.loop(many, body, f"{name} = min({name}, {call.name}(p - {{at}}{{values}}));")

    def surface(self, many: Many, body: Body) -> str:
        """The gradient and value at p of the member that the ray has met."""
        record = self.record(many)
        call = self._functions.of_part(many.members[0].part, Role.SURFACE)
        name = f"field_{record.at}"
        values = "".join(f", {n}" for n, _ in record.values)
        body.declare(Type.VEC4, name, f"{call.name}(p - {record.at}{values})")
        return name

    def record(self, many: Many) -> Record:
        """Made once for each Many."""
        if id(many) not in self._records:
            self._records[id(many)] = self._made(many)
        return self._records[id(many)]

    def _made(self, many: Many) -> Record:
        part, fresh = many.members[0].part, self._functions.names.fresh
        pairs = zip(part.shape.definition.values, part.shape.arguments, strict=True)
        values = tuple((fresh(f"{many.name}_{p.name}"), a.type) for p, a in pairs if isinstance(a, Expr))
        floats = 3 + sum(t.size for _, t in values) + (len(self._materials) > 1)
        at_once = math.ceil(len(many.members) / _LOOPS)
        rows = math.ceil(len(many.members) / at_once) * at_once
        names = [fresh(f"{stem}{many.name}{tail}") for stem, tail in (("meet_", ""), ("", "_at"), ("", "_look"), ("", "_table"))]
        record = Record(names[0], names[1], values, names[2], names[3], rows, math.ceil(floats / 4), at_once)
        self.tables.append(self._table(many, record))
        return record

    def _table(self, many: Many, record: Record) -> str:
        lines = [f"// {len(many.members)} of {many.name}: place, size{', material' * (len(self._materials) > 1)}"]
        lines.append(f"const vec4 {record.table}[{record.rows * record.width}] = vec4[](")
        members = [*many.members, *[many.members[-1]] * (record.rows - len(many.members))]
        for index, member in enumerate(members):
            end = "," if index + 1 < len(members) else ""
            lines.append(f"    {', '.join(self._cells(member, record))}{end}  // {place(member.part.span)}")
        return "\n".join([*lines, ");", ""])

    def _cells(self, member: Closed, record: Record) -> list[str]:
        part = member.part
        centre = [0.0] * 3 if part.inverse is None else [-e.number for e in part.inverse.offset]
        arguments = [n for a in part.shape.arguments if isinstance(a, Expr) for n in a.numbers]
        material = [float(self._materials.index(part.material))] if len(self._materials) > 1 else []
        numbers = [*centre, *arguments, *material]
        numbers += [0.0] * (4 * record.width - len(numbers))
        texts = [literal(n) for n in numbers]
        return [f"vec4({', '.join(texts[i : i + 4])})" for i in range(0, len(texts), 4)]

    def _meeting(self, many: Many, record: Record) -> str:
        call = self._functions.of_part(many.members[0].part, Role.RAY)
        formal = "".join(f", {type_name(t)} {n}_here" for n, t in record.values)
        actual = "".join(f", {n}_here" for n, _ in record.values)
        keep = "".join(f" {n} = {n}_here;" for n, _ in record.values)
        lines = [
            f"// the nearest {many.name} that the ray has met: where it is, what it measures, its material",
            f"vec3 {record.at} = vec3(FAR);",
            *(f"{type_name(t)} {n} = {type_name(t)}(1.0);" for n, t in record.values),
            f"float {record.material} = 0.0;",
            f"void {record.meet}(vec3 o, vec3 d, float start, inout float first, vec3 at{formal}, float look) {{",
            f"    float t = enter({call.name}(o - at, d, GROW{actual}), start);",
            f"    if (t < first) {{ first = t; {record.at} = at;{keep} {record.material} = look; }}",
            "}",
            "",
        ]
        return "\n".join(lines)
