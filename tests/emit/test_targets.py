"""Every target compiles where a compiler is to be had; what is refused, is refused with a reason."""

from __future__ import annotations

import json
import re
from pathlib import Path

import moderngl
import pytest
from emitting import (
    HEADS,
    IS_FULL,
    PARTS,
    ROOT,
    SCENES,
    TEXTUAL,
    assert_valid,
    cases,
    prefix_of,
    program,
    quoted,
    shaders,
)

from sdfc.api.program import compile as compile_scene
from sdfc.api.request import RequestError
from sdfc.glsl.source import Kind, globals_of, joined, parse, pruned
from sdfc.glsl.targets import TARGETS

CASES = [(scene, target, part) for scene, target in cases() for part in PARTS if part not in TARGETS[target].refused]
COMPILED = [c for c in CASES if c[1] in TEXTUAL or c[1] == "raster"]
DESKTOP = ("glsl450", "glsl430", "glsl330", "raster")
BALL = "param size = 0.5 in 0.1..0.9\nscene { sphere(radius: size) }"


@pytest.mark.parametrize(("scene", "target", "part"), COMPILED)
def test_it_compiles(scene: str, target: str, part: str, tmp_path: Path) -> None:
    texts = shaders(scene, target, part)
    assert_valid(texts, target, tmp_path)


@pytest.mark.gpu
@pytest.mark.parametrize(("scene", "target", "part"), [c for c in COMPILED if c[1] in DESKTOP])
def test_the_driver_takes_it(scene: str, target: str, part: str, gl: moderngl.Context) -> None:
    texts = {name.rpartition(".")[2]: text for name, text in shaders(scene, target, part).items()}
    vertex = texts.get("vert", "#version 330 core\nvoid main() { gl_Position = vec4(0.0, 0.0, 0.0, 1.0); }")
    gl.program(vertex_shader=vertex, fragment_shader=texts["frag"]).release()
    if "comp" in texts:
        gl.compute_shader(texts["comp"]).release()


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("part", PARTS)
def test_a_file_is_the_same_every_time_and_tells_what_it_needs(target: str, part: str) -> None:
    if part in TARGETS[target].refused:
        with pytest.raises(RequestError, match=f"target '{target}' has no part '{part}'"):
            program("blobs.sdf").glsl(target, part=part)
        return
    first = program("blobs.sdf").glsl(target, part=part)
    assert first == compile_scene(ROOT / "scenes" / "blobs.sdf").glsl(target, part=part)
    assert "0.55" in first  # the default of `blend`
    assert "-3.025" in first  # the bounds


def test_parts_give_nothing_to_the_shader_but_prefixed_names() -> None:
    for part in ("field", "tracer"):
        items = parse(program("die.sdf").glsl("glsl330", part=part))
        assert all(name.startswith("die_") for name in globals_of(items))
        assert not any("main" in item.names for item in items)


def test_only_what_is_used_is_written() -> None:
    for target in ("glsl450", "essl300"):
        items = parse(program("csg5.sdf").glsl(target))
        assert joined(pruned(items, ["main"])) == joined(items)
    items = parse(program("csg5.sdf").glsl("glsl450", part="field"))
    public = ["csg5_sdf", "csg5_gradient", "csg5_material", "csg5_properties"]
    assert len(pruned(items, public)) == len(items)


@pytest.mark.parametrize("scene", SCENES)
def test_fields_name_nothing_that_is_shorter_in_its_place(scene: str) -> None:
    text = program(scene).glsl(part="field")
    for function in re.split(r"(?<=\n)}\n", text):
        assert not re.search(r"\b([ds]\d+) = .*\n    return \1;\n$", function), "what is made last is returned"
        for name, point in re.findall(r"\n    vec3 (q_\w+_\d+) = (.*);\n", function):
            (use, *more) = [line for line in function.splitlines() if re.search(rf"[( ]{name}[,)]", line)]
            assert more or use.count(name) > 1 or len(use) - len(name) + len(point) > 112


def test_the_field_of_csg5_is_about_as_long_as_by_hand() -> None:
    """A careful person writes 99 lines of 3861 bytes with the same promises."""
    text = program("csg5.sdf").glsl(part="field")
    assert text.count("\n") <= 104
    assert len(text) <= 4300
    assert "csg5_cylinder_gradient(p.yxz, 0.5, 3.0).yxzw" in text


@pytest.mark.parametrize("part", ["field", "tracer"])
def test_what_a_param_decides_is_computed_once_in_a_function(part: str) -> None:
    """However many pips the dice have: no function takes the cosine of one angle twice."""
    for item in parse(program("die.sdf").glsl(part=part)):
        asked = re.findall(r"\b(?:cos|sin)\([^()]*spin[^()]*\)", item.text)
        assert len(asked) == len(set(asked)), item.names


@pytest.mark.parametrize("scene", ["csg5.sdf", "die.sdf"])
def test_every_material_is_listed_once_where_nothing_blends(scene: str) -> None:
    text = program(scene).glsl(part="field")
    made = re.findall(rf"return {prefix_of(scene)}_Properties\(.*", text)
    assert len(made) == len(set(made)) == len(program(scene).compiled().materials)
    assert "color" not in text.partition(f"struct {prefix_of(scene)}_Nearest")[2].partition("}")[0]


def test_baked_params_are_constants() -> None:
    ball = compile_scene(BALL)
    live, baked = ball.glsl(part="field", prefix="b"), ball.glsl(part="field", prefix="b", bake=True)
    assert "uniform float b_size;" in live
    assert "uniform" not in baked
    assert "const float b_size = 0.5;" in baked
    assert "const float b_size = 0.25;" in ball.glsl(part="field", prefix="b", bake=True, params={"size": 0.25})
    assert "const float set_size = 0.5;" in ball.glsl("shadertoy")
    with pytest.raises(RequestError, match="outside its range"):
        ball.glsl(bake=True, params={"size": 3.0})
    with pytest.raises(RequestError, match="--set needs --bake"):
        ball.glsl(params={"size": 0.3})


@pytest.mark.parametrize(
    ("asked", "why"),
    [
        ({"target": "glsl120"}, "there is no target 'glsl120'"),
        ({"target": "essl300", "stage": "compute"}, r"target 'essl300' has no compute stage \(it has: fragment\)"),
        ({"part": "half"}, "there is no part 'half'"),
        ({"target": "raster", "part": "field"}, "target 'raster' has no part 'field': it is a pair of stages"),
        ({"prefix": "a__b"}, "'a__b' cannot begin names in GLSL"),
        ({"prefix": "gl_x"}, "'gl_x' cannot begin names in GLSL"),
    ],
)
def test_what_cannot_be_had_is_refused(asked: dict[str, str], why: str) -> None:
    with pytest.raises(RequestError, match=why):
        compile_scene(BALL).glsl(**asked)


def test_json_tells_all() -> None:
    told = json.loads(program("die.sdf").glsl("json"))
    assert {p["param"] for p in told["params"]} == {"rounding", "spin"}
    assert told["params"][0]["low"] == 0.0
    assert told["lipschitz"] == 1.0
    assert told["bounds"]["holds_everything"] is False
    for stages in told["sources"].values():
        for text in stages.values():
            assert all(re.search(rf"uniform float {p['uniform']};", text) for p in told["params"])
    part = json.loads(program("die.sdf").glsl("json", part="tracer"))
    assert "die_trace(" in part["functions"]["trace"]
    assert all("die_sdf(vec3 p)" in text for stages in part["sources"].values() for text in stages.values())


def test_vulkan_binds_explicitly() -> None:
    items = parse(program("die.sdf").glsl("vulkan", "compute"))
    uniforms = [item for item in items if item.kind is Kind.UNIFORM]
    assert all("binding = " in item.text for item in uniforms)
    assert len(uniforms) == 2


class TestGodot:
    """Its compiler is not to be had here: what of its rules can be read off the text."""

    @pytest.mark.parametrize("scene", SCENES if IS_FULL else ["csg5.sdf", "die.sdf", "blobs.sdf", "heart.sdf"])
    def test_structure(self, scene: str) -> None:
        text = program(scene).glsl("godot")
        assert text.startswith("shader_type spatial;\nrender_mode ")
        body = re.sub(r"^(shader_type|render_mode) .*$", "", text, flags=re.MULTILINE)
        body = re.sub(r"^#(?!version).*$", "", body, flags=re.MULTILINE)
        items = parse(body)
        kinds = {item.kind for item in items}
        assert Kind.VARIABLE not in kinds, "Godot has no globals that change"
        assert kinds <= {Kind.STRUCT, Kind.CONSTANT, Kind.UNIFORM, Kind.FUNCTION}
        assert items[-1].names == ("fragment",)
        assert not re.search(r"\b(gl_\w+|layout|precision|0x)\b", body)
        for uniform in (i for i in items if i.kind is Kind.UNIFORM):
            line = uniform.text.rpartition("\n")[2]
            assert re.fullmatch(r"uniform \w+ \w+( : hint_range\([^)]*\))? = .*;", line)
        assert "DEPTH = " in text and "ALBEDO = " in text

    def test_as_glsl_with_names_for_what_godot_gives(self, tmp_path: Path) -> None:
        """The include file is, but for the hints of uniforms, GLSL that a compiler can read."""
        for scene in ("csg5.sdf", "die.sdf", "blobs.sdf", "gyroid.sdf"):
            text = program(scene).glsl("godot", part="tracer")
            text = re.sub(r"^(uniform \w+ \w+)[^;]*;", r"\1;", text, flags=re.MULTILINE)
            p = scene.partition(".")[0]
            call = f"{p}_State s = {p}_start_state(); {p}_trace(s, vec3(9.0), vec3(-1.0), 0.0, 99.0).t"
            state, _, call = call.partition("; ")
            main = f"out vec4 c;\nvoid main() {{ {state}; c = vec4({call}); }}\n"
            if "start_state" not in text:
                main = f"out vec4 c;\nvoid main() {{ c = vec4({call.replace('(s, ', '(')}); }}\n"
            assert_valid({f"{p}.frag": f"#version 330 core\n{text}{main}"}, "glsl330", tmp_path)


@pytest.mark.parametrize("part", ["field", "tracer"])
@pytest.mark.parametrize(
    "target", [name for name, row in TARGETS.items() if not row.is_description and not row.refused]
)
def test_two_scenes_are_pasted_into_one_shader(target: str, part: str, tmp_path: Path) -> None:
    """As a stranger does it: what the command prints, one after the other; once even the same scene, twice."""
    texts = [
        program("column.sdf").glsl(target, part=part, prefix="a"),
        program("blobs.sdf").glsl(target, part=part, prefix="b"),
        program("column.sdf").glsl(target, part=part, prefix="a_2"),
    ]
    if target == "three":
        texts = [quoted(text, "glsl") for text in texts]
    if target == "godot":  # its own words for uniforms, and nobody to compile them
        texts = [re.sub(r"^(uniform \w+ \w+)[^;]*;", r"\1;", text, flags=re.MULTILINE) for text in texts]
    names = [set(globals_of(parse(text))) for text in texts]
    assert not names[0] & names[1] and not names[0] & names[2]
    calls = [
        f"{x}_sdf(vec3(0.1)) + {x}_gradient(vec3(0.2)).x + {x}_properties(vec3(0.3)).ior" for x in ("a", "b", "a_2")
    ]
    if part == "tracer" and target != "godot":
        calls += [f"{x}_trace(vec3(9.0), vec3(-1.0), 0.0, 99.0).t" for x in ("a", "b", "a_2")]
    main = f"layout(location = 0) out vec4 color;\nvoid main() {{ color = vec4({' + '.join(calls)}); }}\n"
    # in Vulkan every block of uniforms needs a place of its own, as the text says
    bound = "".join(f"#define {x}_BINDING {i}\n" for i, x in enumerate(("a", "b", "a_2"))) if target == "vulkan" else ""
    text = HEADS.get(target, HEADS["glsl330"]) + bound + "".join(texts) + main
    assert_valid({"both.frag": text}, target, tmp_path)


def test_a_material_may_be_computed_from_params(tmp_path: Path) -> None:
    """There is no main to begin with what takes statements."""
    wave = " + ".join(f"sin({k} * tone) * cos({k + 1} * tone)" for k in range(1, 9))
    text = "param tone = 0.3 in 0.0..1.0\nparam hue = #ff8000\nmaterial m { color: mix(hue, #0000ff, tone), "
    text += f"roughness: clamp({wave}, 0, 1) }}\nscene {{ sphere(radius: 1).material(m) }}"
    for part in ("field", "tracer"):
        made = compile_scene(text).glsl("glsl330", part=part, prefix="m")
        main = (
            "out vec4 c;\nvoid main() { c = vec4(m_properties(vec3(1.0)).color, m_properties(vec3(1.0)).roughness); }\n"
        )
        assert_valid({f"{part}.frag": f"#version 330 core\n{made}{main}"}, "glsl330", tmp_path)


@pytest.mark.parametrize("scene", ["", "plane()"])
def test_no_box_is_told_of_a_scene_without_one(scene: str) -> None:
    text = compile_scene(f"scene {{ {scene} }}").glsl(part="field", prefix="s")
    assert "// It is empty, or has no end: nothing in it has a size." in text
    assert "lies in" not in text and "lie in" not in text
