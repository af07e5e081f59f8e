"""Large unions of like parts become tables: compile time stays, and GLSL grows by one line a part."""

from __future__ import annotations

from sdfc.field.graph import Expr
from sdfc.plan.steps import Any, Closed, Many, Step
from sdfc.shape.definition import Kind
from sdfc.shape.matrix import Matrix

FEWEST = 48  # straight-line code takes 4 ms a part to compile on llvmpipe (measured)
_SIMPLE = (Kind.NUMBER, Kind.LENGTH, Kind.ANGLE, Kind.VECTOR2, Kind.VECTOR3, Kind.POINT2, Kind.POINT3)


def gathered(root: Step) -> Step:
    """Afterwards the like members of the root's union, where there are many, are one Many."""
    match root:
        case Any():
            groups: dict[int, list[Closed]] = {}
            for step in root.steps:
                match step:
                    case Closed() if _is_plain(step):
                        groups.setdefault(id(step.part.shape.definition), []).append(step)
                    case _:
                        pass
            large = {key: group for key, group in groups.items() if len(group) >= FEWEST}
            inside = {id(step) for group in large.values() for step in group}
            rest = [step for step in root.steps if id(step) not in inside]
            many = [Many(group[0].part.shape.definition.name, tuple(group)) for group in large.values()]
            return Any((*many, *rest)) if many else root
        case _:
            return root


def _is_plain(step: Closed) -> bool:
    part = step.part
    simple = all(p.kind in _SIMPLE for p in part.shape.definition.values) and part.shape.definition.is_primitive
    constant = all(isinstance(a, Expr) and a.is_constant for a in part.shape.arguments)
    moved = part.inverse is None or (is_translation(part.inverse) and part.inverse.is_constant)
    return step.inside and step.intervals == 1 and simple and constant and moved and part.box.is_finite


def is_translation(matrix: Matrix) -> bool:
    """Whether the map turns and stretches nothing."""
    return all(
        e.is_constant and e.number == (1.0 if i == j else 0.0)
        for i, row in enumerate(matrix.linear)
        for j, e in enumerate(row)
    )
