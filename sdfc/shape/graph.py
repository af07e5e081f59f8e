"""The shape graph: a scene as meant. Interned nodes, no names, no loops; values are expressions over params."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TypeAlias, TypeVar

from sdfc.diagnostics import Span
from sdfc.shape.definition import Argument, Definition
from sdfc.shape.material import Material
from sdfc.shape.matrix import Matrix


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Node:
    """What every node has. Equal means identical: only ShapeGraph makes nodes."""

    id: int
    span: Span  # of the first place that asked for it; not part of what makes nodes equal
    dimension: int  # 3 in space, 2 in the plane
    children: tuple[Shape, ...] = field(default=(), repr=False)  # all that it is made of


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Apply(Node):
    """A definition with its arguments: a primitive where there are no children, else a distance operation.

    `arguments` go with `definition.values`, `children` with `definition.children`, in order.
    """

    definition: Definition
    arguments: tuple[Argument, ...] = field(repr=False)

    @property
    def environment(self) -> dict[str, Argument]:
        return dict(zip(self.definition.names, self.arguments, strict=True))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Affine(Node):
    """The child moved by an affine map: its field at `inverse(p)`, times the map's smallest stretch."""

    forward: Matrix = field(repr=False)
    inverse: Matrix = field(repr=False)
    child: Shape = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Union(Node):
    """Every point of a child."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Intersection(Node):
    """The points of all children."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Complement(Node):
    child: Shape = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Paint(Node):
    """The child's parts that have no material yet get this one."""

    material: Material
    child: Shape = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Nothing(Node):
    """The empty solid: what a scene is in which nothing remains."""


Shape: TypeAlias = Apply | Affine | Union | Intersection | Complement | Paint | Nothing
Combination = TypeVar("Combination", Union, Intersection)


class ShapeGraph:
    """All shapes of one compilation; equal shapes are one node."""

    def __init__(self) -> None:
        self._nodes: dict[tuple[object, ...], Shape] = {}
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def _next(self) -> int:
        self._count += 1
        return self._count

    def apply(
        self,
        definition: Definition,
        arguments: Iterable[Argument],
        children: Iterable[Shape],
        span: Span,
    ) -> Shape:
        values, parts = tuple(arguments), tuple(children)
        key = (Apply, definition, values, parts)
        return self._nodes.get(key) or self._nodes.setdefault(
            key,
            Apply(
                id=self._next(),
                span=span,
                dimension=definition.dimension,
                definition=definition,
                arguments=values,
                children=parts,
            ),
        )

    def affine(self, forward: Matrix, inverse: Matrix, child: Shape, span: Span) -> Shape:
        key = (Affine, forward.entries, inverse.entries, child)
        return self._nodes.get(key) or self._nodes.setdefault(
            key,
            Affine(
                id=self._next(),
                span=span,
                dimension=child.dimension,
                children=(child,),
                forward=forward,
                inverse=inverse,
                child=child,
            ),
        )

    def _combine(
        self, kind: type[Combination], children: tuple[Shape, ...], span: Span, dimension: int | None
    ) -> Shape:
        if not children:
            return self.nothing(span, dimension or 3)
        key = (kind, children)
        return self._nodes.get(key) or self._nodes.setdefault(
            key, kind(id=self._next(), span=span, dimension=children[0].dimension, children=children)
        )

    def union(self, children: Iterable[Shape], span: Span, dimension: int | None = None) -> Shape:
        return self._combine(Union, tuple(children), span, dimension)

    def intersection(self, children: Iterable[Shape], span: Span, dimension: int | None = None) -> Shape:
        return self._combine(Intersection, tuple(children), span, dimension)

    def complement(self, child: Shape, span: Span) -> Shape:
        key = (Complement, child)
        return self._nodes.get(key) or self._nodes.setdefault(
            key, Complement(id=self._next(), span=span, dimension=child.dimension, children=(child,), child=child)
        )

    def difference(self, first: Shape, rest: Iterable[Shape], span: Span) -> Shape:
        """`first` without any of `rest`."""
        return self.intersection((first, *(self.complement(r, r.span) for r in rest)), span)

    def paint(self, material: Material, child: Shape, span: Span) -> Shape:
        key = (Paint, material, child)
        return self._nodes.get(key) or self._nodes.setdefault(
            key,
            Paint(
                id=self._next(),
                span=span,
                dimension=child.dimension,
                children=(child,),
                material=material,
                child=child,
            ),
        )

    def nothing(self, span: Span, dimension: int = 3) -> Shape:
        key = (Nothing, dimension)
        return self._nodes.get(key) or self._nodes.setdefault(
            key, Nothing(id=self._next(), span=span, dimension=dimension)
        )

    def with_children(self, shape: Shape, children: tuple[Shape, ...]) -> Shape:
        """The same node over other children (the node itself where they are the same)."""
        if children == shape.children:
            return shape
        match shape:
            case Apply():
                return self.apply(shape.definition, shape.arguments, children, shape.span)
            case Affine():
                return self.affine(shape.forward, shape.inverse, children[0], shape.span)
            case Union():
                return self.union(children, shape.span)
            case Intersection():
                return self.intersection(children, shape.span)
            case Complement():
                return self.complement(children[0], shape.span)
            case Paint():
                return self.paint(shape.material, children[0], shape.span)
            case Nothing():
                return shape


def topological(root: Shape) -> list[Shape]:
    """Every node below the root, children before parents, each once. Iterative: depth is no limit."""
    order: list[Shape] = []
    done: set[Shape] = set()
    stack = [root]
    while stack:
        node = stack.pop()
        if node in done:
            continue
        if done.issuperset(node.children):
            done.add(node)
            order.append(node)
        else:
            stack.append(node)  # again, when its children are there
            stack += node.children[::-1]
    return order


def definitions_of(root: Shape) -> list[Definition]:
    """All that are applied below the root, each once."""
    return list(dict.fromkeys([node.definition for node in topological(root) if isinstance(node, Apply)]))


__all__ = [
    "Affine",
    "Apply",
    "Complement",
    "Intersection",
    "Node",
    "Nothing",
    "Paint",
    "Shape",
    "ShapeGraph",
    "Union",
    "definitions_of",
    "topological",
]
