"""The compiler as one list of named steps: text to Scene, Scene to normal form, normal form to plan, plan to GLSL."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from sdfc.diagnostics import InternalError, SceneError, Source, scene_error
from sdfc.facts.bounds import Bounds
from sdfc.facts.curvature import is_convex_solid
from sdfc.facts.lipschitz import Lipschitz
from sdfc.facts.ranges import Ranges
from sdfc.facts.rule import Rules
from sdfc.passes.bare import bare
from sdfc.passes.fence import fence
from sdfc.passes.flatten import flatten
from sdfc.passes.negate import negate
from sdfc.passes.own_origin import Frame, frame_of, is_plain, own_origin
from sdfc.passes.paint import paint
from sdfc.passes.place import place
from sdfc.passes.prune import prune
from sdfc.passes.recognise import recognise
from sdfc.plan.plan import Plan
from sdfc.plan.prove import Prover, Rays
from sdfc.plan.setting import Setting, setting_of
from sdfc.plan.view import CameraChange, pixel_at, target_of, uniform_name, uniforms_of
from sdfc.scene.library import Library
from sdfc.scene.literals import NO_LITERALS, Literals
from sdfc.scene.model import Scene
from sdfc.shape.graph import Shape
from sdfc.tracers import TRACERS, choice

Kind = Literal["sdf", "csg"]
MOST_PARAMS = 16  # live uniforms: more of them slow every frame on llvmpipe (GL.md 0)
_DEPTH = 400_000  # Python frames: chains of thousands of operations; pure Python calls need no C stack


@dataclass(frozen=True, slots=True)
class Options:
    """What may be asked of the compiler."""

    tracer: str = "proven"  # with values for its parameters, where wanted: `relaxed:omega=1.4`
    rays: Rays = "cheap"  # "all": closed-form ray intervals even where marching is cheaper on a CPU
    prepass: bool = False  # tiles of pixels are told first how far they are empty, where that is legal
    without: tuple[str, ...] = ()  # passes not to run: to see what they are worth
    field: bool = False  # every part must have a bound on its distance, whether the tracer needs it or not
    own_unit: bool = True  # else a scene that is near its origin, and of middling size, keeps the coordinates it has
    most_steps: int | None = None  # fewer passes of the loops than the compiler would allow: a measurer's budget


def tracer_names() -> tuple[str, ...]:
    """Every tracer there is."""
    return tuple(TRACERS)


@contextmanager
def deep_recursion() -> Iterator[None]:
    """Room for recursion over deep scenes."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(before, _DEPTH))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)


def load(source: Source, folder: Path | None = None, kind: Kind = "sdf", literals: Literals = NO_LITERALS) -> Scene:
    """Read a scene; `literals` are to be live. Raises SceneError with everything that is wrong with it."""
    with deep_recursion():
        if kind == "csg":
            from sdfc.openscad.load import load as load_csg

            return load_csg(source)
        from sdfc.scene.elaborate import elaborate

        scene = elaborate(source, folder, literals)
    for param in scene.params[MOST_PARAMS:]:
        message = f"a scene has at most {MOST_PARAMS} params: '{param.name}' is one too many"
        raise scene_error(message, param.span, "make one a constant with `def`")
    uniforms: dict[str, str] = {}
    for param in scene.params:
        other = uniforms.setdefault(uniform_name(param), param.name)
        if other != param.name:
            message = f"params '{other}' and '{param.name}' would be one in GLSL, which takes '__' for '_'"
            raise scene_error(message, param.span, "give one of them another name")
    return scene


@dataclass(frozen=True, slots=True)
class Pass:
    """A step of the compiler, with its reason."""

    name: str
    why: str
    run: Callable[[Shape, Workshop], Shape]


@dataclass(slots=True)
class Workshop:
    """What passes may ask for: the scene's graphs and facts."""

    scene: Scene
    bounds: Bounds
    ranges: Ranges
    library: Library
    own_unit: bool = True
    frame: Frame | None = None
    is_placed: bool = False  # whether every transform is as far down as it may go

    def placed(self, root: Shape) -> Shape:
        if self.is_placed:
            return root
        self.is_placed = True
        return place(root, self.scene.shapes, self.scene.values)

    def pruned(self, root: Shape) -> Shape:
        left = prune(root, self.scene.shapes, self.bounds)
        self.is_placed = self.is_placed and left is root
        return left

    def framed(self, root: Shape) -> Shape:
        self.frame = frame_of(root, self.bounds)
        if not self.own_unit and is_plain(self.frame):
            self.frame = replace(self.frame, centre=(0.0, 0.0, 0.0), radius=1.0)
            return root
        return own_origin(root, self.scene.shapes, self.scene.values, self.frame)


PASSES = (
    Pass(
        "recognise",
        "first: what it makes of profiles is flattened, painted and placed like all solids",
        lambda s, w: recognise(s, w.scene.shapes, w.scene.values, w.library.definition),
    ),
    Pass("flatten", "fewer nodes for every pass that follows", lambda s, w: flatten(s, w.scene.shapes)),
    Pass("paint", "while `a - b` still tells which part is cut", lambda s, w: paint(s, w.scene.shapes)),
    Pass("fence", "the scene's size is asked for next", lambda s, w: fence(s, w.scene.shapes, w.bounds)),
    Pass("own_origin", "before transforms are composed: one more to compose", lambda s, w: w.framed(s)),
    Pass("place", "leaves must be placed to be bounded", lambda s, w: w.placed(s)),
    Pass(
        "negate",
        "step rules know leaves and their complements",
        lambda s, w: negate(s, w.scene.shapes, w.library.definition),
    ),
    Pass("bare", "what stands under no operation is known now", lambda s, w: bare(s, w.scene.shapes, w.scene.values)),
    Pass("prune", "boxes are known now", lambda s, w: w.pruned(s)),
    Pass(
        "place again",
        "a stretched blend that turned out to be a union lets its transform through",
        lambda s, w: w.placed(s),
    ),
    Pass("flatten again", "De Morgan and pruning made new nests", lambda s, w: flatten(s, w.scene.shapes)),
)


def normalise(
    scene: Scene, after: str | None = None, without: tuple[str, ...] = (), own_unit: bool = True
) -> tuple[Shape, Workshop]:
    """The scene's shape after all passes, or after the one named; `without` some."""
    ranges = Ranges({p.name: _range_of(p.default, p.low, p.high) for p in scene.params})
    workshop = Workshop(scene, Bounds(scene.values, ranges), ranges, Library(scene.values), own_unit)
    root = scene.root
    with deep_recursion():
        for step in PASSES:
            root = root if step.name in without else step.run(root, workshop)
            if step.name == after:
                break
    return root, workshop


def _range_of(
    default: tuple[float, ...], low: float | None, high: float | None
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    if low is None or high is None:
        return default, default
    return (low,) * len(default), (high,) * len(default)


@dataclass(frozen=True, slots=True, eq=False)
class Compiled:
    """A scene, ready to be printed or rendered."""

    scene: Scene
    plan: Plan
    setting: Setting
    shape: Shape  # in normal form, in the scene's own coordinates
    frame: Frame
    _texts: dict[tuple[str, str, bool], str] = field(default_factory=dict, repr=False)

    @property
    def materials(self) -> tuple[str, ...]:
        """Names, by the index that the probe's material image holds."""
        return tuple(m.name for m in self.plan.materials)

    def glsl(self, entry: str = "picture", stage: str = "fragment", near_eye: bool = False) -> str:
        """One complete shader: `picture` (sRGB), `radiance` (linear) or `probe` (depth, normals, ...)."""
        from sdfc.glsl.assembly import assemble

        key = (entry, stage, near_eye)
        if key not in self._texts:
            with deep_recursion():
                self._texts[key] = assemble(
                    self.scene.values, replace(self.plan, near_eye=near_eye), self.setting, entry, stage
                )
        return self._texts[key]

    def web(self, entry: str) -> str:
        """A complete shader for WebGL 2: `picture` (sRGB) or `inspect` (depth, normals, ... by `shown`)."""
        from sdfc.glsl.assembly import assemble_for_web

        key = (entry, "web", False)
        if key not in self._texts:
            with deep_recursion():
                self._texts[key] = assemble_for_web(self.scene.values, self.plan, self.setting, entry)
        return self._texts[key]

    def printed(self, entry: str) -> list[str]:
        """The shaders of an entry that have been asked for so far."""
        return [text for (name, _, _), text in self._texts.items() if name == entry]

    def vertex(self) -> str:
        """The vertex stage that radiance and probe are drawn with."""
        from sdfc.glsl.assembly import vertex_shader

        return vertex_shader()

    def uniforms(
        self,
        view: CameraChange,
        params: Mapping[str, tuple[float, ...]],
        size: tuple[int, int],
        jitter: tuple[float, float] = (0.0, 0.0),
    ) -> dict[str, float | tuple[float, ...]]:
        """Values for every uniform of the shaders, made in float64."""
        return uniforms_of(self.scene, self.setting, self.frame, view, params, size, jitter)

    def pixel(self, view: CameraChange, params: Mapping[str, tuple[float, ...]], size: tuple[int, int]) -> float:
        """How wide a pixel is where the camera looks, in the scene's own unit, which is its radius."""
        values = {p.name: p.default for p in self.scene.params} | dict(params)
        return pixel_at(target_of(self.setting, view, values), self.frame, self.uniforms(view, params, size))

    def explanation(self) -> str:
        """What was proved of the scene and how it will be traced, with reasons."""
        from sdfc.plan.explain import explain

        return explain(self.scene, self.plan, self.frame)


def compile_scene(scene: Scene, options: Options = Options()) -> Compiled:
    """Prove what can be proved, choose, and be ready to print. Raises SceneError where nothing can be proved."""
    root, workshop = normalise(scene, without=options.without, own_unit=options.own_unit)
    frame = workshop.frame
    assert frame is not None
    try:
        with deep_recursion():
            lipschitz = Lipschitz(workshop.ranges, workshop.bounds)
            setting = setting_of(scene, frame)
            chosen = choice(options.tracer)
            rules = Rules(workshop.ranges, workshop.bounds, lipschitz) if chosen.tracer.needs_steps else None
            prover = Prover(scene.values, workshop.bounds, lipschitz, setting.unpainted, options.rays, rules)
            steps = prover.prove(root)
            plan = Plan(
                steps,
                chosen,
                tuple(dict.fromkeys(m for p in prover.parts for m in p.looks)) or (setting.unpainted,),
                prover.slopes(needed=chosen.tracer.needs_map or options.field),
                frame.radius,
                frame.centre,
                frame.is_finite,
                is_convex_solid(root),
                budget=options.most_steps,
            )
            plan = replace(plan, prepass=options.prepass and plan.can_sweep)
    except RecursionError as error:
        raise InternalError("the scene is nested too deeply to compile") from error
    return Compiled(scene, plan, setting, root, frame)


__all__ = ["Compiled", "Kind", "Options", "SceneError", "compile_scene", "load", "normalise", "tracer_names"]
