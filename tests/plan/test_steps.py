"""What the plan says of its parts is so: boxes hold, constants hold, nothing is lost."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shape_trees import (
    RANGES,
    SOLIDS,
    SPAN,
    USER_SOLIDS,
    Array,
    Menu,
    World,
    checked,
    points_around,
    seeds,
    solids,
    some_params,
)

from sdfc.diagnostics import SceneError, Source
from sdfc.facts.box import Box
from sdfc.field.graph import Type
from sdfc.field.numeric import Evaluator
from sdfc.pipeline import Compiled, Options, compile_scene, load
from sdfc.plan.steps import (
    All,
    Any,
    Ball,
    Blend,
    BlendNode,
    Chord,
    Closed,
    Falling,
    Many,
    Part,
    Step,
    Tangent,
    Within,
    leaves_of,
)
from sdfc.scene.model import Param, Scene
from sdfc.shape.graph import Shape
from sdfc.shape.lower import lower, lower_gauge


def compiled(text: str, tracer: str = "proven") -> Compiled:
    return compile_scene(load(Source("s.sdf", text)), Options(tracer))


def scene_of(world: World, root: Shape) -> Scene:
    params = [
        Param(name, Type(len(lo)), tuple((a + b) / 2 for a, b in zip(lo, hi, strict=True)), min(lo), max(hi), "", SPAN)
        for name, (lo, hi) in RANGES.items()
    ]
    return Scene(SPAN.source, world.values, world.shapes, root, tuple(params))


def steps_below(step: Step) -> Iterator[Step]:
    stack = [step]
    while stack:
        node = stack.pop()
        yield node
        match node:
            case Any() | All():
                stack.extend(node.steps)
            case Within():
                stack.append(node.step)
            case _:
                pass


def value_of(part: Part, points: Array, params: dict[str, object]) -> Array:
    """The part's formula in the scene's own coordinates."""
    p = part.stretch.graph.input("p")
    root = lower(part.shape, part.inverse.apply(p) if part.inverse else p) * part.stretch
    return np.broadcast_to(Evaluator([root])({"p": points}, params)[0], points.shape[1:])  # type: ignore[arg-type]


def held(box: Box, points: Array) -> Array:
    low, high = np.array(box.lo)[:, None], np.array(box.hi)[:, None]
    inside: Array = ((points >= low - 1e-9) & (points <= high + 1e-9)).all(axis=0)
    return inside


def check_part(step: Closed | Tangent | Chord | Ball | Blend, params: dict[str, object], seed: int) -> None:
    points = points_around(np.random.default_rng(seed), 800, 3, 1.2)
    part = step.part
    value = value_of(part, points, params)
    assert held(part.box, points[:, value <= 0]).all(), part.name
    match step:
        case Tangent() | Chord():
            p = part.stretch.graph.input("p")
            root = lower_gauge(part.shape, part.inverse.apply(p) if part.inverse else p)
            gauge = np.broadcast_to(Evaluator([root])({"p": points}, params)[0], points.shape[1:])  # type: ignore[arg-type]
            assert ((gauge <= 0) == (value <= 0))[np.abs(value) > 1e-7].all(), part.name
        case Ball() | Blend():
            assert step.lipschitz > 0
        case Closed():
            assert step.intervals > 0


@checked
@given(data=st.data(), seed=seeds)
def test_parts_of_random_scenes(data: st.DataObject, seed: int) -> None:
    world = World()
    root = data.draw(solids(world, Menu(solids=SOLIDS | USER_SOLIDS, materials=True)))
    try:
        made = compile_scene(scene_of(world, root))
    except SceneError as error:
        assert "no bound of the slope" in str(error) or "solid everywhere" in str(error)
        return
    params = some_params(np.random.default_rng(seed))
    for leaf in leaves_of(made.plan.root):
        check_part(leaf, params, seed)


@checked
@given(data=st.data(), seed=seeds)
def test_slopes_hold_in_the_parts_boxes(data: st.DataObject, seed: int) -> None:
    world = World()
    made = compile_scene(scene_of(world, data.draw(solids(world, Menu(nothing=False, sets=("union", "difference"))))))
    generator = np.random.default_rng(seed)
    params = some_params(generator)
    for leaf in leaves_of(made.plan.root):
        slope = made.plan.slopes[id(leaf.part)]
        a = points_around(generator, 500, 3, 1.2)
        b = a + 10.0 ** generator.uniform(-5, 0, a.shape[1]) * generator.normal(size=a.shape)
        change = np.abs(value_of(leaf.part, a, params) - value_of(leaf.part, b, params))
        assert (change <= slope * np.linalg.norm(a - b, axis=0) * (1 + 1e-9) + 1e-9).all(), leaf.part.name


@checked
@given(data=st.data(), seed=seeds)
def test_the_boxes_that_steps_are_kept_in_hold_the_solid(data: st.DataObject, seed: int) -> None:
    """A union of operations: each is looked at in its box only."""
    world = World()
    parts = [data.draw(solids(world, Menu(nothing=False, sets=("intersection",)), 2)) for _ in range(2)]
    made = compile_scene(scene_of(world, world.shapes.union(parts, SPAN)))
    points = points_around(np.random.default_rng(seed), 800, 3, 1.2)
    params = some_params(np.random.default_rng(seed))
    top = made.plan.root.steps if isinstance(made.plan.root, Any) else (made.plan.root,)
    for step in top:
        match step:
            case Within(step=Ball() | Blend() as inner):
                inside = value_of(inner.part, points, params) <= 0
                assert held(step.box, points[:, inside]).all()
            case _:
                pass


def test_a_ball_in_a_complement() -> None:
    made = compiled("scene { box([3, 3, 3]) - torus().twist(1rad).translate([0.2, 0, 0]) }")
    (ball,) = [step for step in steps_below(made.plan.root) if isinstance(step, Ball)]
    assert not ball.inside and ball.lipschitz == 1.0


def test_an_unclaimed_field_in_a_complement_is_kept_in_the_box_of_what_it_cuts() -> None:
    made = compiled(
        """field wobble() = dot(p, p) - 0.3 + 0.1 * sin(8 * p.x) bounds [-1, -1, -1] .. [1, 1, 1]
        scene { box([1, 1, 1]) - wobble() }"""
    )
    (within,) = [step for step in steps_below(made.plan.root) if isinstance(step, Within)]
    assert isinstance(within.step, Ball) and not within.step.inside and within.is_needed
    assert within.box.is_finite and made.plan.slopes


def test_an_unclaimed_field_in_a_blend_is_stepped_by_what_is_known_of_all_of_the_blend() -> None:
    """Its values say nothing of how near it is: the blend is not taken to be there where they are small."""
    made = compiled(
        """field quadric() = dot(p, p) - 0.25 bounds [-0.5, -0.5, -0.5] .. [0.5, 0.5, 0.5]
        scene { union(quadric(), box([4, 0.2, 0.2]), blend: 0.2) }"""
    )
    (ball,) = [step for step in steps_below(made.plan.root) if isinstance(step, Ball)]
    # the box ends at x = 2, where the gradient of dot(p, p) is 4 long
    assert ball.lipschitz >= 4.0 and (ball.ahead or ball.bend is not None)


def test_an_operand_that_is_no_convex_function_falls_by_its_constant_in_a_blend() -> None:
    made = compiled("scene { union(torus(), box([4, 0.2, 0.2]), blend: 0.2) }")
    (blend,) = [step for step in steps_below(made.plan.root) if isinstance(step, Blend)]
    assert isinstance(blend.tree, BlendNode) and isinstance(blend.tree.first, Falling)
    assert blend.lipschitz == 1.0 and blend.tree.first.lipschitz == 1.0


def test_a_flat_field_that_is_cut_is_not_looked_for_deeper_by_its_steepest_slope() -> None:
    flat = "field flat() = dot(p, p) * dot(p, p) - 0.01 bounds -[1, 1, 1] .. [1, 1, 1]"
    (alone,) = leaves_of(compiled(f"{flat} scene {{ flat() }}").plan.root)
    cut = compiled(f"{flat} scene {{ flat() - box([1, 1, 1]).translate([0.6, 0.6, 0.6]) }}")
    (part,) = [leaf for leaf in leaves_of(cut.plan.root) if isinstance(leaf, Ball)]
    assert isinstance(alone, Ball) and alone.bend is not None
    assert part.bend is None and part.ahead


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("scene { union { } }", 0),
        ("scene { sphere(1) & sphere(1).translate([9, 0, 0]) }", 0),
        ("scene { union { }.round(0.1) }", 0),
        ("scene { sphere(1) sphere(1) }", 1),
        ("scene { sphere(1) - sphere(1).translate([9, 0, 0]) }", 1),
    ],
)
def test_how_many_parts_there_are(text: str, count: int) -> None:
    made = compiled(text)
    assert len(leaves_of(made.plan.root)) == count
    assert "void main()" in made.glsl("probe")


def test_a_scene_that_is_solid_everywhere_is_an_error() -> None:
    with pytest.raises(SceneError, match="solid everywhere"):
        compiled("scene { ~union { } }")


# --- tables


def grid(count: int, word: str = "sphere(0.3)") -> str:
    return "\n".join(f"{word}.translate([{i % 11}, {i // 11 % 11}, {i // 121}])" for i in range(count))


@pytest.mark.parametrize("count", [47, 48, 300])
def test_like_parts_are_gathered_once_each(count: int) -> None:
    boxes = grid(60, "box([0.2, 0.3, 0.4])").replace("translate([", "translate([0.5 + ")
    root = compiled(f"scene {{ {grid(count)} {boxes} torus() }}").plan.root
    assert isinstance(root, Any)
    tables = [step for step in root.steps if isinstance(step, Many)]
    assert [t.name for t in tables] == (["sphere", "box"] if count >= 48 else ["box"])
    parts = [leaf.part for leaf in leaves_of(root)]
    assert len(parts) == len({id(p) for p in parts}) == count + 61
    for table in tables:
        assert all(m.part.shape.definition.name == table.name and m.inside for m in table.members)


def test_planes_are_not_gathered() -> None:
    """They have no boxes."""
    planes = "\n".join(f"plane(offset: -{i}.0)" for i in range(60))
    made = compiled(f"scene {{ {planes} }}")
    assert not any(isinstance(step, Many) for step in steps_below(made.plan.root))
    assert "nan" not in made.glsl("probe")


@pytest.mark.parametrize("count", [1, 16, 17, 100, 1000])
def test_clusters_hold_every_member_once(count: int) -> None:
    from sdfc.plan.cluster import CLUSTER, clustered

    root = compiled(f"scene {{ {grid(max(count, 48))} }}").plan.root
    members = leaves_of(root)[:count]
    groups = clustered([m for m in members if isinstance(m, Closed)])
    assert sorted(id(m) for g in groups for m in g) == sorted(map(id, members))
    assert all(0 < len(g) <= CLUSTER for g in groups) and len(groups) == -(-count // CLUSTER)


def test_clusters_of_parts_in_one_place() -> None:
    from sdfc.plan.cluster import clustered

    root = compiled("scene { " + " ".join(f"sphere({1 + i / 100})" for i in range(100)) + " }").plan.root
    groups = clustered([m for m in leaves_of(root) if isinstance(m, Closed)])
    assert sum(map(len, groups)) == 100


# --- large scenes


def nest(step: str, depth: int) -> str:
    text = "sphere(0.5)"
    for i in range(depth):
        text = step.replace("IT", text).replace("N", str(i))
    return f"scene {{ {text} }}"


@pytest.mark.parametrize("stretch", [".scale([0.4, 1.5, 1])", ".shear(xy: 0.5)", ".scale(2)", ""])
def test_a_stretched_blend_that_is_a_union_after_all(stretch: str) -> None:
    """Its transform stopped at the blend; what it blends is out of each other's reach."""
    parts = "sphere(0.3) box([0.2, 0.2, 0.2]).rotate(y: 30deg).translate([2, 0, 0])"
    made = compiled(f"scene {{ union(blend: 0.02) {{ {parts} }}{stretch} plane(normal: [0, 1, 0], offset: -0.9) }}")
    assert len(leaves_of(made.plan.root)) == 3 and all(isinstance(leaf, Closed) for leaf in leaves_of(made.plan.root))


@pytest.mark.parametrize(
    "text",
    [
        "scene { " + grid(3000) + " }",
        nest("(IT - sphere(0.1).translate([0, 0.01 * N, 0])).translate([0.001, 0, 0])", 1000),
        nest("IT.round(0.0001)", 300),  # each is bounded at the levels of all that are around it
        nest("union(IT, sphere(0.1).translate([0, 0.01 * N, 0]), blend: 0.01)", 300),
        nest("(IT | box([0.1, 0.1, 0.1])).scale([1.001, 1, 1])", 300),
        nest("~IT", 1000),
    ],
    ids=["union", "differences", "rounds", "blends", "stretches", "complements"],
)
def test_large_scenes_are_compiled_without_recursion_errors(text: str) -> None:
    made = compile_scene(load(Source("large.sdf", text)))
    assert "void main()" in made.glsl("probe")


@pytest.mark.parametrize(
    ("more", "names"),
    [
        ("", ("red", "blue")),
        ("sphere(radius: 0.3).translate([0, 1, 0])", ("red", "blue", "unpainted")),
        ("rectangle(size: [1, 1]).extrude(height: 1)", ("red", "blue", "unpainted")),
        ("rectangle(size: [1, 1]).extrude(height: 1).material(red)", ("red", "blue")),
    ],
)
def test_the_unpainted_material_is_there_where_a_part_is_unpainted(more: str, names: tuple[str, ...]) -> None:
    parts = f"sphere(radius: 0.5).material(red)\nbox(size: [1, 1, 1]).rotate(y: 20deg).material(blue)\n{more}"
    materials = "material red { color: #ff0000 }\nmaterial blue { color: #0000ff }\n"
    assert set(compiled(f"{materials}scene {{ union(blend: 0.3) {{ {parts} }} }}").materials) == set(names)
