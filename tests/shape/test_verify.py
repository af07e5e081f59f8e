"""The shape graph's verifier and printer: every pass over every scene of the repository keeps what must hold."""

from __future__ import annotations

from pathlib import Path

import pytest

from sdfc.api.source import from_path, from_text
from sdfc.diagnostics import InternalError, Source, Span
from sdfc.field.graph import FieldGraph, Type
from sdfc.field.show import inline
from sdfc.field.show import show as show_field
from sdfc.pipeline import PASSES, load, normalise
from sdfc.scene.library import Library
from sdfc.shape.graph import ShapeGraph
from sdfc.shape.show import show
from sdfc.shape.verify import verify

LARGE = ("city.sdf", "temple.sdf", "spheres.sdf")  # seconds each, and nothing in them that the others lack
SCENES = [p for p in sorted((Path(__file__).parents[2] / "scenes").glob("*.*")) if p.suffix in (".sdf", ".csg")]
SPAN = Span(Source("t.sdf", "scene"), 0, 5)


@pytest.mark.parametrize("path", [p for p in SCENES if p.name not in LARGE], ids=lambda path: path.name)
def test_every_pass_keeps_the_graph_whole(path: Path) -> None:
    given = from_path(path)
    scene = load(given.source, given.folder, given.kind)
    verify(scene.root)
    for step in PASSES:
        root, _ = normalise(scene, step.name)
        verify(root)
        assert show(root).count("\n") < 100_000


def test_a_wrong_argument_is_found() -> None:
    values, shapes = FieldGraph(), ShapeGraph()
    sphere = Library(values).definition("sphere")
    assert sphere is not None
    verify(shapes.apply(sphere, [values.constant(0.5)], [], SPAN))
    wrong = {
        "has 3 components, not 1": [values.constant(1.0, 1.0, 1.0)],
        "depends on where it is evaluated": [values.input("p", Type.FLOAT)],
        "has the wrong number of arguments": [],
        "radius is a length": [(values.constant(0.5),)],
    }
    for message, arguments in wrong.items():
        with pytest.raises(InternalError, match=message):
            verify(shapes.apply(sphere, arguments, [], SPAN))


def test_a_profile_is_no_solid() -> None:
    values, shapes = FieldGraph(), ShapeGraph()
    library = Library(values)
    circle, sphere = library.definition("circle"), library.definition("sphere")
    assert circle is not None and sphere is not None
    flat = shapes.apply(circle, [values.constant(0.5)], [], SPAN)
    ball = shapes.apply(sphere, [values.constant(0.5)], [], SPAN)
    with pytest.raises(InternalError, match="the root has 2 dimensions, not 3"):
        verify(flat)
    with pytest.raises(InternalError, match="a child of 2 dimensions in a node of 3"):
        verify(shapes.union([ball, flat], SPAN))


def test_shapes_are_shown_one_node_a_line_each_once() -> None:
    scene = load(from_text("def ball() = sphere(0.5)\nscene { ball() ball().translate([1, 2, 3]) }").source)
    assert [line.split("  //")[0] for line in show(scene.root).splitlines()] == [
        "%1 = sphere(radius: 0.5)",
        "%2 = affine(%1, linear: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], offset: [1, 2, 3])",
        "%3 = union(%1, %2)",
    ]


def test_fields_are_shown() -> None:
    graph = FieldGraph()
    p = graph.input("p")
    root = graph.length(p) - 0.5
    lines = show_field([root]).splitlines()
    assert lines[0].endswith(" float = length(p)")
    assert lines[1].split(" = ")[1] == f"({lines[0].split()[0]} - 0.5)"
    assert inline(root) == "length(p) - 0.5"
    deep = p
    for _ in range(20_000):
        deep = graph.max(deep * 1.5, p + 1.0)
    assert len(inline(deep)) < 400
