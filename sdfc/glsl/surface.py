"""What is at a hit: one pass over the tree that keeps the gradient and the material of the part whose surface it is.

Where faces meet within rounding, their values at the hit do not tell which one the ray enters by. So where there may be
seams, parts are ranked by their values a little way back along the ray: from there the face that it enters by is ahead.
One that it runs along is not, nor one that is buried where two parts touch, whose other part is as near.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import assert_never

from sdfc.field.graph import Expr, FieldGraph, Op, Type
from sdfc.glsl.body import Body, own_point
from sdfc.glsl.expression import literal, type_name
from sdfc.glsl.functions import Functions, Role
from sdfc.glsl.live import Live
from sdfc.glsl.many import ManyWriter
from sdfc.plan.gather import is_translation
from sdfc.plan.steps import (
    FLATTEST,
    All,
    Any,
    Ball,
    Blend,
    BlendNode,
    BlendTree,
    BlendUnion,
    Chord,
    Closed,
    Falling,
    Many,
    Part,
    Step,
    Tangent,
    Within,
    may_have_seams,
)
from sdfc.shape.material import Material
from sdfc.shape.matrix import transposed

_BACK = "8.0"  # so far back, in roundings
_NOWHERE = "0.0"  # what is added to a value to rank it, where nothing is
_SUNK = "3.0"  # what is marched is sunk so far in an intersection (sdfc/glsl/proven)

PROPERTIES = ("color", "metallic", "roughness", "emission", "transmission", "ior", "tint")


@dataclass(frozen=True, slots=True)
class SurfaceText:
    """`structure` declares Surface and what makes and joins one; `function` is `surface(p, d, fine)`: at a hit of the
    ray along the unit vector d, right to `fine`.

    `properties` gives, for each of PROPERTIES, the GLSL text of it for a Surface `s`: a member, or a constant.
    """

    structure: str
    function: str
    properties: dict[str, str]


class SurfaceWriter:
    """Writes one scene's surface function."""

    def __init__(
        self,
        graph: FieldGraph,
        functions: Functions,
        live: Live,
        materials: Sequence[Material],
        many: ManyWriter | None,
    ) -> None:
        self._graph = graph
        self._functions = functions
        self._live = live
        self._materials = list(materials)
        self._many = many  # None: nothing has recorded the nearest of many
        self._names = {id(m): functions.names.fresh(f"{m.name}_material") for m in materials}
        self._painted = False
        self._declared: set[str] = set()
        self._varying = [
            p
            for p in PROPERTIES
            if len({property_of(m, p).id for m in materials}) > 1 or self._is_computed(property_of(materials[0], p))
        ]
        self._p, self._before = graph.input("p"), graph.input("before")
        self._count = 0
        self._blends = False
        self._looks_back = False

    def write(self, root: Step) -> SurfaceText:
        self._looks_back = may_have_seams(root)
        body = Body(self._live)
        result = self._fold(root, body)
        body.give(result)
        lines = body.written()
        head = ["Surface surface(vec3 p, vec3 d, float fine) {"]
        if self._looks_back:
            head.append(f"    vec3 back = -{_BACK} * fine * d, before = p + back;")
        if any("sunk" in line for line in lines):
            head.append(f"    float sunk = {_SUNK} * fine;  // what is marched, in an intersection")
        function = "\n".join([*head, *lines, "}", ""])
        return SurfaceText(self._structure(), function, self._properties())

    # declarations

    def _structure(self) -> str:
        members = ["vec4 field;  // gradient and value"]
        members += ["float rank;  // the value of what is traced, a little way back"] * self._looks_back
        members += ["float material;"]
        members += [f"{type_name(property_of(self._materials[0], p).type)} {p};" for p in self._varying]
        rank = "rank" if self._looks_back else "field.w"
        lines = ["struct Surface {", *(f"    {m}" for m in members), "};", ""]
        lines += [
            f"Surface nearer(Surface a, Surface b) {{ if (b.{rank} < a.{rank}) return b; return a; }}",
            f"Surface farther(Surface a, Surface b) {{ if (b.{rank} > a.{rank}) return b; return a; }}",
            "",
        ]
        for index, material in enumerate(self._materials):
            lines += self._constructor(index, material)
        lines += self._choice() if self._painted else []
        return "\n".join(lines + (self._mixing() if self._blends else []))

    def _constructor(self, index: int, material: Material) -> list[str]:
        body = Body(self._live)
        values = body.texts([property_of(material, p) for p in self._varying])
        arguments = ", ".join(["field", *["rank"] * self._looks_back, f"{index}.0", *values])
        return [
            f"Surface {self._names[id(material)]}(vec4 field{', float rank' * self._looks_back}) {{",
            *body.lines,
            f"    return Surface({arguments});",
            "}",
            "",
        ]

    def _choice(self) -> list[str]:
        names = [self._names[id(m)] for m in self._materials]
        rank = ", rank" * self._looks_back
        chosen = [f"    if (material == {i}.0) s = {name}(field{rank});" for i, name in enumerate(names) if i]
        head = f"Surface painted(vec4 field{', float rank' * self._looks_back}, float material) {{"
        return [head, f"    Surface s = {names[0]}(field{rank});", *chosen, "    return s;", "}", ""]

    def _mixing(self) -> list[str]:
        mixed = ["field", *["field.w + ahead"] * self._looks_back, "w.y > w.x ? b.material : a.material"]
        mixed += [f"mix(a.{p}, b.{p}, share)" for p in self._varying]
        return [
            "// a blend: w holds the derivatives by a and b, and the value",
            f"Surface blended(Surface a, Surface b, vec3 w{', vec3 back, float sunk' * self._looks_back}) {{",
            "    float share = w.y / max(w.x + w.y, 1e-6);",
            "    vec4 field = vec4(w.x * a.field.xyz + w.y * b.field.xyz, w.z);",
            *["    float ahead = dot(field.xyz, back) + sunk;"] * self._looks_back,
            f"    return Surface({', '.join(mixed)});",
            "}",
            "",
        ]

    def _is_computed(self, value: Expr) -> bool:
        """Whether its text takes statements, where there is no main that could begin with them."""
        if not self._live.shares:
            return False
        body = Body(self._live)
        body.text(value)
        return bool(body.lines)

    def _properties(self) -> dict[str, str]:
        body = Body(self._live)
        texts = {}
        for name in PROPERTIES:
            fixed = property_of(self._materials[0], name)
            texts[name] = f"s.{name}" if name in self._varying else body.text(fixed)
        assert not body.lines, "a property's value is a constant or a param"
        return texts

    # the tree

    def _fold(self, step: Step, body: Body, sunk: str = _NOWHERE) -> str:
        match step:
            case Closed():
                return self._leaf(step.part, body, step.inside, Role.SURFACE, _NOWHERE)
            case Ball():
                # over its constant: then the gradient says how much of a distance the value is
                flat = step if step.is_no_distance else None
                return self._leaf(step.part, body, step.inside, Role.SURFACE, sunk, step.scale, flat)
            case Tangent():
                return self._leaf(step.part, body, True, Role.SURFACE, sunk)
            case Chord():
                return self._leaf(step.part, body, False, Role.SURFACE, sunk)
            case Many():
                return self._nearest(step, body)
            case Blend():
                return self._blend(step.tree, body, sunk)
            case Within():
                return self._fold(step.step, body, sunk)
            case Any():
                return self._joined("nearer", step.steps, body, sunk)
            case All():
                return self._joined("farther", step.steps, body, "sunk")
            case _:
                assert_never(step)

    def _joined(self, operation: str, steps: tuple[Step, ...], body: Body, sunk: str) -> str:
        name = self._name()
        if not steps:
            far = self._made(self._names[id(self._materials[0])], "vec4(0.0, 1.0, 0.0, FAR)", "FAR")
            body.add(f"Surface {name} = {far};")
            return name
        body.add(f"Surface {name} = {self._fold(steps[0], body, sunk)};")
        for step in steps[1:]:
            text = self._fold(step, body, sunk)
            body.add(f"{name} = {operation}({name}, {text});")
        return name

    def _nearest(self, step: Many, body: Body) -> str:
        if self._many is None:
            return self._joined("nearer", step.members, body, _NOWHERE)
        field = self._many.surface(step, body)
        rank = f"{field}.w + dot({field}.xyz, back)"
        if len(self._materials) == 1:
            return self._made(self._names[id(self._materials[0])], field, rank)
        self._painted = True
        return self._made("painted", field, rank, self._many.record(step).material)

    def _made(self, constructor: str, field: str, rank: str, *more: str) -> str:
        return f"{constructor}({', '.join([field, *[rank] * self._looks_back, *more])})"

    def _leaf(
        self,
        part: Part,
        body: Body,
        inside: bool,
        role: Role,
        sunk: str,
        scale: float = 1.0,
        flat: Ball | None = None,
    ) -> str:
        """`flat`: the step, where its values are no distances."""
        stretch = part.stretch * scale
        q = body.point(own_point(part.inverse, self._p), f"q_{part.name}")
        call = self._functions.of_part(part, role)
        field, sign = body.call(call, [q]), "" if inside else "-"
        if part.inverse is not None and not is_translation(part.inverse):
            field = self._turned_back(part, role, field, stretch, body)
        elif not (stretch.is_constant and stretch.number == 1.0):
            field = f"({body.text(stretch)} * {field})"
        rank = ""
        if self._looks_back:
            before = body.point(own_point(part.inverse, self._before), f"q_{part.name}_before")
            scaled = "" if stretch.is_constant and stretch.number == 1.0 else f"{body.text(stretch)} * "
            rank = f"{sign}{scaled}{body.call(call, [before])}.w"
            if flat is not None:
                body.once(f"vec4 flat_{part.name} = {field};")
                field = f"flat_{part.name}"
                rank = _flat_rank(flat, field, rank, sunk)
            else:
                rank += "" if sunk == _NOWHERE else f" + {sunk}"
        if len(part.looks) > 1:
            self._painted = True
            look = body.call(self._functions.of_part(part, Role.LOOK), [q])
            return self._made("painted", sign + field, rank, look)
        return self._made(self._names[id(part.material)], sign + field, rank)

    def _turned_back(self, part: Part, role: Role, field: str, stretch: Expr, body: Body) -> str:
        """The text of what the part's function gives, in the scene's space: a swizzle of the call if that is enough."""
        name = self._gradient_name(part, role)
        turned = self._turned(part, name, stretch)
        if turned.op is Op.VECTOR and all(a.op is Op.SWIZZLE for a in turned.args):
            return f"{field}.{''.join('xyzw'[int(i)] for a in turned.args for i in a.value or ())}"
        if name not in self._declared:  # a part may have several places in the tree
            self._declared.add(name)
            body.declare(Type.VEC4, name, field, part.span)
        return body.text(turned)

    def _gradient_name(self, part: Part, role: Role) -> str:
        """Of the local that holds what the part's function gives."""
        return f"g_{part.name}{'' if role is Role.SURFACE else '_distance'}"

    def _turned(self, part: Part, name: str, stretch: Expr) -> Expr:
        """The gradient in the scene's space: A^T g for the map p -> A p + b to the part's own space."""
        assert part.inverse is not None
        own = self._graph.input(name, Type.VEC4)
        g = transposed(part.inverse).direction(own.swizzle("xyz"))
        return self._graph.vector(g[0], g[1], g[2], own[3]) * stretch

    def _blend(self, tree: BlendTree, body: Body, sunk: str) -> str:
        match tree:
            case Tangent():
                return self._leaf(tree.part, body, True, Role.DISTANCE_SURFACE, sunk)
            case Falling():
                return self._leaf(tree.part, body, tree.inside, Role.DISTANCE_SURFACE, sunk)
            case BlendUnion():
                texts = [self._blend(t, body, sunk) for t in tree.operands]
                result = texts[0]
                for text in texts[1:]:
                    result = f"nearer({result}, {text})"
                return result
            case BlendNode():
                return self._blend_node(tree, body, sunk)
            case _:
                assert_never(tree)

    def _blend_node(self, tree: BlendNode, body: Body, sunk: str) -> str:
        self._blends = True
        first, second, name = self._name(), self._name(), self._name()
        body.add(f"Surface {first} = {self._blend(tree.first, body, sunk)};")
        body.add(f"Surface {second} = {self._blend(tree.second, body, sunk)};")
        weights = body.call(self._functions.weights(tree.shape), [f"{first}.field.w", f"{second}.field.w"])
        back = f", back, {sunk}" * self._looks_back
        body.add(f"Surface {name} = blended({first}, {second}, {weights}{back});", tree.shape.span)
        return name

    def _name(self) -> str:
        self._count += 1
        return f"s{self._count}"


def _flat_rank(ball: Ball, field: str, value: str, sunk: str) -> str:
    """The rank of what is no distance: how far off it is by its slope. What goes by pieces is sunk by that too."""
    if sunk != _NOWHERE:
        value += f" + {sunk} * abs(dot({field}.xyz, d))" if ball.ahead else f" + {sunk}"
    return f"({value}) / max(length({field}.xyz), {literal(FLATTEST)})"


def property_of(material: Material, name: str) -> Expr:
    """One of PROPERTIES."""
    value = getattr(material, name)
    assert isinstance(value, Expr)
    return value
