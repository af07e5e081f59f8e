"""Fixtures that every test may use: goldens, OpenGL, and field functions run on it."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import settings

from sdfc.field.function import Function
from sdfc.field.graph import Expr, Op, Type, topological

if TYPE_CHECKING:
    import moderngl
    import numpy as np

    from sdfc.api.renderer import GlRenderer
    from sdfc.gpu.device import Device

RunFunction = Callable[..., "np.ndarray[Any, Any]"]
Golden = Callable[[str, str], None]
GOLDEN = Path(__file__).parent / "golden"


def pytest_addoption(parser: pytest.Parser) -> None:
    """--update-golden writes what tests made as what they should make."""
    parser.addoption("--update-golden", action="store_true", help="write tests/golden anew (read the difference)")


def pytest_configure(config: pytest.Config) -> None:
    """No machine approves of its own work; and a run finds what the last one found, unless it is sent exploring."""
    settings.register_profile("steady", derandomize=True, deadline=None, database=None)
    settings.load_profile("default" if os.environ.get("SDFC_EXPLORE") else "steady")
    if config.getoption("--update-golden") and os.environ.get("CI"):
        raise pytest.UsageError("--update-golden is refused where CI is set")


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Golden:
    """golden(name, text) holds the text against tests/golden/name."""

    def compare(name: str, text: str) -> None:
        path = GOLDEN / name
        if request.config.getoption("--update-golden"):
            GOLDEN.mkdir(exist_ok=True)
            path.write_text(text)
        assert path.exists(), f"there is no {path}: run pytest --update-golden"
        assert text == path.read_text(), f"the text is not that of {path}: if it should differ, --update-golden"

    return compare


@pytest.fixture
def gl(gl_context: moderngl.Context) -> moderngl.Context:
    """The OpenGL context, current: tests before this one may have had others."""
    gl_context.__enter__()
    return gl_context


@pytest.fixture(scope="session")
def opengl() -> None:
    """OpenGL is here. Without it the test is skipped, or fails if SDFC_REQUIRE_GL=1 (as in CI)."""
    from sdfc.diagnostics import DeviceError
    from sdfc.gpu.device import open_device

    try:
        open_device().close()
    except DeviceError as error:
        if os.environ.get("SDFC_REQUIRE_GL") == "1":
            pytest.fail(f"SDFC_REQUIRE_GL=1, but there is no OpenGL here: {error}")
        pytest.skip(f"no OpenGL here: {error}")


@pytest.fixture(scope="session")
def device(opengl: None) -> Iterator[Device]:
    """An open device."""
    from sdfc.gpu.device import open_device

    with open_device() as opened:
        yield opened


@pytest.fixture(scope="session")
def renderer(opengl: None) -> Iterator[GlRenderer]:
    """A renderer with a device of its own."""
    from sdfc.api.renderer import GlRenderer

    with contextlib.closing(GlRenderer()) as opened:
        yield opened


@pytest.fixture(scope="session")
def gl_context(opengl: None) -> Iterator[moderngl.Context]:
    """An OpenGL context that is not sdfc's own, for shaders that a test writes."""
    import moderngl

    context = moderngl.create_standalone_context(backend="egl")
    yield context
    context.release()


@pytest.fixture(scope="session")
def run_function(gl_context: moderngl.Context) -> RunFunction:
    """run_function(function, inputs, params={}) prints the function as GLSL and evaluates it over arrays on the GPU.

    `inputs` has (n,) for a FLOAT parameter and (k, n) for a VECk; the result likewise, float32; a BOOL gives 0 and 1.
    """

    def run(
        function: Function, inputs: Mapping[str, Any], params: Mapping[str, Any] | None = None
    ) -> np.ndarray[Any, Any]:
        import numpy as np

        rows = [
            np.atleast_2d(np.asarray(inputs[name], np.float32)).reshape(type_.size, -1)
            for name, type_ in function.parameters
        ]
        given = np.concatenate(rows) if rows else np.zeros((1, 1), np.float32)
        count = given.shape[1]
        size = function.result.type.size
        gl_context.__enter__()
        program = gl_context.compute_shader(_compute_shader(function, count))
        _set_uniforms(program, function.result, params or {})
        source = gl_context.buffer(np.ascontiguousarray(given).tobytes())
        target = gl_context.buffer(reserve=4 * size * count)
        source.bind_to_storage_buffer(0)
        target.bind_to_storage_buffer(1)
        program.run((count + 63) // 64)
        gl_context.finish()
        result = np.frombuffer(target.read(), np.float32).reshape(size, count)
        for resource in (source, target, program):
            resource.release()
        return result if size > 1 else result[0]

    return run


def _compute_shader(function: Function, count: int) -> str:
    """A shader whose thread i calls the function with column i of the rows in `given`."""
    from sdfc.glsl.expression import print_function, type_name
    from sdfc.glsl.names import identifier, param_name

    params = {str(n.value): n.type for n in topological([function.result]) if n.op is Op.PARAM}
    uniforms = "".join(f"uniform {type_name(t)} {param_name(name)};\n" for name, t in sorted(params.items()))
    arguments = []
    row = 0
    for _, type_ in function.parameters:
        columns = [f"given[{row + i}u * {count}u + i]" for i in range(type_.size)]
        arguments.append(f"{type_name(type_)}({', '.join(columns)})")
        row += type_.size
    result = function.result.type
    components = [""] if result.size == 1 else [f".{letter}" for letter in "xyzw"[: result.size]]
    stores = "".join(f"    made[{n}u * {count}u + i] = float(r{c});\n" for n, c in enumerate(components))
    return f"""#version 430
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Given {{ float given[]; }};
layout(std430, binding = 1) writeonly buffer Made {{ float made[]; }};
{uniforms}
{print_function(function)}
void main() {{
    uint i = gl_GlobalInvocationID.x;
    if (i >= {count}u) return;
    {type_name(result)} r = {identifier(function.name)}({", ".join(arguments)});
{stores}}}
"""


def _set_uniforms(program: Any, root: Expr, params: Mapping[str, Any]) -> None:
    from sdfc.glsl.names import param_name

    for node in topological([root]):
        name = param_name(str(node.value))
        if node.op is Op.PARAM and name in program:  # the compiler may have dropped it
            value = params[str(node.value)]
            program[name].value = bool(value) if node.type is Type.BOOL else value
