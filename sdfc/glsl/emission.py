"""GLSL for other programs than our own: complete shaders and parts of shaders, for every target of the table."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from sdfc.field.graph import FieldGraph
from sdfc.glsl.assembly import Assembly, environment
from sdfc.glsl.expression import literal, type_name
from sdfc.glsl.functions import GlslFunction, Role
from sdfc.glsl.live import Live
from sdfc.glsl.manual import description, header
from sdfc.glsl.names import Names, param_name
from sdfc.glsl.nearest import NearestWriter
from sdfc.glsl.source import Item, Kind, globals_of, joined, parse, pruned, renamed
from sdfc.glsl.surface import PROPERTIES
from sdfc.glsl.targets import TARGETS
from sdfc.glsl.targets.record import Brief, Control, Eye, Numbers, Part, Target, Vector
from sdfc.plan.plan import Plan
from sdfc.plan.setting import Setting
from sdfc.plan.view import uniform_name

_ENTRY: Mapping[Part, str] = {"field": "field", "tracer": "tracer", "full": "picture"}
_FIELD = ("sdf", "gradient", "material", "properties")
PUBLIC: Mapping[Part, tuple[str, ...]] = {
    "field": _FIELD,
    "tracer": (*_FIELD, "trace_ray", "trace_pixel"),
    "full": ("main", "mainImage"),
}
_ENTRY_POINTS = frozenset(PUBLIC["full"])
# globals of the part templates: kept from users' names, and what they are called behind the prefix
_OWN = {word: word for word in (*_FIELD, "trace_pixel", "nearest", "Nearest", "Properties")}
_OWN |= {"trace_ray": "trace", "trace": "first", "Found": "hit"}
_OWN |= {"nearer_of": "nearer_of", "farther_of": "farther_of", "painted_as": "painted_as", "blended_of": "blended_of"}
_MARGIN = 1e-3  # by which a box that is drawn is wider than the scene, of its radius


@dataclass(frozen=True, slots=True)
class Order:
    """What is asked for. `prefix` is a GLSL identifier without its last underscore."""

    target: str
    part: Part
    stage: str
    prefix: str
    is_prefixed: bool  # whether a complete shader's names get the prefix although its target needs none
    is_baked: bool  # whether params are constants
    params: Mapping[str, Numbers]  # every param's value: the default of its uniform, or the constant


@dataclass(frozen=True, slots=True)
class About:
    """What is known of the scene besides its plan."""

    low: Vector
    high: Vector
    is_finite: bool
    has_box: bool
    eye: Eye
    uniforms: Mapping[str, Numbers]  # the camera's, at 1280 x 720
    other: Callable[[str, str], str]  # the same order for another target and stage


def emit(graph: FieldGraph, plan: Plan, setting: Setting, order: Order, about: About) -> str:
    """One file. The order must be legal: its target gives the part and has the stage."""
    return _Emission(graph, plan, setting, order, about).file()


class _Emission(Assembly):
    def __init__(self, graph: FieldGraph, plan: Plan, setting: Setting, order: Order, about: About) -> None:
        self._order = order
        self._about = about
        self._target: Target = TARGETS[order.target]
        # what a complete file of the target is made around
        self._part: Part = self._target.full_part if order.part == "full" else order.part
        super().__init__(graph, plan, setting, _ENTRY[self._part])
        if self._part != "full":
            self._live = Live(hoists=False)

    def file(self) -> str:
        items = parse(environment().get_template(self._template()).render(self._whole_context()))
        controls = self._controls(items)
        items = self._baked(items, controls)
        items = pruned(items, PUBLIC[self._part])
        items = self._precise(items)
        read = [c for c in controls if any(c.uniform in item.words for item in items)]
        brief = self._brief(read)
        items = self._target.lower(items, brief)
        names = self._new_names(items)
        brief = replace(brief, controls=[replace(c, uniform=names.get(c.uniform, c.uniform)) for c in read])
        return self._paged(renamed(items, names), brief)

    # the text

    def _template(self) -> str:
        return f"target/part/{self._part}.glsl" if self._part != "full" else self._target.full[self._order.stage]

    def _whole_context(self) -> dict[str, object]:
        context = self._context() | self._camera(self._order.stage) | self._places()
        context |= {"version": self._target.version, "header": [], "camera_template": self._target.camera}
        context["pixel_centre"] = self._target.pixel.get(self._order.stage, "gl_FragCoord.xy")
        if self._target.start:
            context["first_start"] = self._target.start
        if self._part == "full":
            return context
        # a scene that needs no origin and unit of its own is written as its author did
        is_whole = self._plan.radius == 1.0 and not any(self._plan.centre)
        own_p = "p" if is_whole else "(p - CENTRE) / RADIUS"
        context |= {"part": self._part, "is_whole": is_whole and self._part == "field", "own_p": own_p}
        slopes = self._plan.slopes
        nearest = NearestWriter(self._graph, self._functions, self._live, self._plan.materials, slopes)
        context["nearest"] = nearest.written(self._plan.root)
        surface = context["surface"]
        context["surface_values"] = _values(getattr(surface, "properties", {}))
        context["functions"] = "\n".join([_described(f).text for f in self._functions.all])
        return context

    def _places(self) -> dict[str, object]:
        """The box and the eye in the scene's own coordinates."""
        about, radius, centre = self._about, self._plan.radius, self._plan.centre

        def own(place: Vector, outward: float = 0.0) -> str:
            return _vector([(a - c) / radius + outward for a, c in zip(place, centre, strict=True)])

        eye = about.eye
        return {
            "box_low": own(about.low, -_MARGIN),
            "box_high": own(about.high, _MARGIN),
            "eye": own(eye.eye),
            "target": own(eye.target),
            "vertical": _vector(_unit(eye.up)),
            "half_view": literal(eye.half / radius if eye.is_parallel else eye.half),
            "parallel": eye.is_parallel,
            "box_size": _listed([b - a + 2 * _MARGIN * radius for a, b in zip(about.low, about.high, strict=True)]),
            "box_centre": _listed([0.5 * (a + b) for a, b in zip(about.low, about.high, strict=True)]),
        }

    def _precise(self, items: list[Item]) -> list[Item]:
        if not self._target.precision:
            return items
        types = ["float", "int", *(["image2D"] if any(i.type == "image2D" for i in items) else [])]
        text = "\n".join(f"precision highp {type_};" for type_ in types)
        first = sum(item.text.startswith("#version") for item in items)
        return [*items[:first], Item(Kind.DIRECTIVE, (), "", text), *items[first:]]

    # params

    def _controls(self, items: Sequence[Item]) -> list[Control]:
        """The params whose uniforms the text declares."""
        declared = {name for item in items if item.kind is Kind.UNIFORM for name in item.names}
        made = []
        for p in self._setting.params:
            uniform = uniform_name(p) if self._part == "full" else param_name(p.name)
            value = self._order.params[p.name]
            if uniform in declared:
                made.append(Control(p.name, uniform, type_name(p.type), p.unit, value, p.low, p.high))
        return made

    def _baked(self, items: list[Item], controls: Sequence[Control]) -> list[Item]:
        """The params' uniforms as constants, where that is wanted."""
        if not (self._order.is_baked or self._target.is_baked):
            return items
        by_name = {c.uniform: c for c in controls}

        def made(item: Item) -> Item:
            if item.kind is not Kind.UNIFORM or item.names[0] not in by_name:
                return item
            control = by_name[item.names[0]]
            numbers = ", ".join(literal(n) for n in control.default)
            value = numbers if control.type == "float" else f"{control.type}({numbers})"
            text = f"const {control.type} {control.uniform} = {value};"
            return replace(item, kind=Kind.CONSTANT, text=text)

        return [made(item) for item in items]

    # names

    def _new_names(self, items: Sequence[Item]) -> dict[str, str]:
        """Every global's new name; a complete shader keeps its names where nobody asked for a prefix."""
        if self._part == "full" and not (self._target.is_prefixed or self._order.is_prefixed):
            return {}
        stem = self._order.prefix
        words = frozenset(word for item in items for word in item.words)
        fresh = Names(words - set(globals_of(items)))
        names = [n for n in globals_of(items) if n not in _ENTRY_POINTS]
        public = set(PUBLIC[self._part])
        ordered = [*(n for n in names if n in public), *(n for n in names if n not in public)]
        return {name: fresh.fresh(f"{stem}_{self._short(name)}") for name in ordered}

    def _short(self, name: str) -> str:
        if self._part == "full":
            return name
        return _OWN.get(name, name.removeprefix("param_").replace(Role.DISTANCE_SURFACE.value, "_gradient"))

    # the file

    def _brief(self, controls: Sequence[Control]) -> Brief:
        plan, about, order = self._plan, self._about, self._order
        return Brief(
            title=self._setting.title,
            part=order.part,
            stage=order.stage,
            prefix=order.prefix,
            controls=controls,
            materials=[m.name for m in plan.materials],
            guarantee=plan.tracer.guarantee,
            tracer=plan.tracer.name,
            radius=plan.radius,
            centre=plan.centre,
            low=about.low,
            high=about.high,
            is_finite=about.is_finite,
            has_box=about.has_box,
            up=self._setting.up,
            eye=about.eye,
            is_baked=order.is_baked or self._target.is_baked,
            uniforms=about.uniforms,
            other=about.other,
        )

    def _sources(self) -> dict[str, dict[str, str]]:
        """The texts for a description of the scene, of every stage."""
        told = {name: row for name, row in TARGETS.items() if row.is_told}
        return {name: {s: self._about.other(name, s) for s in self._stages(row)} for name, row in told.items()}

    def _stages(self, row: Target) -> tuple[str, ...]:
        return row.stages if self._order.part == "full" else row.stages[:1]

    def _paged(self, items: Sequence[Item], brief: Brief) -> str:
        version = [item.text for item in items if item.text.startswith("#version")]
        text = joined([item for item in items if not item.text.startswith("#version")])
        lines = header(brief, self._target)
        page = self._target.page.get(brief.part)
        if page is not None:
            context = {"text": text, "header": lines, "brief": brief, "controls": brief.controls} | self._places()
            context |= {"radius": literal(self._plan.radius), "centre": _vector(self._plan.centre)}
            context["description"] = description(brief, self._sources()) if self._target.is_description else {}
            return environment().get_template(page).render(context)
        return "\n".join([*version, *(f"// {line}".rstrip() for line in lines), "", text])


def _described(function: GlslFunction) -> GlslFunction:
    """What a formula is, is said where it is; here only what else there is of it."""
    is_gradient = function.name.endswith(Role.DISTANCE_SURFACE.value)
    return replace(function, doc="Its gradient, and its value.") if is_gradient else function


def _values(properties: Mapping[str, str]) -> str:
    return ", ".join(properties[name] for name in PROPERTIES if name in properties)


def _vector(numbers: Sequence[float]) -> str:
    return f"vec3({', '.join(literal(n) for n in numbers)})"


def _listed(numbers: Sequence[float]) -> str:
    return ", ".join(literal(n) for n in numbers)


def _unit(v: Vector) -> Vector:
    size = sum(x * x for x in v) ** 0.5
    return v[0] / size, v[1] / size, v[2] / size
