"""Syntax tree to Scene: names, types and units resolved, functions and loops expanded, everything checked."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sdfc.diagnostics import Diagnostic, SceneError, Source, scene_error
from sdfc.field.graph import FieldGraph
from sdfc.scene import combine, settings
from sdfc.scene.calls import RULES
from sdfc.scene.files import Folder
from sdfc.scene.imports import load_modules
from sdfc.scene.library import Library
from sdfc.scene.limits import DEEPEST_FRAMES
from sdfc.scene.literals import NO_LITERALS, Literals
from sdfc.scene.model import Camera, Light, Scene, Sky
from sdfc.scene.module import FileModule
from sdfc.scene.names import Context, Problems
from sdfc.scene.unused import recursion, shadowing, unused
from sdfc.shape.graph import Shape, ShapeGraph
from sdfc.syntax import tree
from sdfc.syntax.parse import parse


def elaborate(source: Source, folder: Path | None, literals: Literals = NO_LITERALS) -> Scene:
    """The scene that a text describes; `folder` is where the files that it names are; `literals` become live.

    Raises SceneError, and nothing else, for any text that is not a scene, with everything that is wrong.
    """
    with _deep():
        try:
            return _elaborate(source, folder, literals)
        except SceneError as error:
            raise SceneError(*sorted(error.diagnostics, key=lambda d: _order(d, source))) from None
        except RecursionError:
            raise scene_error(
                f"{source.name} is nested too deeply: brackets, blocks or calls within each other"
            ) from None


def _order(diagnostic: Diagnostic, source: Source) -> tuple[bool, str, int]:
    """Other files first, since what is wrong there may be the cause; then by place."""
    span = diagnostic.span
    return (True, "", -1) if span is None else (span.source is source, span.source.name, span.start)


@contextmanager
def _deep() -> Iterator[None]:
    """Room for scenes that are nested deeply. Python's own frames need no stack of the machine."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(before, DEEPEST_FRAMES))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)


def _elaborate(source: Source, place: Path | None, literals: Literals) -> Scene:
    graph = FieldGraph()
    context = Context(graph, ShapeGraph(), Library(graph), RULES, literals)
    folder = Folder(place)
    problems = Problems()
    module = load_modules(parse(source), context, folder, problems)
    problems.add(*recursion(module))
    problems.finish()  # beyond this, every error would be told again wherever the name is used
    module.declare_params(problems)
    scene = _scene(module, folder, problems)
    problems.finish()
    assert scene is not None
    return scene


def _scene(module: FileModule, folder: Folder, problems: Problems) -> Scene | None:
    context = module.context
    _check_declarations(module, problems)
    camera, lights, sky = _camera(module, problems), _lights(module, problems), _sky(module, problems)
    root = _root(module, problems)
    context.budget.is_over = True
    if root is None:
        return None
    warnings = list(dict.fromkeys([*context.warnings, *shadowing(module), *unused(module)]))
    return Scene(
        source=module.file.source,
        values=context.graph,
        shapes=context.shapes,
        root=root,
        params=tuple(context.params.values()),
        camera=camera,
        lights=tuple(lights),
        sky=sky,
        warnings=tuple(warnings),
        files=tuple(folder.read),
    )


def _check_declarations(module: FileModule, problems: Problems) -> None:
    """Materials, constants and fields are made even where nothing uses them, so that what is wrong in them is told."""
    for name, declaration in module.own.items():
        try:
            if isinstance(declaration, tree.FieldDeclaration):
                module.definition(name)
            elif not isinstance(declaration, tree.FunctionDeclaration) or declaration.parameters is None:
                module.value(name, declaration.name.span)
        except SceneError as error:
            problems.take(error)


def _only(module: FileModule, kind: type, word: str, problems: Problems) -> tree.Statement | None:
    """The one statement of that kind."""
    found = [s for s in module.file.statements if isinstance(s, kind)]
    for other in found[1:]:
        message = f"a second {word}: there is one in a scene"
        problems.add(Diagnostic(message, other.span, f"the first is at {found[0].span}"))
    return found[0] if found else None


def _camera(module: FileModule, problems: Problems) -> Camera | None:
    node = _only(module, tree.CameraDeclaration, "camera", problems)
    try:
        return settings.camera(node, module.top()) if isinstance(node, tree.CameraDeclaration) else None
    except SceneError as error:
        problems.take(error)
        return None


def _sky(module: FileModule, problems: Problems) -> Sky | None:
    node = _only(module, tree.SkyDeclaration, "sky", problems)
    try:
        return settings.sky(node, module.top()) if isinstance(node, tree.SkyDeclaration) else None
    except SceneError as error:
        problems.take(error)
        return None


def _lights(module: FileModule, problems: Problems) -> list[Light]:
    lights: list[Light] = []
    for node in module.file.statements:
        if isinstance(node, tree.LightDeclaration):
            try:
                lights.append(settings.light(node, module.top()))
            except SceneError as error:
                problems.take(error)
    return lights


def _root(module: FileModule, problems: Problems) -> Shape | None:
    node = _only(module, tree.SceneDeclaration, "scene block", problems)
    if not isinstance(node, tree.SceneDeclaration):
        place = module.file.statements[-1].span if module.file.statements else None
        problems.add(Diagnostic("the scene has no scene block", place, "add scene { … } with the shapes to be seen"))
        return None
    try:
        shapes = combine.flat_shapes(combine.block(node.block, module.top()), 3)
        return combine.union(shapes, module.top(), node.span)
    except SceneError as error:
        problems.take(error)
        return None
