"""Many like parts: a row of a table each, clusters of rows with a box each, and one record of the nearest.

A loop is the one thing that llvmpipe skips work by (GL.md 0), and a data-driven row costs it ten times a baked one: the
boxes win that back. The surface is computed once, from the record.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.glsl.body import Body, place
from sdfc.glsl.expression import literal, type_name
from sdfc.glsl.functions import Functions, Role
from sdfc.glsl.live import Live
from sdfc.plan.cluster import CLUSTER, clustered
from sdfc.plan.steps import Closed, Many
from sdfc.shape.material import Material

_SKIN = 4e-6  # boxes hold what they hold with rounding, and with the growth that closes cracks
_LETTERS = "xyzw"


@dataclass(frozen=True, slots=True)
class Record:
    """The globals that hold the nearest member that a ray has met, and the table of all."""

    meet: str  # the function that meets one member
    at: str
    values: tuple[tuple[str, Type], ...]
    material: str
    table: str
    clusters: str  # the table of the clusters' boxes: centre, half size
    count: int  # of clusters
    width: int  # vec4s a row
    at_once: int  # rows a turn of the loop


class ManyWriter:
    """Writes, for each Many, its table, the record's globals and `meet_NAME`."""

    def __init__(
        self,
        graph: FieldGraph,
        functions: Functions,
        live: Live,
        materials: Sequence[Material],
        at_once: int,
    ) -> None:
        self._graph = graph
        self._functions = functions
        self._live = live
        self._materials = list(materials)
        self._at_once = at_once
        self._records: dict[int, Record] = {}
        self.tables: list[str] = []
        self.meetings: list[str] = []

    def loop(self, many: Many, body: Body, statement: str, near: str) -> None:
        """A loop over the clusters for which `near` holds, and their rows.

        `statement` may use `{at}`, `{values}` (each after a comma) and `{material}`; `near` `{centre}` and `{half}`.
        """
        record = self.record(many)
        group, row = f"{record.table}_group", f"{record.table}_row"
        cells = [f"{record.table}_{i}" for i in range(record.width)]
        boxes = [f"{record.clusters}[2 * {group}{offset}].xyz" for offset in ("", " + 1")]
        body.add(f"int {group} = 0;")
        body.add("do {")
        body.add(f"    int {row} = {CLUSTER} * {group};")
        # a loop runs its body once whatever it is told: one row of every cluster is always taken
        condition = near.format(centre=boxes[0], half=boxes[1])
        body.add(f"    int {row}_end = {row} + ({condition} ? {CLUSTER} : 1);")
        body.add("    do {")
        for step in range(record.at_once):
            body.add("        {")
            for i, cell in enumerate(cells):
                offset = record.width * step + i
                index = f"{record.width} * {row}" if record.width > 1 else row
                body.add(f"            vec4 {cell} = {record.table}[{index}{f' + {offset}' if offset else ''}];")
            body.add(f"            {self._filled(record, cells, statement)}")
            body.add("        }")
        body.add(f"        {row} += {record.at_once};")
        body.add(f"    }} while ({row} < {row}_end);")
        body.add(f"}} while (++{group} < {record.count});")

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
        statement = f"{record.meet}(o, d, start, first, {{at}}{{values}}, {{material}});"
        self.loop(many, body, statement, "enter(box_interval(o - {centre}, d, {half}), start) < first")

    def value(self, many: Many, body: Body, name: str, limit: str = "FAR") -> None:
        """The least of the members' formulas at p, into a new variable; what is farther than the limit is not met."""
        call = self._functions.of_part(many.members[0].part, Role.VALUE)
        body.add(f"float {name} = {limit};")
        statement = f"{name} = min({name}, {call.name}(p - {{at}}{{values}}));"
        self.loop(many, body, statement, f"box_distance(p - {{centre}}, {{half}}) < {name}")

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
        stems = (("meet_", ""), ("", "_at"), ("", "_look"), ("", "_table"), ("", "_boxes"))
        names = [fresh(f"{stem}{many.name}{tail}") for stem, tail in stems]
        groups = clustered(many.members)
        record = Record(
            names[0],
            names[1],
            values,
            names[2],
            names[3],
            names[4],
            len(groups),
            math.ceil(floats / 4),
            self._at_once,
        )
        self.tables += [self._table(groups, record), _boxes(groups, record)]
        return record

    def _table(self, groups: list[list[Closed]], record: Record) -> str:
        lines = [
            f"// place, size{', material' * (len(self._materials) > 1)}: {CLUSTER} rows a cluster, the last one padded"
        ]
        lines.append(f"const vec4 {record.table}[{CLUSTER * len(groups) * record.width}] = vec4[](")
        members = [m for group in groups for m in [*group, *[group[-1]] * (CLUSTER - len(group))]]
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


def _boxes(groups: list[list[Closed]], record: Record) -> str:
    rows = []
    for group in groups:
        box = group[0].part.box
        for member in group[1:]:
            box = box.hull(member.part.box)
        box = box.widened(_SKIN)
        rows += [f"vec4({', '.join(literal(x) for x in xyz)}, 0.0)" for xyz in (box.centre, box.half)]
    head = f"const vec4 {record.clusters}[{2 * len(groups)}] = vec4[]("
    return "\n".join(["// the clusters' boxes: centre, half size", head, "    " + ",\n    ".join(rows), ");", ""])
