"""Whether an operation looks at its children's values at the point itself, and at nothing else."""

from __future__ import annotations

from sdfc.field.graph import Expr, FieldGraph, Type, inputs_of
from sdfc.shape.definition import Distance
from sdfc.shape.graph import Apply


def is_pointwise(shape: Apply, values: FieldGraph) -> bool:
    """Then a map of space may as well be applied to its children. A round is, a displacement or a twist is not."""
    if not shape.children:
        return False
    return values.remembered((is_pointwise, shape.definition, shape.arguments), lambda: _is_pointwise(shape, values))


def _is_pointwise(shape: Apply, values: FieldGraph) -> bool:
    p = values.input("p", Type(shape.dimension))
    asked: list[Expr] = []

    def child(name: str) -> Distance:
        def value(q: Expr) -> Expr:
            asked.append(q)
            return values.input(f"value of {name}", Type.FLOAT)

        return value

    children = {parameter.name: child(parameter.name) for parameter in shape.definition.children}
    root = shape.definition.formula(p, shape.environment, children)
    return all(q is p for q in asked) and p not in inputs_of(root)
