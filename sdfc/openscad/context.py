"""What one file is read into: the graphs, the standard library, and what there is to tell the author."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

from sdfc.diagnostics import Diagnostic, InternalError, Source, Span
from sdfc.field.graph import Expr, FieldGraph
from sdfc.openscad import space
from sdfc.openscad.fields import field
from sdfc.openscad.polytope import Plane
from sdfc.openscad.refusal import RefusalError
from sdfc.openscad.space import Map3, Point
from sdfc.scene.library import Library
from sdfc.shape.definition import Argument, Definition
from sdfc.shape.graph import Affine, Shape, ShapeGraph
from sdfc.shape.material import Material
from sdfc.shape.matrix import Matrix

LARGEST = 1e15
Y_TO_Z: Map3 = ((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, -1.0, 0.0), (0.0, 1.0, 0.0, 0.0))


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """Builds shapes at places of one source."""

    source: Source
    values: FieldGraph
    shapes: ShapeGraph
    library: Library
    warnings: list[Diagnostic] = dataclasses.field(default_factory=list)
    materials: dict[tuple[float, ...], Material] = dataclasses.field(default_factory=dict)
    own_fields: dict[str, Definition] = dataclasses.field(default_factory=dict)

    def warn(self, message: str, span: Span, hint: str | None = None) -> None:
        self.warnings.append(Diagnostic(message, span, hint, "warning"))

    def apply(self, name: str, span: Span, *children: Shape, **arguments: Argument) -> Shape:
        """A standard definition, or one of fields.py; parameters that are not given have their defaults."""
        definition = self._definition(name)
        environment: dict[str, Argument] = {}
        for parameter in definition.values:
            given = arguments.pop(parameter.name, None)
            if given is None and parameter.default is not None:
                given = parameter.default(environment)
            if given is None:
                raise InternalError(f"'{name}' needs '{parameter.name}'")
            environment[parameter.name] = given
        if arguments:
            raise InternalError(f"'{name}' has no '{next(iter(arguments))}'")
        return self.shapes.apply(definition, environment.values(), children, span)

    def _definition(self, name: str) -> Definition:
        """One object for one name."""
        made = self.library.definition(name) or self.own_fields.get(name)
        if made is None:
            made = field(name, self.values)
            if made is None:
                raise InternalError(f"there is no field '{name}'")
            self.own_fields[name] = made
        return made

    def number(self, value: float) -> Expr:
        return self.values.constant(value)

    def vector(self, components: Sequence[float]) -> Expr:
        return self.values.constant(*components)

    def moved(self, move: Map3, child: Shape, span: Span) -> Shape:
        """The child under an affine map; a map of a map is one, and the identity none."""
        if isinstance(child, Affine):
            first = child.forward
            rows = [
                (*(e.number for e in row), shift.number) for row, shift in zip(first.linear, first.offset, strict=True)
            ]
            move, child = space.after(move, rows), child.child
        if move == space.IDENTITY:
            return child
        back = space.inverse(move)
        if not all(abs(value) <= LARGEST for row in (*move, *back) for value in row):  # also what is not a number
            hint = f"the entries of a matrix and of its inverse go to {LARGEST:g}"
            raise RefusalError("this is moved or scaled too far", hint)
        return self.shapes.affine(self._matrix(move), self._matrix(back), child, span)

    def _matrix(self, move: Map3) -> Matrix:
        constant = self.values.constant
        a, b, c = ((constant(row[0]), constant(row[1]), constant(row[2])) for row in move)
        x, y, z = (constant(row[3]) for row in move)
        return Matrix((a, b, c), (x, y, z))

    def raised(self, child: Shape, height: float, span: Span) -> Shape:
        """The child, made along y, stood up along z and moved up."""
        (a, b, (c, d, e, _)) = Y_TO_Z
        return self.moved((a, b, (c, d, e, height)), child, span)

    def box(self, lo: Point, hi: Point, span: Span) -> Shape:
        """An upright box between two corners."""
        size = [b - a for a, b in zip(lo, hi, strict=True)]
        x, y, z = (0.5 * (a + b) for a, b in zip(lo, hi, strict=True))
        shape = self.apply("box", span, size=self.vector(size))
        return self.moved(space.translation((x, y, z)), shape, span)

    def planes(self, planes: Sequence[Plane], span: Span) -> Shape:
        """All that is under every plane; it may have no end."""
        if len(planes) == 1:
            return self.apply("plane", span, normal=self.vector(planes[0][0]), offset=self.number(planes[0][1]))
        return self.apply(
            "convex_polyhedron",
            span,
            normals=tuple(self.vector(n) for n, _ in planes),
            offsets=tuple(self.number(d) for _, d in planes),
        )

    def polytope(self, corners: Sequence[Point], planes: Sequence[Plane], span: Span) -> Shape:
        """A convex solid: the box around it gives its bounds and its upright faces; its other planes cut that."""
        lo = (min(p[0] for p in corners), min(p[1] for p in corners), min(p[2] for p in corners))
        hi = (max(p[0] for p in corners), max(p[1] for p in corners), max(p[2] for p in corners))
        box = self.box(lo, hi, span)
        slanted = [(n, d) for n, d in planes if max(map(abs, n)) < 1.0 - 1e-12]
        return self.shapes.intersection((box, self.planes(slanted, span)), span) if slanted else box
