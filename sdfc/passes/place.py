"""Transforms are composed in float64 and carried to the leaves; uniform scales go into sizes."""

from __future__ import annotations

from typing import assert_never

from sdfc.facts.parity import even_axes
from sdfc.facts.pointwise import is_pointwise
from sdfc.field.graph import FieldGraph
from sdfc.passes.motion import NOWHERE, Fixed, Live, Motion, Motions, backward_axes, is_nowhere, turned_round
from sdfc.passes.rewrite import descend
from sdfc.shape.definition import Argument
from sdfc.shape.graph import Affine, Apply, Complement, Intersection, Nothing, Paint, Shape, ShapeGraph, Union


def place(root: Shape, graph: ShapeGraph, values: FieldGraph) -> Shape:
    """Afterwards an Affine stands only directly on an Apply, and none is the identity. A uniform scale has gone into
    the lengths of every definition that is dimensionally consistent. Solids are the same sets; fields are the same
    where maps are similarities. An axis across which a primitive is its own mirror image is turned to point forward."""
    placer = _Placer(graph, values)
    start: Motion = NOWHERE
    return descend(root, start, placer.below, placer.make)


class _Placer:
    def __init__(self, graph: ShapeGraph, values: FieldGraph) -> None:
        self._graph = graph
        self._values = values
        self._motions = Motions(values)
        self._even: dict[int, tuple[bool, ...]] = {}
        self._products: dict[tuple[Argument, float], Argument] = {}

    def below(self, shape: Shape, motion: Motion) -> list[tuple[Shape, Motion]]:
        match shape:
            case Affine():
                return [(shape.child, self._motions.after(motion, shape))]
            case Union() | Intersection():
                return [(c, motion) for c in shape.children]
            case Complement() | Paint():
                return [(shape.child, motion)]
            case Apply() if not shape.children:
                return []
            case Apply():
                inner = NOWHERE if self._scale_for_children(shape, motion) is None else motion
                return [(c, inner) for c in shape.children]
            case Nothing():
                return []
            case _:
                assert_never(shape)

    def make(self, shape: Shape, motion: Motion, children: tuple[Shape, ...]) -> Shape:
        match shape:
            case Affine():
                return children[0]
            case Apply() if shape.children:
                return self._operation(shape, motion, children)
            case Apply():
                return self._primitive(shape, motion)
            case _:
                return self._graph.with_children(shape, children)

    def _operation(self, shape: Apply, motion: Motion, children: tuple[Shape, ...]) -> Shape:
        scale = self._scale_for_children(shape, motion)
        if scale is None:
            return self._moved(self._graph.with_children(shape, children), motion)
        return self._graph.apply(shape.definition, self._scaled(shape, scale), children, shape.span)

    def _primitive(self, shape: Apply, motion: Motion) -> Shape:
        scale = self._scale(shape, motion)
        if scale is None or scale == 1.0:
            return self._moved(shape, self._forward(shape, motion))
        scaled = self._graph.apply(shape.definition, self._scaled(shape, scale), (), shape.span)
        return self._moved(scaled, self._forward(shape, self._motions.unscaled(motion, scale, shape.dimension)))

    def _forward(self, shape: Apply, motion: Motion) -> Motion:
        """The same place of the primitive, with its axes forward where it has mirror planes across them. Its rays,
        gauge and bounds are claims about the same solid."""
        match motion:
            case Fixed():
                backward = backward_axes(motion, shape.dimension)
                if not backward:
                    return motion
                key = id(shape.definition)
                if key not in self._even:
                    self._even[key] = even_axes(shape.definition, shape.arguments, self._values)
                return turned_round(motion, [axis for axis in backward if self._even[key][axis]])
            case Live():
                return motion
            case _:
                assert_never(motion)

    def _scale(self, shape: Apply, motion: Motion) -> float | None:
        """The factor that may go into the definition's lengths."""
        return self._motions.scale(motion, shape.dimension) if shape.definition.claims.homogeneous else None

    def _scale_for_children(self, shape: Apply, motion: Motion) -> float | None:
        """The same, where the map may go on to the children besides."""
        return self._scale(shape, motion) if is_pointwise(shape, self._values) else None

    def _moved(self, inner: Shape, motion: Motion) -> Shape:
        if is_nowhere(motion):
            return inner
        forward, inverse = self._motions.matrices(motion)
        return self._graph.affine(forward, inverse, inner, inner.span)

    def _scaled(self, shape: Apply, scale: float) -> tuple[Argument, ...]:
        """The arguments, lengths times the scale."""
        if scale == 1.0:
            return shape.arguments
        pairs = zip(shape.definition.values, shape.arguments, strict=True)
        return tuple([self._times(a, scale) if p.kind.is_length else a for p, a in pairs])

    def _times(self, argument: Argument, scale: float) -> Argument:
        """Remembered: parts that are alike are many."""
        if (argument, scale) not in self._products:
            made = tuple([e * scale for e in argument]) if isinstance(argument, tuple) else argument * scale
            self._products[argument, scale] = made
        return self._products[argument, scale]
