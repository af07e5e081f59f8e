"""Text to syntax tree: shapes of the tree, places of its nodes, and how deep and long a text may be."""

from dataclasses import fields, is_dataclass
from typing import Any

import pytest
from language_corpus import cases
from language_scenes import the

from sdfc.diagnostics import Source, Span
from sdfc.syntax import tree
from sdfc.syntax.parse import parse
from sdfc.syntax.walk import mentions

SCENE = """import "parts.sdf"
param width = 0.5 in 0..1  // live
material gold { color: #fc0, metallic: 1 roughness: 0.1 }
camera { eye: [1, 2, 3], fov: 35deg }
light sun { direction: [-1, -2, -1] }
sky { zenith: #6f9fd8 }
def ball(r, shift = [0, 0, 0]) = sphere(r * k).translate(shift) where k = 2
def k = 1
/* a field
   of its own */
field wave(height: length > 0 <= 1 = 0.5, turns: count) "Waves." in plane
    = p.y - height * sin(p.x * turns) where a = 1, b = a
    exact outside convex lipschitz 1 + height where c = 2
    bounds -[1, 1]..[1, 1] requires height < 2 "too high"
scene {
    (box(size: [1, 1, width]) | ball(1, shift: [1, 0, 0]) & ~ball(2)) - union(for i in 0..3: ball(i + 1))
    union(blend: if width > 0.2 then 0.1 else 0.2) { box() ball(0.5) }.rotate(y: -30deg).material(gold)
    not_a_call
    (box())
}
"""


def expression(text: str) -> tree.Expression:
    (statement,) = parse(Source("test", f"def x = {text}")).statements
    return the(tree.FunctionDeclaration, statement).body


def nodes(root: object) -> list[Any]:
    found: list[Any] = []
    pending: list[object] = [root]
    while pending:
        node = pending.pop()
        if isinstance(node, tuple):
            pending.extend(node)
        elif is_dataclass(node) and not isinstance(node, Span | Source | type):
            found.append(node)
            pending.extend(getattr(node, f.name) for f in fields(node))
    return found


def test_every_node_knows_its_place() -> None:
    source = Source("test", SCENE)
    found = nodes(parse(source).statements)
    assert len(found) > 150
    for node in found:
        span = node.value.span if isinstance(node, tree.Operand) else node.span
        assert span.source is source
        assert 0 <= span.start < span.end <= len(SCENE)
        text = SCENE[span.start : span.end]
        assert text == text.strip()
        if isinstance(node, tree.Identifier | tree.Name):
            assert text == node.text


def test_a_node_is_within_its_parent() -> None:
    for node in nodes(parse(Source("test", SCENE)).statements):
        if isinstance(node, tree.Operand):
            continue
        for part in nodes(tuple(getattr(node, f.name) for f in fields(node))):
            if not isinstance(part, tree.Operand):
                assert node.span.start <= part.span.start <= part.span.end <= node.span.end


def test_positions_count_lines_and_columns_from_one() -> None:
    statement = parse(Source("a.sdf", "\n\n  def x = 1")).statements[0]
    assert str(statement.span) == "a.sdf:3:3"


@pytest.mark.parametrize(
    ("text", "grouped"),
    [
        ("a | b & c", "(a | (b & c))"),
        ("a & b - c", "(a & (b - c))"),
        ("a - b - c", "(a - b - c)"),
        ("a + b * c / d - e", "(a + (b * c / d) - e)"),
        ("-a * b", "((- a) * b)"),
        ("~a.b - c", "((~ a.b) - c)"),
        ("a or b and not c < d", "(a or (b and (not (c < d))))"),
        ("a | b < c", "((a | b) < c)"),
        ("if a then b else c + d", "if a then b else (c + d)"),
        ("a + 1 .. b", "(a + 1)..b"),
        ("a.b[c].d", "a.b[].d"),
    ],
)
def test_precedence(text: str, grouped: str) -> None:
    assert written(expression(text)) == grouped


def written(node: tree.Expression) -> str:
    match node:
        case tree.Name(text=text):
            return text
        case tree.Number(value=value):
            return f"{value:g}"
        case tree.Unary():
            return f"({node.operator} {written(node.operand)})"
        case tree.Operation():
            return f"({written(node.first)}{''.join(f' {o.operator} {written(o.value)}' for o in node.rest)})"
        case tree.Conditional():
            return f"if {written(node.condition)} then {written(node.then)} else {written(node.otherwise)}"
        case tree.Range():
            return f"{written(node.low)}..{written(node.high)}"
        case tree.Chain():
            links = [f".{link.name.text}" if not isinstance(link, tree.Index) else "[]" for link in node.links]
            return written(node.base) + "".join(links)
    raise AssertionError(node)


@pytest.mark.parametrize(
    ("text", "value", "unit"),
    [("3", 3, ""), ("0.5", 0.5, ""), (".5", 0.5, ""), ("2.", 2, ""), ("1e-3", 1e-3, ""), ("30deg", 30, "deg")],
)
def test_numbers(text: str, value: float, unit: str) -> None:
    number = the(tree.Number, expression(text))
    assert (number.value, number.unit) == (value, unit)


def test_a_range_of_numbers_is_not_two_fractions() -> None:
    assert written(expression("0..3")) == "0..3"
    assert written(expression("0.5..1.5")) == "0.5..1.5"


def test_a_name_on_one_line_is_not_called_by_the_next() -> None:
    (statement,) = parse(Source("test", "scene {\n    part\n    (box() | part)\n}")).statements
    first, second = the(tree.SceneDeclaration, statement).block.elements
    assert isinstance(first, tree.Name) and isinstance(second, tree.Operation)


def test_words_of_the_language_are_names_elsewhere() -> None:
    text = "def f(bounds, ray) = bounds.gauge + ray.exact\nscene { box().material(light: 1).scene() }"
    assert len(parse(Source("test", text)).statements) == 2


def test_a_long_chain_of_operators_is_one_node() -> None:
    node = the(tree.Operation, expression(" | ".join(["a"] * 20_000)))
    assert len(node.rest) == 19_999


def test_mentions_are_found_without_recursion() -> None:
    node = expression("(" * 3 + "f(x, [for i in list: g(i)]).h(y.z)" + ")" * 3)
    found = mentions(node)
    assert found.used == {"f", "x", "list", "g", "i", "h", "y"}
    assert found.bound == {"i"}


def test_the_cases_of_syntax_errors_are_many() -> None:
    assert len(cases("syntax_errors.txt")) > 40
