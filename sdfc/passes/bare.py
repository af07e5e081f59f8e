"""Users' fields without the factors that only stretch their values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sdfc.field.core import same_zeros
from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.passes.rewrite import descend
from sdfc.shape.definition import Definition, Distance, Environment
from sdfc.shape.graph import Apply, Shape, ShapeGraph, definitions_of


def bare(root: Shape, graph: ShapeGraph, values: FieldGraph) -> Shape:
    """Afterwards no user's field, where only its surface counts, is a product of another with the same surface.

    A distance cubed, or in thousandths, or that levels off, is traced as the distance. What an operation makes of
    a field's values depends on them: below operations nothing changes. Nor where something is claimed of the values.
    """
    if all(definition.is_standard for definition in definitions_of(root)):
        return root
    made: dict[int, Definition] = {}

    def below(shape: Shape, _: None) -> list[tuple[Shape, None]]:
        return [] if _is_operation(shape) else [(child, None) for child in shape.children]

    def make(shape: Shape, _: None, children: tuple[Shape, ...]) -> Shape:
        match shape:
            case Apply() if shape.children:
                return shape
            case Apply():
                definition = shape.definition
                if id(definition) not in made:
                    made[id(definition)] = _without_factors(definition, values)
                barer = made[id(definition)]
                return shape if barer is definition else graph.apply(barer, shape.arguments, (), shape.span)
            case _:
                return graph.with_children(shape, children)

    return descend(root, None, below, make)


def _is_operation(shape: Shape) -> bool:
    match shape:
        case Apply():
            return bool(shape.children)
        case _:
            return False


def _without_factors(definition: Definition, values: FieldGraph) -> Definition:
    """The definition with a formula of the same zeros and signs, if it has factors to lose.

    With parameters of its own it keeps them: printed once for all its arguments, it would not lose those that
    are positive by their values.
    """
    claims = definition.claims
    if definition.is_standard or definition.parameters or claims.lipschitz is not None or claims.bounds_use_level:
        return definition
    value = definition.formula(values.input("p", Type(definition.dimension)), {}, {})
    if same_zeros(value) is value:
        return definition

    def formula(p: Expr, environment: Environment, children: Mapping[str, Distance]) -> Expr:
        return same_zeros(definition.formula(p, environment, children))

    return replace(definition, formula=formula)
