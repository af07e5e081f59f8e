"""`field` declarations: parameters, formulas and claims become functions that make expressions."""

from collections.abc import Mapping

import pytest
from language_scenes import messages, scene, the

from sdfc.diagnostics import Source
from sdfc.field.graph import Expr, FieldGraph, Type, substitute
from sdfc.scene.define import define
from sdfc.scene.library import Library, standard, standard_names
from sdfc.shape.definition import ChildFacts, Definition, Exactness, Kind
from sdfc.shape.graph import Apply
from sdfc.syntax import tree
from sdfc.syntax.parse import parse

GRAPH = FieldGraph()


def field(text: str) -> Definition:
    (statement,) = parse(Source("test.sdf", "field " + text)).statements
    return define(the(tree.FieldDeclaration, statement), GRAPH)


def value(expr: Expr) -> tuple[float, ...]:
    assert expr.is_constant, expr
    return expr.numbers


def at(definition: Definition, p: tuple[float, ...], **arguments: object) -> float:
    """The formula's value at a point; a child is the distance to the origin less one."""
    environment = {k: tuple(map(constant, v)) if isinstance(v, list) else constant(v) for k, v in arguments.items()}
    children = {c.name: lambda q: GRAPH.length(q) - 1.0 for c in definition.children}
    (result,) = value(definition.formula(GRAPH.constant(*p), environment, children))  # type: ignore[arg-type]
    return result


def constant(value: object) -> Expr:
    return GRAPH.constant(*value) if isinstance(value, tuple) else GRAPH.constant(value)  # type: ignore[arg-type]


def test_parameters() -> None:
    made = field("f(a: length > 0 <= 2 = 0.5, b: point2 >= -1, c: angle < 90deg = 30deg, n: numbers, e: solid) = a")
    a, b, c, d, e = made.parameters
    assert (a.name, a.kind, a.minimum, a.above, a.maximum, a.below) == ("a", Kind.LENGTH, 0.0, True, 2.0, False)
    assert (b.kind, b.minimum, b.above, b.maximum) == (Kind.POINT2, -1.0, False, None)
    assert c.maximum == pytest.approx(1.5707963267948966) and c.below and c.default is not None
    assert (d.kind, e.kind) == (Kind.NUMBERS, Kind.SOLID)
    assert [p.name for p in made.children] == ["e"] and not made.is_primitive
    assert a.default is not None and value(the(Expr, a.default({}))) == (0.5,)


def test_a_default_may_use_earlier_parameters_and_is_spread() -> None:
    made = field("f(a: length, b: point3 = 2 * a, c: points2 = [[0, a], [1, 1]]) = a")
    b, c = made.parameters[1].default, made.parameters[2].default
    assert b is not None and c is not None
    assert value(the(Expr, b({"a": constant(1.5)}))) == (3.0, 3.0, 3.0)
    corners = c({"a": constant(1.5)})
    assert isinstance(corners, tuple) and [value(e) for e in corners] == [(0.0, 1.5), (1.0, 1.0)]


def test_formulas() -> None:
    assert at(field("f(r: length) = length(p) - r"), (3, 4, 0), r=1) == 4
    assert at(field("f(r: length) in plane = length(p) - r"), (3, 4), r=1) == 4
    box = field("f(h: point3) = length(max(q, 0)) + min(max(q.x, q.y, q.z), 0) where q = abs(p) - h")
    assert at(box, (0, 0.5, 0), h=(1, 2, 3)) == -1
    assert at(box, (4, 0, 7), h=(1, 2, 3)) == 5
    assert at(field("f(s: solid, k: number) = s(p / k) * k - [1, 2].y"), (0, 6, 0), k=2) == 2
    assert at(field("f(s: profile) = max(s(p.xy), abs(p.z) - 2)"), (3, 4, 5)) == 4
    assert at(field("f(a: numbers) = sum(for x in a: x * p.x) + count(a) * 100 + a[1]"), (2, 0, 0), a=[1, 2, 3]) == 314
    points = field("f(a: points2) in plane = min(for i in 0..count(a): length(p - a[i]))")
    assert at(points, (1, 1), a=[(0, 1), (5, 5)]) == 1
    assert at(field("f(n: count) = product(for i in 1..n: i) + min(for i in 0..n: for j in 0..n: i - j)"),
              (0, 0, 0), n=4) == 6 - 3  # fmt: skip
    assert at(field("f() = if p.x > 0 and not (p.y > 0) or p.z == 1 then 1 else 2"), (1, 1, 0)) == 2
    assert at(field("f() = nonzero(p).x * 1e20 + nonzero(p.y)"), (0, 3, 0)) == 4


def test_bindings_may_come_in_any_order_and_are_shared() -> None:
    made = field("f(r: length) = b where b = a + r, a = length(p)")
    assert at(made, (0, 0, 2), r=1) == 3
    point = GRAPH.input("p")
    assert made.formula(point, {"r": GRAPH.input("r", Type.FLOAT)}, {}).args[0].value is None


def test_claims() -> None:
    made = field(
        "f(r: length) = length(p) - r exact outside convex homogeneous lipschitz 1 + k where k = r\n"
        "bounds -r - level..[r, r, r] gauge max(p.x, r) ray [[-1 - grow, 1], [2, o.x + d.y]] lowering r / 2 dual g\n"
        'requires r > 1 "r is large"'
    )
    claims, environment = made.claims, {"r": constant(3)}
    assert claims.exactness is Exactness.EXACT_OUTSIDE and claims.convex and claims.homogeneous
    assert claims.lipschitz is not None and value(claims.lipschitz(environment, {})) == (4,)
    assert claims.bounds is not None and claims.bounds_use_level
    low, high = claims.bounds(environment, {}, constant(0.5))
    assert (value(low), value(high)) == ((-3.5, -3.5, -3.5), (3, 3, 3))
    assert claims.gauge is not None and value(claims.gauge(constant((7.0, 0.0, 0.0)), environment)) == (7,)
    assert claims.ray is not None
    first, second = claims.ray(constant((1.0, 0.0, 0.0)), constant((0.0, 4.0, 0.0)), constant(1), environment)
    assert [value(e) for e in (*first, *second)] == [(-2,), (1,), (2,), (5,)]
    assert not claims.ray_is_dear
    assert field("f(dear: length) = length(p) - dear dear ray [-dear, dear] where k = dear exact").claims.ray_is_dear
    assert claims.lowering is not None and value(claims.lowering(environment)) == (1.5,)
    assert claims.dual == "g"
    ((condition, message),) = made.requirements
    assert message == "r is large" and value(condition(environment)) == (1,)


def test_the_lipschitz_constant_that_goes_without_saying() -> None:
    facts: Mapping[str, ChildFacts] = {
        "a": ChildFacts(constant(0), constant(0), constant(2)),
        "b": ChildFacts(constant(0), constant(0), constant(3)),
    }
    exact = field("f(r: length) = length(p) - r exact").claims.lipschitz
    assert exact is not None and value(exact({}, {})) == (1,)
    assert field("f(r: length) = length(p) - r").claims.lipschitz is None
    both = field("f(a: solid, b: solid) = min(a(p), b(p)) bound").claims.lipschitz
    assert both is not None and value(both({}, facts)) == (3,)
    assert field("f(a: solid) = a(p) + sin(p.x * 9)").claims.lipschitz is None


def test_bounds_of_an_operation_use_its_childs() -> None:
    claim = field("f(shape: solid) = shape(p) bounds shape.lo - shape.lipschitz..shape.hi").claims.bounds
    assert claim is not None
    facts = {"shape": ChildFacts(constant((1.0, 2.0, 3.0)), constant((4.0, 5.0, 6.0)), constant(0.5))}
    low, high = claim({}, facts, constant(0))
    assert (value(low), value(high)) == ((0.5, 1.5, 2.5), (4, 5, 6))


def test_a_users_field_uses_functions_constants_and_params_of_its_file() -> None:
    made = scene("def k = 0.5\nparam w = 1 in 0..2\ndef wave(x, y = 1) = a * k where a = sin(x) + y\n"
                 "field f(r: length) = length(p) - r + wave(p.x) * w\nscene { f(r: 1) }")  # fmt: skip
    definition = the(Apply, made.root).definition
    graph = made.values
    result = definition.formula(graph.constant(0.0, 3.0, 0.0), {"r": graph.constant(1.0)}, {})
    assert substitute(result, {graph.param("w"): graph.constant(2.0)}).number == 3 - 1 + 0.5 * 2
    assert not made.warnings


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f(r: length) = r + q", "unknown name 'q' in this formula"),
        ("f(r: length) = r.w", "a number has no '.w'"),
        ("f(r: length) = r | r", "'|' is an operator of shapes, not of numbers"),
        ("f(r: length) = sum(for i in 0..r: i)", "the ends of a loop must be known when the scene is compiled"),
        ("f(r: length) = p < 1", "'<' compares two numbers, not a vector of 3 and a number"),
        ("f(r: length) = dot(p, p.xy)", "dot takes a vector of 2 or a vector of 3 or a vector of 4, "
         "not a vector of 3 and a vector of 2"),
        ("f(r: length) = a where a = b, b = a", "'a' is defined by itself"),
        ("f(r: length) = r == true", "'==' compares two numbers, not a number and a boolean"),
        ("f(r: length) = if r then 1 else 2", "expected a condition, not a number"),
        ('f(r: length) = "text"', "a string has no place in a formula"),
        ("f(r: length) = #fff.x", "a colour has no place in a formula"),
        ("f(r: length) = r.round(1)", "a formula has no '.round(…)'"),
        ("f(s: solid) = s(p, p)", "s takes one point, as in s(p)"),
        ("f(s: solid) = s.lo.x", "a shape has no '.lo' here"),
        ("f(s: solid) = r lipschitz s(p)", "unknown name 'r' in this formula"),
        ("f(r: length = true) = r", "expected a number, not a boolean"),
        ("f(r: length) = r bounds r", "bounds are two corners, low..high"),
        ("f(r: length) = r ray 3", "a ray's interval is [enter, exit], or a list of those"),
        ("f(r: length == 2) = r", "'==' is no limit"),
        ("f(s: solid = 2) = 1", "a shape has no limits and no default"),
        ("f(r: length) = r lipschitz 1 lipschitz 2", "'lipschitz' is claimed twice"),
        ("f(r: length) = r exact bound", "a field is either exact or a bound"),
        ("f(d: length) = d", "a parameter cannot be called 'd'"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_field_is_told_even_where_nothing_uses_it(text: str, message: str) -> None:
    assert message in messages(f"field {text}\nscene {{ sphere(1) }}")


def test_standard_fields_are_parsed_only_when_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    from sdfc.scene import library

    asked: list[str] = []
    parsed = library.declaration.__wrapped__

    def counted(name: str) -> tree.FieldDeclaration:
        asked.append(name)
        return parsed(name)

    monkeypatch.setattr(library, "declaration", counted)
    graph = FieldGraph()
    standard_library = Library(graph)
    sphere = standard_library.definition("sphere")
    assert sphere is not None and sphere is standard_library.definition("sphere")
    assert sphere.is_standard and sphere.name == "sphere"
    assert standard_library.definition("no such field") is None
    assert asked == ["sphere"]
    assert len(standard_names()) >= 55 and list(standard_names()) == sorted(standard_names())
    assert standard("box", graph).dimension == 3


def test_a_place_in_the_library_is_that_of_its_file() -> None:
    definition = standard("sphere", FieldGraph())
    span = definition.span
    assert span.source.name.startswith("std/")
    assert span.source.text[span.start : span.end].startswith("field sphere(")
