"""Printed GLSL: how it reads, that it compiles, and that it means what the field graph means."""

from __future__ import annotations

import math
import os
import re
import shutil
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from random import Random

import numpy as np
import pytest
from field_trees import INPUTS, PARAM_VALUES, PARAMS, VECTORS, Recipe, node, points, protected, trees
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sdfc.diagnostics import InternalError
from sdfc.field.derivative import gradient
from sdfc.field.function import Function
from sdfc.field.graph import BINARY, COMPARISON, LEAVES, LOGIC, UNARY, Expr, FieldGraph, Op, Type, topological
from sdfc.field.numeric import Evaluator
from sdfc.glsl.composition import Text, leaf
from sdfc.glsl.expression import DEPTH, WIDTH, Printer, print_function
from sdfc.glsl.in_place import InPlace, NeedsLocalError
from sdfc.glsl.names import RESERVED, Names, identifier, literal, param_name, type_name

PARAMETERS = tuple(INPUTS.items())
NUMBERS = [0.0, 1.0, 0.1, -2.5, 1 / 3, 1e20, 1e-7, 3.4028234663852886e38, 1e-45, 123456789.0, 16777216.0, 100.0, 5e-324]


def function(root: Expr, name: str = "f", doc: str = "") -> Function:
    return Function(name, PARAMETERS, root, doc)


def body(root: Expr, **parameters: Type) -> list[str]:
    """The statements of a function that returns `root`."""
    text = print_function(Function("f", tuple(parameters.items()) or PARAMETERS, root))
    return [line.strip() for line in text.splitlines()[1:-1]]


# ---- numbers and names


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_a_literal_reads_back_as_the_same_float32(x: float) -> None:
    text = literal(x)
    assert re.fullmatch(r"-?\d+(\.\d+)?(e-?\d+)?", text)
    assert "." in text or "e" in text
    (read,) = struct.unpack("<f", struct.pack("<f", float(text)))
    assert read == x


def test_literals_are_short() -> None:
    assert [literal(x) for x in NUMBERS] == [
        *("0.0", "1.0", "0.1", "-2.5", "0.33333334", "1e20", "1e-7", "3.4028235e38", "1e-45", "123456790.0"),
        *("16777216.0", "100.0", "0.0"),
    ]


@pytest.mark.parametrize("x", [math.nan, math.inf, -math.inf, 1e39])
def test_what_is_no_float32_is_refused(x: float) -> None:
    with pytest.raises(InternalError):
        literal(x)


@given(st.text(min_size=1, max_size=12) | st.sampled_from(sorted(RESERVED)) | st.from_regex(r"(gl_|_){0,4}\w*"))
def test_identifiers_are_legal(name: str) -> None:
    legal = identifier(name)
    assert re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", legal)
    assert "__" not in legal and not legal.startswith("gl_") and legal not in RESERVED
    assert identifier(legal) == legal


def test_names_are_given_out_once() -> None:
    names = Names({"q"})
    names.reserve("d")
    assert [names.fresh(n) for n in ("q", "q", "d", "half", "half", "q_2")] == [
        *("q_2", "q_3", "d_2", "half_", "half_2", "q_2_2"),
    ]


# ---- how it reads


def test_a_box_reads_as_people_write_it() -> None:
    graph = FieldGraph()
    p, half = graph.input("p"), graph.input("half")
    q = graph.abs(p) - half
    inside = graph.min(graph.max(q[0], graph.max(q[1], q[2])), 0.0)
    box = graph.length(graph.max(q, 0.0)) + inside - graph.param("rounding")
    assert print_function(Function("box", (("p", Type.VEC3), ("half", Type.VEC3)), box, "A box.\nIt is rounded.")) == (
        "// A box.\n"
        "// It is rounded.\n"
        "float box(vec3 p, vec3 half_) {\n"
        "    vec3 q = abs(p) - half_;\n"
        "    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0) - param_rounding;\n"
        "}\n"
    )


def idioms(graph: FieldGraph) -> list[tuple[Expr, str]]:
    p, t, u = graph.input("p"), graph.input("t", Type.FLOAT), graph.input("u", Type.VEC2)
    size = graph.param("size", Type.VEC3)
    x, y, z = (p[i] for i in range(3))
    call = graph.call
    return [
        (graph.clamp(t, 0.0, 1.0), "clamp(t, 0.0, 1.0)"),
        (graph.clamp(p, -size, size), "clamp(p, -param_size, param_size)"),
        (graph.min(graph.max(t, y), x), "min(max(t, p.y), p.x)"),
        (graph.min(graph.max(t, 1.0), 0.0), "min(max(t, 1.0), 0.0)"),
        (graph.vector(y, z, x), "p.yzx"),
        (graph.vector(x, y), "p.xy"),
        (graph.vector(x, y, 1.0, t), "vec4(p.xy, 1.0, t)"),
        (graph.vector(x, y, z, t), "vec4(p, t)"),
        (graph.vector(t, u[0], u[1]), "vec3(t, u)"),
        (graph.vector(*((2.0 * p)[i] for i in range(3)), t), "vec4(2.0 * p, t)"),
        (graph.vector(t + 1.0, t + 1.0, t + 1.0), "vec3(t + 1.0)"),
        (graph.constant(2.0, 2.0, 2.0) * p, "vec3(2.0) * p"),
        (call(Op.ROUND, t), "floor(t + 0.5)"),
        (call(Op.ATAN2, y, x), "atan(p.y, p.x)"),
        (call(Op.MOD, t, 2.0), "mod(t, 2.0)"),
        (call(Op.POW, t, 2.0), "t * t"),
        (call(Op.POW, t, 3.0) / y, "t * t * t / p.y"),
        (y / call(Op.POW, t, 3.0), "p.y / (t * t * t)"),
        (call(Op.POW, t, -2.0), "1.0 / (t * t)"),
        (call(Op.POW, t, 0.5), "pow(t, 0.5)"),
        (call(Op.POW, t, 101.0), "sign(t) * pow(abs(t), 101.0)"),
        (graph.select(x < y, t, 0.0), "p.x < p.y ? t : 0.0"),
        (graph.select(x < y, p, 0.0), "p.x < p.y ? p : vec3(0.0)"),
        (graph.select(x < 0.0, 1.0, 2.0) + t, "(p.x < 0.0 ? 1.0 : 2.0) + t"),
        (x - (y - z), "p.x - (p.y - p.z)"),
        (x - y - z, "p.x - p.y - p.z"),
        (x / (y * z), "p.x / (p.y * p.z)"),
        ((x + y) * z, "(p.x + p.y) * p.z"),
        (x - graph.constant(-1.5), "p.x + 1.5"),
        (x + graph.constant(-1.5), "p.x - 1.5"),
        (x * graph.constant(-1.5), "p.x * (-1.5)"),
        (graph.constant(-1.5) * x, "-1.5 * p.x"),
        (t - (-1.5 * x), "t - (-1.5 * p.x)"),
        (-(x * y), "-p.x * p.y"),
        (-(x + y), "-(p.x + p.y)"),
        (-(graph.constant(-2.0) * x), "-(-2.0 * p.x)"),
        (p + graph.constant(-1.0, 0.0, -2.0), "p - vec3(1.0, 0.0, 2.0)"),
        (graph.max(0.0, p), "max(p, 0.0)"),
        (call(Op.MOD, t, p), "mod(vec3(t), p)"),
        (call(Op.ATAN2, u, t), "atan(u, vec2(t))"),
        (call(Op.AND, x < y, call(Op.OR, y < z, call(Op.NOT, z <= x))), "p.x < p.y && (p.y < p.z || !(p.z <= p.x))"),
        (call(Op.EQUAL, x + y, z), "p.x + p.y == p.z"),
        (graph.abs(p).swizzle("xz"), "abs(p).xz"),
        (graph.swizzle(t, (0, 0, 0)), "vec3(t)"),
    ]


@pytest.mark.parametrize("index", range(len(idioms(FieldGraph()))))
def test_idioms(index: int) -> None:
    root, text = idioms(FieldGraph())[index]
    assert body(root) == [f"return {text};"]


def test_what_is_used_twice_becomes_a_local() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    distance = graph.length(p - 1.0)
    assert body(distance * distance + graph.call(Op.POW, distance + 1.0, 6.0)) == [
        "float len = length(p - 1.0);",
        "float sum = len + 1.0;",
        "float square_2 = sum * sum;",
        "float square_4 = square_2 * square_2;",
        "return len * len + square_2 * square_4;",
    ]


def test_components_of_one_vector_are_taken_of_a_local() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    turned = graph.abs(p) * 2.0
    assert body(turned[0] + turned[1]) == ["vec3 q = abs(p) * 2.0;", "return q.x + q.y;"]


def test_numbers_that_are_one_vector_are_one_local() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    a, b = graph.length(p.swizzle("xz")) - 0.5, graph.abs(p[1]) - 1.0
    norm = graph.length(graph.max(graph.vector(a, b), 0.0))
    assert body(graph.min(graph.max(a, b), 0.0) + norm) == [
        "vec2 q = vec2(length(p.xz) - 0.5, abs(p.y) - 1.0);",
        "return min(max(q.x, q.y), 0.0) + length(max(q, 0.0));",
    ]
    wave = graph.call(Op.SIN, a)  # needs the other
    assert body(graph.length(graph.vector(a, wave)) + a * wave) == [
        "float d = length(p.xz) - 0.5;",
        "float sine = sin(d);",
        "return length(vec2(d, sine)) + d * sine;",
    ]


def test_a_long_chain_updates_one_variable() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    distance = graph.length(p)
    for i in range(1, 5):
        other = graph.length(p - graph.constant(i, 0.0, 0.0)) - 0.5
        distance = graph.min(distance, other) if i % 2 else graph.max(distance, -other)
    assert body(distance) == [
        "float d = min(length(p), length(p - vec3(1.0, 0.0, 0.0)) - 0.5);",
        "d = max(d, -(length(p - vec3(2.0, 0.0, 0.0)) - 0.5));",
        "d = min(d, length(p - vec3(3.0, 0.0, 0.0)) - 0.5);",
        "d = max(d, -(length(p - vec3(4.0, 0.0, 0.0)) - 0.5));",
        "return d;",
    ]


def test_a_chain_does_not_overwrite_what_is_needed_again() -> None:
    graph = FieldGraph()
    t = graph.input("t", Type.FLOAT)
    chain = [t]
    for i in range(1, 10):
        chain.append(graph.min(chain[-1], graph.abs(t - i) + chain[0]))
    lines = body(chain[9] + chain[4])
    # the first four steps are read by two: they end in a name of their own
    assert [line.partition(" = ")[0] for line in lines[:-1]] == ["float d", "d", "d", "d", "float d_2", *["d_2"] * 4]
    assert lines[4].startswith("float d_2 = min(d, ")
    assert lines[-1] == "return d_2 + d;"


@pytest.mark.parametrize("to_the_right", [False, True])
@pytest.mark.parametrize(("op", "size"), [(Op.MIN, 20_000), (Op.ADD, 4000), (Op.ATAN2, 4000)])
def test_deep_graphs_are_cut_into_statements(op: Op, size: int, to_the_right: bool) -> None:
    graph = FieldGraph()
    t = graph.input("t", Type.FLOAT)
    root = t
    for i in range(size):
        other = t * (i + 0.5)
        root = graph.add(op, *((other, root) if to_the_right else (root, other)))
    lines = body(root)
    assert max(map(len, lines)) < WIDTH + 30
    assert max(line.count("(") for line in lines) <= 2 * DEPTH
    assert len(lines) >= size / (2 * DEPTH)


def test_a_parameter_gives_way_to_a_uniform_of_the_same_name() -> None:
    graph = FieldGraph()
    radius = graph.length(graph.input("p")) - graph.input("radius", Type.FLOAT) - graph.param("radius")
    text = print_function(Function("sphere", (("p", Type.VEC3), ("radius", Type.FLOAT)), radius))
    assert text.splitlines()[0] == "float sphere(vec3 p, float radius) {"
    assert "length(p) - radius - param_radius" in text
    text = print_function(Function("number", (("param_radius", Type.FLOAT),), graph.input("param_radius", Type.FLOAT)))
    assert text == "float number(float param_radius) {\n    return param_radius;\n}\n"
    both = graph.input("param_radius", Type.FLOAT) - graph.param("radius")
    text = print_function(Function("number", (("param_radius", Type.FLOAT),), both))
    assert text == "float number(float param_radius_2) {\n    return param_radius_2 - param_radius;\n}\n"


def test_the_printer_uses_what_has_a_name() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    distance = graph.length(p)
    roots = [graph.abs(distance - 0.5) + distance, graph.call(Op.SIN, distance), distance * 2.0]
    known = {distance: "march.d", roots[1]: "-wave(p, q)"}
    printer = Printer(known.get, Names({"sum", "size"}))
    assert printer.statements([*roots, -roots[1], roots[0] - p[0]]) == (
        ["float sum_2 = abs(march.d - 0.5) + march.d;"],
        ["sum_2", "-wave(p, q)", "march.d * 2.0", "-(-wave(p, q))", "sum_2 - p.x"],
    )
    lines, _ = printer.statements([graph.length(p * p) * graph.length(p * p)])
    assert lines == ["float len = length(p * p);"]


def test_a_doc_comment_cannot_swallow_the_function() -> None:
    text = print_function(function(FieldGraph().input("t", Type.FLOAT), doc="Ends in a backslash \\\n\nand more"))
    assert text.startswith("// Ends in a backslash \n//\n// and more\nfloat f(")


@settings(max_examples=40, deadline=None)
@given(trees())
def test_output_does_not_depend_on_what_else_the_graph_holds(recipe: Recipe) -> None:
    used = FieldGraph()
    for i in range(50):
        used.length(used.input("other") * (i + 0.25))
    assert print_function(function(recipe.build(used))) == print_function(function(recipe.build(FieldGraph())))


@settings(max_examples=200, deadline=None, derandomize=True)
@given(recipes=st.lists(st.sampled_from([Type.BOOL, Type.FLOAT, *VECTORS]).flatmap(lambda t: trees(t, 4)), max_size=3))
def test_what_is_written_in_place_is_what_a_block_writes(recipes: list[Recipe]) -> None:
    graph = FieldGraph()
    roots = [recipe.build(graph) for recipe in recipes]
    known = {graph.input("p"): "o", **{n: f"live_{n.id}" for n in topological(roots) if n.op is Op.SQRT}}
    for names in ({}, known):
        assert Printer(names.get).statements(roots) == Printer(names.get).block(roots)


def test_few_expressions_need_a_block() -> None:
    graph = FieldGraph()
    p, t = graph.input("p"), graph.input("t", Type.FLOAT)
    turned = graph.vector(p[0] * 0.5 - p[1], -p[1], 0.25)
    assert InPlace(leaf_of).texts([p - graph.constant(1.0, 2.0, 3.0), turned, graph.clamp(t, 0.0, 1.0), -p[2]]) == [
        *("p - vec3(1.0, 2.0, 3.0)", "vec3(p.x * 0.5 - p.y, -p.y, 0.25)", "clamp(t, 0.0, 1.0)", "-p.z")
    ]
    shared = graph.abs(p)
    for root in (shared * shared, graph.call(Op.POW, t + 1.0, 2.0), graph.length(turned + shared) + turned[0]):
        with pytest.raises(NeedsLocalError):
            InPlace(leaf_of).texts([root])


def leaf_of(node: Expr) -> Text | None:
    return None if node.args else leaf(node)


def test_printing_needs_no_numpy() -> None:
    code = "import sys, sdfc.glsl.expression; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


# ---- that it compiles


def shader(functions: list[Function], version: str) -> str:
    precision = "precision highp float;\n" if version.endswith("es") else ""
    uniforms = "".join(f"uniform {type_name(t)} {param_name(name)};\n" for name, t in PARAMS.items())
    texts = "\n".join(print_function(f) for f in functions)
    return (
        f"#version {version}\n{precision}{uniforms}\n{texts}\nout vec4 colour;\nvoid main() {{ colour = vec4(1.0); }}\n"
    )


# not skipped where the drivers are asked for: there its absence fails
needs_validator = pytest.mark.skipif(
    shutil.which("glslangValidator") is None and not os.environ.get("SDFC_REQUIRE_GL"),
    reason="glslangValidator is not installed",
)


@needs_validator
@settings(max_examples=6, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(recipes=st.lists(st.sampled_from([Type.BOOL, Type.FLOAT, *VECTORS]).flatmap(trees), min_size=8, max_size=20))
@pytest.mark.parametrize("version", ["330", "450", "300 es"])
def test_random_functions_compile(version: str, recipes: list[Recipe], tmp_path: Path) -> None:
    graph = FieldGraph()
    roots = [recipe.build(graph) for recipe in recipes]
    roots += [gradient(root, graph.input("p")) for root in roots if root.type is Type.FLOAT]
    path = tmp_path / "functions.frag"
    path.write_text(shader([function(root, f"f{i}") for i, root in enumerate(roots)], version))
    done = subprocess.run(["glslangValidator", str(path)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + path.read_text()


@needs_validator
@pytest.mark.parametrize("version", ["330", "460", "320 es"])
def test_reserved_words_as_parameters_compile(version: str, tmp_path: Path) -> None:
    graph = FieldGraph()
    total = graph.constant(0.0)
    for name in sorted(RESERVED):
        total = total + graph.length(graph.input(name))
    path = tmp_path / "reserved.frag"
    path.write_text(shader([Function("main", tuple((n, Type.VEC3) for n in sorted(RESERVED)), total)], version))
    done = subprocess.run(["glslangValidator", str(path)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


# ---- that it means the same

RunFunction = Callable[..., np.ndarray]


def assert_same_on_gpu(run_function: RunFunction, root: Expr, tolerance: float) -> None:
    """The GPU's float32 against float64, at points where shaking the inputs shows that rounding decides nothing."""
    inputs = points(200)
    (expected,) = Evaluator([root])(inputs, PARAM_VALUES)
    shape = (200,) if root.type.value <= 1 else (root.type.size, 200)
    expected = np.broadcast_to(expected, shape).astype(float)
    doubt = np.zeros(shape)
    for shift in (2e-6, -2e-6, 7e-7):
        shaken = {name: values * (1.0 + shift) + shift for name, values in inputs.items()}
        doubt = np.maximum(doubt, np.abs(Evaluator([root])(shaken, PARAM_VALUES)[0] - expected))
    (rounded,) = Evaluator([root], np.float32)(inputs, PARAM_VALUES)
    doubt = np.maximum(doubt, np.abs(rounded.astype(float) - expected))
    made = run_function(function(root), inputs, PARAM_VALUES)
    close = np.abs(made - expected) <= tolerance * (1.0 + np.abs(expected)) + 20.0 * doubt
    assert np.mean(close) > 0.98, (print_function(function(root)), made[..., :5], expected[..., :5])


def single_operations() -> list[Recipe]:
    leaves = {t: Recipe(Op.INPUT, value=name, type=t) for name, t in INPUTS.items()}
    other = node(Op.SWIZZLE, leaves[Type.VEC3], value=(1,))
    mixed = [(leaves[Type.FLOAT], other), (leaves[Type.VEC3], other), (other, leaves[Type.VEC4])]
    below = node(Op.LESS, leaves[Type.FLOAT], other)
    above = node(Op.LESS, other, node(Op.NEG, leaves[Type.FLOAT]))
    return [
        *(protected(op, leaf) for op in sorted(UNARY, key=lambda o: o.value) for leaf in leaves.values()),
        *(protected(op, *pair) for op in sorted(BINARY, key=lambda o: o.value) for pair in mixed),
        *(node(op, *mixed[0]) for op in sorted(COMPARISON, key=lambda o: o.value)),
        *(node(op, below, above) for op in (Op.AND, Op.OR)),
        node(Op.NOT, below),
        *(node(Op.SELECT, below, *pair) for pair in mixed),
        *(node(Op.DOT, leaves[t], node(Op.SIN, leaves[t])) for t in VECTORS),
        *(node(Op.LENGTH, leaves[t]) for t in VECTORS),
        node(Op.SWIZZLE, leaves[Type.VEC4], value=(3, 0)),
        node(Op.VECTOR, leaves[Type.FLOAT], other, other),
    ]


def test_the_single_operations_are_all_operations() -> None:
    assert {recipe.op for recipe in single_operations()} | LEAVES == set(Op)
    assert {recipe.op for recipe in single_operations()} > LOGIC


@pytest.mark.gpu
@pytest.mark.parametrize("op", sorted(set(Op) - LEAVES, key=lambda o: o.value), ids=lambda op: op.value)
def test_each_operation_on_the_gpu(run_function: RunFunction, op: Op) -> None:
    for recipe in single_operations():
        if recipe.op is op:
            # drivers may approximate arc sines to 2^-11 or so (GLSL leaves it open); llvmpipe does
            assert_same_on_gpu(run_function, recipe.build(FieldGraph()), 1e-3 if op in (Op.ASIN, Op.ACOS) else 2e-5)


@pytest.mark.gpu
@pytest.mark.parametrize("exponent", [-5, -2, -1, 2, 3, 4, 7, 16, 31])
def test_integer_powers_of_negative_numbers_on_the_gpu(run_function: RunFunction, exponent: int) -> None:
    graph = FieldGraph()
    p, t = graph.input("p"), graph.input("t", Type.FLOAT)
    exponents = graph.constant(*[float(exponent)] * 3)
    for root in (graph.call(Op.POW, t, float(exponent)), graph.call(Op.POW, p, exponents)):
        assert_same_on_gpu(run_function, root, 1e-5)


@pytest.mark.gpu
def test_a_large_power_of_a_negative_number_on_the_gpu(run_function: RunFunction) -> None:
    graph = FieldGraph()
    base = graph.call(Op.SIN, graph.input("t", Type.FLOAT))
    for exponent in (100.0, 101.0):
        assert_same_on_gpu(run_function, graph.call(Op.POW, base, exponent), 1e-4)


@pytest.mark.gpu
@settings(
    max_examples=120, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(recipe=st.sampled_from([Type.BOOL, Type.FLOAT, *VECTORS]).flatmap(trees))
def test_random_functions_on_the_gpu(run_function: RunFunction, recipe: Recipe) -> None:
    assert_same_on_gpu(run_function, recipe.build(FieldGraph()), 1e-3)


@pytest.mark.gpu
@settings(max_examples=20, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(recipe=trees(smooth=True, steps=12))
def test_gradients_on_the_gpu(run_function: RunFunction, recipe: Recipe) -> None:
    graph = FieldGraph()
    assert_same_on_gpu(run_function, gradient(recipe.build(graph), graph.input("p")), 1e-3)


@pytest.mark.gpu
@settings(max_examples=25, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32))
def test_order_and_brackets_on_the_gpu(run_function: RunFunction, seed: int) -> None:
    """Arithmetic only, on few leaves, so that every way of nesting + - * / and negation comes up."""
    graph = FieldGraph()
    p, t = graph.input("p"), graph.input("t", Type.FLOAT)
    random = Random(seed)
    terms = [p[0] + 5.0, p[1] - 7.0, t + 9.0, -p[2] - 4.0, graph.constant(-3.0)]
    for _ in range(16):
        a, b = random.sample(terms[-6:], 2)
        op = random.choice([Op.ADD, Op.SUB, Op.SUB, Op.MUL, Op.DIV, Op.NEG, Op.MIN, Op.MAX, Op.ABS])
        terms.append(graph.add(op, a) if op in (Op.NEG, Op.ABS) else graph.add(op, a, b))
    assert_same_on_gpu(run_function, graph.vector(*terms[-4:]), 1e-5)


@pytest.mark.gpu
def test_a_union_of_two_hundred_and_its_gradient_on_the_gpu(run_function: RunFunction) -> None:
    graph = FieldGraph()
    p = graph.input("p")
    random = np.random.default_rng(3)
    union = graph.length(p)
    for centre in random.uniform(-2.0, 2.0, (200, 3)):
        union = graph.min(union, graph.length(p - graph.constant(*centre)) - 0.1)
    assert_same_on_gpu(run_function, union, 1e-5)
    assert_same_on_gpu(run_function, gradient(union, p), 1e-4)
