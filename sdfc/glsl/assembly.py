"""Whole shaders: Python decides, templates print. The one Jinja environment."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache

from jinja2 import Environment, PackageLoader, StrictUndefined

from sdfc.field.graph import Expr, FieldGraph
from sdfc.glsl.body import Body
from sdfc.glsl.distance import DistanceWriter
from sdfc.glsl.expression import literal, print_function, type_name
from sdfc.glsl.functions import Functions
from sdfc.glsl.light import LightWriter
from sdfc.glsl.live import Done, Live
from sdfc.glsl.many import ManyWriter
from sdfc.glsl.names import param_name
from sdfc.glsl.proven import ProvenWriter, TraceText
from sdfc.glsl.source import Item, joined, parse, pruned
from sdfc.glsl.span import SpanWriter
from sdfc.glsl.surface import SurfaceWriter
from sdfc.glsl.templates import KeptTemplates
from sdfc.plan.plan import CUT, FINE, GROW, HORIZON, LIFT, MOST_LOOPS, SMALLEST_TOLERANCE, TILE, Plan
from sdfc.plan.setting import Setting
from sdfc.plan.steps import Step, is_finite
from sdfc.plan.view import uniform_name
from sdfc.scene.model import Param
from sdfc.shade.ambient import OCCLUSION_HEIGHTS
from sdfc.shade.functions import FUNCTIONS
from sdfc.shape.look import Looks
from sdfc.shape.lower import FAR, Lowering


@dataclass(frozen=True, slots=True)
class Variable:
    """A global of the shader."""

    type: str
    name: str
    uniform: str = ""
    note: str = ""


VERSION = "450 core"
WEB_VERSION = "300 es"
_ALONE = ("picture", "inspect")  # entries whose camera is in uniforms
_MARK = "\x1f"  # before and after the library in a text that is not finished
_BETWEEN_WORDS = {code: " " for code in range(128) if re.fullmatch(r"\W", chr(code))}
_COMMENT = re.compile(r"//[^\n]*")


@cache
def environment() -> Environment:
    """The one Jinja environment."""
    made = Environment(
        loader=PackageLoader("sdfc.templates", "."),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
        bytecode_cache=KeptTemplates(),
    )
    made.filters["in_template_literal"] = lambda text: re.sub(r"[\\`$]", r"\\\g<0>", text)  # of JavaScript
    return made


def assemble(graph: FieldGraph, plan: Plan, setting: Setting, entry: str, stage: str) -> str:
    """One complete shader. `entry` is picture, radiance, probe or depth; `stage` fragment, or compute for a picture."""
    return Assembly(graph, plan, setting, entry).text(stage)


def assemble_for_web(graph: FieldGraph, plan: Plan, setting: Setting, entry: str) -> str:
    """One complete fragment shader for WebGL 2. `entry`: picture, or inspect, whose `shown` chooses the view."""
    version, rest = Assembly(graph, plan, setting, entry).text("fragment", WEB_VERSION).split("\n", 1)
    return "\n".join([version, "precision highp float;", "precision highp int;", rest])


def calibration_shaders() -> dict[str, str]:
    """The small fragment shaders that a device's speed is measured with, by name."""
    names = ("frame", "formula", "table")
    return {name: environment().get_template(f"calibrate/{name}.frag").render() for name in names}


def vertex_shader() -> str:
    """The vertex stage of the radiance and probe shaders."""
    return environment().get_template("entry/camera.vert").render(version=VERSION)


class Assembly:
    """One shader of a scene; sdfc/glsl/emission makes others than the renderer's from the same."""

    def __init__(self, graph: FieldGraph, plan: Plan, setting: Setting, entry: str) -> None:
        self._graph = graph
        self._plan = plan
        self._setting = setting
        self._entry = entry
        self._live = Live()
        lowering = Lowering()
        looks = Looks(lowering, plan.materials, setting.unpainted)
        self._functions = Functions(graph, lowering, looks, (p.name for p in setting.params))
        self._lit = entry in ("picture", "radiance")
        self._is_cone = entry == "cone"
        self._has_surface = entry not in ("depth", "cone", "field")
        self._has_field = entry in ("field", "tracer")  # parts of shaders: sdfc/glsl/emission
        # a shader that stands alone has nobody to sweep for it
        self._prepass = plan.prepass and entry not in ("cone", *_ALONE)

    def text(self, stage: str, version: str = VERSION) -> str:
        suffix = {"fragment": "frag", "compute": "comp"}[stage]
        template = environment().get_template(f"entry/{self._entry}.{suffix}")
        context = self._context() | self._camera(stage)
        context |= {"mark": _MARK, "version": version}
        text = template.render(context)
        params = _read(self._params(), text)
        if len(params) < len(self._setting.params):
            text = template.render(context | {"params": params})
        text = "\n".join([line.rstrip() for line in _with_needed_library(text).split("\n")])
        while "\n\n\n" in text:
            text = text.replace("\n\n\n", "\n\n")
        return text

    def _context(self) -> dict[str, object]:
        plan, tracer = self._plan, self._plan.tracer
        trace = TraceText("", False, False)
        many = ManyWriter(self._graph, self._functions, self._live, plan.materials, plan.rows_at_once)
        if tracer.needs_steps and not self._is_cone:
            trace = ProvenWriter(self._graph, self._functions, self._live, many).write(plan.root)
        map_text, occluder, occluder_is_limited = self._maps(many)
        spans = SpanWriter(self._graph, self._functions, self._live, plan.slopes, many)
        span_text = spans.write(plan.root) if tracer.needs_span and not self._is_cone else ""
        recorded = many if tracer.needs_steps else None
        surfaces = SurfaceWriter(self._graph, self._functions, self._live, plan.materials, recorded)
        surface = surfaces.write(plan.root) if self._has_surface else None
        context: dict[str, object] = {
            "version": VERSION,
            "header": self._header(),
            "mark": "",
            "radius": literal(plan.radius),
            "centre": _vector(plan.centre),
            "params": self._params(),
            "far": literal(FAR),
            "grow": literal(GROW),
            "cut": literal(CUT),
            "smallest": literal(SMALLEST_TOLERANCE),
            "fine": literal(FINE),
            "finite": plan.is_finite,
            "horizon": literal(HORIZON),
            "lift": literal(LIFT),
            "most_steps": self._most_steps(),
            "needs_marching": trace.march or (tracer.needs_map and not self._is_cone) or bool(many.tables),
            "needs_map_library": "within" in map_text or "box_distance" in map_text,
            "map": map_text,
            "occluder": occluder,
            "occluder_is_limited": occluder_is_limited,
            "map_span": span_text,
            "tables": "\n".join(many.tables),
            "trace": trace,
            "tracer_template": "" if self._is_cone else tracer.template,
            "prepass": self._prepass,
            "tile": TILE,
            "sweep_is_finite": is_finite(plan.swept),
            "rebase_template": f"lib/rebase{'_near' if plan.near_eye else ''}.glsl",
            "first_start": "max(-travelled, cleared)" if self._prepass and not tracer.needs_steps else "-travelled",
            "parameter": {name: literal(value) for name, value in plan.choice.values.items()},
            "surface": surface,
        }
        if self._lit and surface is not None:
            context |= self._lighting(surface.properties)
        context["functions"] = "\n".join([f.text for f in self._functions.all])
        context["live"] = [Variable(type_name(e.type), n) for n, e in self._live.values]
        context["live_lines"] = self._live_lines()
        return context

    def _maps(self, many: ManyWriter) -> tuple[str, str, bool]:
        """The distances that are asked for, the name of the one that tells how open the sky is, and whether that takes
        a limit besides the point."""
        plan = self._plan
        texts: dict[str, str] = {}

        def write(root: Step, name: str, traced: bool) -> bool:
            writer = DistanceWriter(
                self._graph, self._functions, self._live, plan.slopes, many, traced, self._has_field
            )
            texts[name] = writer.write(root, name)
            return writer.is_limited

        if plan.tracer.needs_map or self._is_cone or self._has_field:
            write(plan.swept if self._is_cone else plan.root, "map", True)
        if not self._lit or plan.is_convex:
            return "".join(texts.values()), "", False
        is_limited = write(plan.root, "openness_map" if texts else "map", False)
        if texts.get("openness_map") == texts["map"].replace("float map(", "float openness_map("):
            del texts["openness_map"]
        return "\n".join(texts.values()), [*texts][-1], is_limited

    def _camera(self, stage: str) -> dict[str, object]:
        """A shader that stands alone reads its camera from uniforms; ours come with a vertex stage that is cheaper."""
        kind = "uniform" if self._entry in _ALONE else "tile" if self._is_cone else "varying"
        return {
            "camera_template": f"lib/camera_{kind}.glsl",
            "pixel_centre": "gl_FragCoord.xy" if stage == "fragment" else "vec2(gl_GlobalInvocationID.xy) + 0.5",
        }

    def _lighting(self, properties: dict[str, str]) -> dict[str, object]:
        writer = LightWriter(self._graph, self._live, self._plan.centre, self._plan.radius)
        lights, suns = writer.lights(self._setting.lights), writer.suns(self._setting.lights)
        transmission = properties["transmission"] not in ("0.0", "0")
        needed = {"sky_radiance": True, "sun_disc": bool(suns), "reflect_light": bool(lights)}
        needed |= {"point_falloff": len(suns) < len(lights), "occlusion_weight": not self._plan.is_convex}
        needed |= {"ambient": True, "transmit": transmission}
        needed |= dict.fromkeys(("tone_map", "encode_srgb"), self._entry == "picture")
        functions = [_shading_function(name) for name, wanted in needed.items() if wanted]
        return {
            "shading_functions": "\n".join(functions),
            "up": _vector(self._setting.up),
            "sky": writer.sky(self._setting.sky),
            "lights": lights,
            "shadows": [] if self._plan.is_convex else lights,
            "is_convex": self._plan.is_convex,
            "suns": suns,
            "occlusion_heights": f"vec4({', '.join(literal(h * self._setting.reach) for h in OCCLUSION_HEIGHTS)})",
            "transmission": transmission,
        }

    def _most_steps(self) -> int:
        """So many marching steps a ray that all loops of an invocation stay below llvmpipe's silent limit."""
        rays = 1 + (len(self._setting.lights) if self._lit and not self._plan.is_convex else 0)
        taps = 4 if self._lit else 0
        free = (MOST_LOOPS - (rays + taps) * self._plan.table_turns) // rays - 2 * self._plan.events
        return max(16, min(2048, free)) if self._plan.budget is None else min(self._plan.budget, max(16, free))

    def _header(self) -> list[str]:
        tracer = self._plan.tracer
        return [f"{self._setting.title}, made by sdfc", f"tracer: {tracer.name}. {tracer.doc}"]

    def _params(self) -> list[Variable]:
        return [
            Variable(
                type_name(p.type),
                param_name(p.name),
                uniform_name(p),
                f"{p.unit}, {_numbers(p.default)}{_range(p)}",
            )
            for p in self._setting.params
        ]

    def _live_lines(self) -> list[str]:
        lines: list[str] = []
        done: dict[Expr, str] = {}
        for name, expr in self._live.values:
            body = Body(Done(done), 0)
            text = body.text(expr)
            scoped = [*body.lines, f"{name} = {text};"]
            lines += scoped if len(scoped) == 1 else ["{", *(f"    {line}" for line in scoped), "}"]
            done[expr] = name
        return lines


def _with_needed_library(text: str) -> str:
    """The text with only that of the library, between the marks, which the rest asks for."""
    before, library, after = text.split(_MARK)
    asked_for = set(_COMMENT.sub("", before + after).translate(_BETWEEN_WORDS).split())
    return f"{before}{joined(pruned(_items(library), sorted(asked_for)))}{after}"


@cache
def _shading_function(name: str) -> str:
    """The same in every scene."""
    return print_function(FUNCTIONS[name](FieldGraph()), name)


@lru_cache(maxsize=64)
def _items(library: str) -> list[Item]:
    """The library of one shader: few scenes have one of their own."""
    return parse(library)


def _read(params: list[Variable], text: str) -> list[Variable]:
    """The params that a shader reads: those named there besides their declaration and the line that sets them."""
    # the word, by what is found fast: its letters, then what is around them
    return [p for p in params if len(re.findall(rf"{p.name}(?<!\w{p.name})(?!\w)", text)) > 2]


def _range(param: Param) -> str:
    bounded = param.low is not None and param.high is not None
    return f" in {param.low:g} .. {param.high:g}" if bounded else ""


def _vector(numbers: Sequence[float]) -> str:
    return f"vec3({', '.join(literal(n) for n in numbers)})"


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{v:g}" for v in values)
