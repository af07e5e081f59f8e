"""Smooth unions: stepped by the blend of lines below their operands, which is concave and below the field."""

from __future__ import annotations

from typing import assert_never

from sdfc.field.graph import Expr, FieldGraph, Type
from sdfc.glsl.body import Body, own_point
from sdfc.glsl.expression import literal
from sdfc.glsl.functions import Call, Functions, Role
from sdfc.glsl.live import Live
from sdfc.plan.steps import Blend, BlendLeaf, BlendNode, BlendTree, BlendUnion, Falling, Part, Tangent


class BlendWriter:
    """Writes a function for each blend: its value where each operand is replaced by its line, `tau` further on."""

    def __init__(self, graph: FieldGraph, functions: Functions, live: Live) -> None:
        self._graph = graph
        self._functions = functions
        self._live = live
        self.texts: list[str] = []
        self._written: set[str] = set()

    def slope(self, body: Body, part: Part, direction: Expr, role: Role = Role.SLOPE) -> str:
        """The text of vec2(value, derivative along the ray) of a convex part, in the scene's units."""
        q = body.point(own_point(part.inverse, self._graph.input("p")), f"q_{part.name}")
        text = body.call(self._functions.of_part(part, role), [q, body.text(direction)])
        return text if _is_one(part.stretch) else f"{body.text(part.stretch)} * {text}"

    def convex_parts_of(self, blend: Blend) -> list[Part]:
        """The parts whose slope along the ray is asked for."""
        return [leaf.part for leaf in _leaves(blend.tree) if isinstance(leaf, Tangent)]

    def next(self, body: Body, blend: Blend, directions: dict[int, Expr], cut: bool) -> str:
        name = blend.part.name
        leaves = _leaves(blend.tree)
        parts = [leaf.part for leaf in leaves]
        if name not in self._written:
            self._written.add(name)
            self._function(blend, parts)
        for leaf in leaves:
            body.once(f"vec2 v_{leaf.part.name} = {self._line(body, leaf, directions)};", leaf.part.span)
        arguments = ", ".join(f"v_{part.name}" for part in parts)
        body.once(f"float v_{name} = {name}_ahead(0.0, {arguments});", blend.part.span)
        fine = "0.5 * fine - sunk" if cut else "0.5 * fine"
        left = f"left_{name}{'_cut' if cut else ''}"
        body.once(f"float {left} = {name}_clear(v_{name}, {fine}, {arguments});")
        least = literal(1.0 / max(blend.lipschitz, 1e-9))
        step = f"max({left}, {least} * v_{name})" if blend.lipschitz != 1.0 else f"max({left}, v_{name})"
        value = f"v_{name} + sunk" if cut else f"v_{name}"
        return f"ball(t, {value} <= fine ? {value} : {step}, fine)"

    def _line(self, body: Body, leaf: BlendLeaf, directions: dict[int, Expr]) -> str:
        match leaf:
            case Tangent():
                return self.slope(body, leaf.part, directions[id(leaf.part)], Role.DISTANCE_SLOPE)
            case Falling():
                part = leaf.part
                q = body.point(own_point(part.inverse, self._graph.input("p")), f"q_{part.name}")
                text = body.call(self._functions.of_part(part, Role.VALUE), [q])
                text = text if _is_one(part.stretch) else f"{body.text(part.stretch)} * {text}"
                return f"vec2({'' if leaf.inside else '-'}{text}, {literal(-leaf.lipschitz)})"
            case _:
                assert_never(leaf)

    def _function(self, blend: Blend, parts: list[Part]) -> None:
        name = blend.part.name
        formal = ", ".join(f"vec2 v_{part.name}" for part in parts)
        actual = ", ".join(f"v_{part.name}" for part in parts)
        body = Body(self._live)
        for part in parts:
            body.add(f"float {part.name} = v_{part.name}.x + tau * v_{part.name}.y;")
        body.add(f"return {self._tree(blend.tree, body)};")
        head = f"float {name}_ahead(float tau, {formal}) {{"
        doc = "// the blend of the operands' lines, tau ahead: concave in tau, and never above the field"
        self.texts.append("\n".join([doc, head, *body.lines, "}", ""]))
        steeper = " ".join(f"v_{part.name}.y -= 2.4e-7;" for part in parts)
        root = f"line_root(v_{parts[0].name}, level)"
        for part in parts[1:]:
            root = f"min({root}, line_root(v_{part.name}, level))"
        self.texts.append(_CLEAR.format(name=name, formal=formal, actual=actual, steeper=steeper, root=root))

    def _tree(self, tree: BlendTree, body: Body) -> str:
        match tree:
            case Tangent() | Falling():
                return tree.part.name
            case BlendUnion():
                names = [self._tree(t, body) for t in tree.operands]
                text = names[0]
                for other in names[1:]:
                    text = f"min({text}, {other})"
                return text
            case BlendNode():
                first, second = self._tree(tree.first, body), self._tree(tree.second, body)
                weights: Call = self._functions.joined(tree.shape)
                name = f"joined_{len(body.lines)}"
                body.declare(Type.FLOAT, name, body.call(weights, [first, second]), tree.shape.span)
                return name
            case _:
                assert_never(tree)


# The root lies before that of the first operand's line. Up to there the blend is concave: a kernel that is carried on
# below 0 less steeply (`round`) is not, beyond. Two bounds close in on the root: a chord crosses before it, the line
# through two points on the left crosses after it. The left one is proven, but for rounding, and is the step. In a blend
# of blends an operand may pass 0 before its lines do: a chord that comes down too far is one more bound on the right.
# Two rounds, written out: LLVM's time doubles with every loop of a shader (measured on llvmpipe).
_CLEAR = """// where the blend of the operands' lines comes down to `level`: left and right of it, and their values
void {name}_closer(inout vec4 bracket, float level, {formal}) {{
    if (bracket.w > 0.0) return;  // the right end is left of the root by rounding: there is nothing to gain
    float left = bracket.x, left_value = bracket.z;
    float chord = left + (bracket.y - left) * left_value / max(left_value - bracket.w, 1e-30);
    float at_chord = {name}_ahead(chord, {actual}) - level;
    float beyond = chord + (chord - left) * at_chord / max(left_value - at_chord, 1e-30);
    bool closer = at_chord > 0.0 && left_value > at_chord && beyond < bracket.y;
    float right = closer ? beyond : bracket.y;
    float right_value = closer ? {name}_ahead(right, {actual}) - level : bracket.w;
    bool over = at_chord < -1e-6 * (1.0 + left_value);
    bracket = over ? vec4(left, chord, left_value, at_chord) : vec4(chord, right, max(at_chord, 0.0), right_value);
}}
float {name}_clear(float value, float level, {formal}) {{
    {steeper}  // no line falls less than its slope may be off by
    vec4 bracket = vec4(0.0, {root}, value - level, 0.0);
    bracket.w = {name}_ahead(bracket.y, {actual}) - level;
    if (bracket.w > 0.0) return bracket.y;
    {name}_closer(bracket, level, {actual});
    {name}_closer(bracket, level, {actual});
    return bracket.x * 0.9999996;
}}
"""


def _leaves(tree: BlendTree) -> list[BlendLeaf]:
    """The operands, in order, each part once."""
    found: dict[int, BlendLeaf] = {}
    stack = [tree]
    while stack:
        node = stack.pop()
        match node:
            case BlendUnion():
                stack.extend(reversed(node.operands))
            case BlendNode():
                stack.extend((node.second, node.first))
            case Tangent() | Falling():
                found.setdefault(id(node.part), node)
            case _:
                assert_never(node)
    return list(found.values())


def _is_one(value: Expr) -> bool:
    return value.is_constant and value.number == 1.0
