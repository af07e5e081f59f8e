"""What the tests of the language share: a scene from text, and what stands in it."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

from sdfc.diagnostics import SceneError, Source, show_all
from sdfc.scene.elaborate import elaborate
from sdfc.scene.model import Scene
from sdfc.shape.graph import Apply, Shape, topological

Node = TypeVar("Node")


def scene(text: str, folder: Path | None = None, name: str = "test.sdf") -> Scene:
    return elaborate(Source(name, text), folder)


def root(text: str) -> Shape:
    """The shape of `scene { text }`."""
    return scene("scene { " + text + " }").root


def errors(text: str, folder: Path | None = None) -> str:
    """What a user reads of a scene that is wrong; '' of one that is right."""
    try:
        scene(text, folder)
    except SceneError as error:
        return show_all(error.diagnostics)
    return ""


def messages(text: str, folder: Path | None = None) -> list[str]:
    """The messages alone."""
    try:
        scene(text, folder)
    except SceneError as error:
        return [d.message for d in error.diagnostics]
    return []


def the(kind: type[Node], shape: object) -> Node:
    """The shape, which must be of that kind."""
    assert isinstance(shape, kind), shape
    return shape


def applied(shape: Shape) -> list[str]:
    """The names of all fields below a shape, children first."""
    return [node.definition.name for node in topological(shape) if isinstance(node, Apply)]


def argument(text: str) -> tuple[float, ...]:
    """The components of a value, as the first argument of a field that takes anything of its size."""
    sizes = {1: "number", 2: "vector2", 3: "vector3"}
    for kind in sizes.values():
        made = f"field probe(value: {kind}) = length(p) * length(value)\n"
        try:
            found = scene(f"{made}scene {{ probe(value: {text}) }}").root
        except SceneError:
            continue
        first = the(Apply, found).arguments[0]
        assert not isinstance(first, tuple)
        return first.numbers
    raise AssertionError(errors(f"field probe(value: number) = value\nscene {{ probe(value: {text}) }}"))
