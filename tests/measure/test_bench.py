"""`sdfc bench`: what it counts is so, what it keeps it need not measure again, and what it says is made from that."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sdfc import pipeline
from sdfc.api.request import RequestError
from sdfc.diagnostics import InternalError, Source, scene_error
from sdfc.measure.bench import entrants, tables
from sdfc.measure.bench.answers import RayDrawing
from sdfc.measure.bench.judged import court
from sdfc.measure.bench.plan import FLOOR, Sweep, Wanted
from sdfc.measure.bench.record import Cell, Record
from sdfc.measure.bench.report import report
from sdfc.measure.bench.run import bench, opened
from sdfc.measure.bench.store import RESULTS, Store, read
from sdfc.pipeline import Options
from sdfc.scene.model import Scene

pytestmark = pytest.mark.gpu

ROOT = Path(__file__).parent.parent.parent
SIZE = (64, 36)
BALL = "camera { eye: [0, 0, 5], target: [0, 0, 0], fov: 30deg } scene { sphere(radius: 1) }"
BLOB = "scene { union(sphere(radius: 1), box(size: [1, 1, 3]), blend: 0.3) }"
CELLS = 2 * (2 * 2 + 1) + 2  # of `wanted`: two tolerances, a floor; a budget on one scene

Measure = Callable[[Wanted], Store]


@pytest.fixture
def wanted(tmp_path: Path, opengl: None) -> Wanted:
    """Two tiny scenes, two tracers."""
    (tmp_path / "ball.sdf").write_text(BALL)
    (tmp_path / "blob.sdf").write_text(BLOB)
    return Wanted(
        (tmp_path / "ball.sdf", tmp_path / "blob.sdf"),
        ("sphere", "proven"),
        sizes=(SIZE,),
        tolerances=(1.0, 8.0),
        budgets=(8,),
        budgeted=("blob.sdf",),
        repeat=2,
        grid=SIZE,
        random=100,
    )


@pytest.fixture
def measure(tmp_path: Path) -> Measure:
    """Run into the folder `kept`."""
    return lambda wanted: bench(wanted, tmp_path / "kept", lambda done, count, cell: None, lambda note: None)


def test_what_is_kept_is_not_measured_again(wanted: Wanted, measure: Measure, tmp_path: Path) -> None:
    first = measure(wanted).records
    assert len(first) == wanted.cells == CELLS
    second = measure(wanted).records
    assert {c: r.to_json() for c, r in second.items()} == {c: r.to_json() for c, r in first.items()}
    (tmp_path / "ball.sdf").write_text(BALL.replace("radius: 1", "radius: 0.9"))
    again = measure(wanted).records
    assert {c.scene for c in again if again[c].key != first[c].key} == {"ball.sdf"}
    assert all(again[c].key != first[c].key for c in again if c.scene == "ball.sdf" and c.tracer != FLOOR)


def test_a_run_that_is_stopped_goes_on(wanted: Wanted, measure: Measure, tmp_path: Path) -> None:
    made: list[str] = []

    def stop(done: int, count: int, cell: str) -> None:
        made.append(cell)
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bench(wanted, tmp_path / "kept", stop, lambda note: None)
    kept = read(tmp_path / "kept").records
    assert sorted(map(str, kept)) == sorted(made)
    whole = measure(wanted).records
    assert len(whole) == CELLS
    assert all(whole[c].to_json() == r.to_json() for c, r in kept.items())


def test_every_ray_is_counted_once_and_proven_is_right(wanted: Wanted, measure: Measure) -> None:
    for cell, record in measure(wanted).records.items():
        if cell.tracer == FLOOR:
            assert record.errors == {} and record.timing is not None
            continue
        judged = {name: e.rays + e.contested + e.ambiguous for name, e in record.errors.items()}
        assert judged == {"grid": SIZE[0] * SIZE[1], "random": wanted.random}
        if cell.tracer == "proven" and cell.budget is None:
            assert record.wrong == 0 and record.errors["grid"].hits > 100
        if cell.budget is not None:
            assert record.work is not None and record.work.steps_max <= cell.budget
            assert record.errors["grid"].stalls <= round(record.work.given_up * SIZE[0] * SIZE[1])


SMALLER = """
out vec4 depth_out;
void main() {
    vec3 d = normalize(ray_ahead);
    float along = dot(ray_origin, d), root = along * along - dot(ray_origin, ray_origin) + 0.64;
    depth_out = root > 0.0 ? vec4(-along - sqrt(root), 3.0, 2.0, 1.0) : vec4(-1.0, 3.0, 2.0, 0.0);
}
"""


@pytest.fixture
def smaller(wanted: Wanted, tmp_path: Path) -> Wanted:
    """The ball, beside a shader that shows one of radius 0.8."""
    (tmp_path / "smaller.frag").write_text(SMALLER)
    return replace(wanted, scenes=wanted.scenes[:1], foreign=(tmp_path / "smaller.frag",))


def test_planted_errors_are_counted_exactly(smaller: Wanted, measure: Measure, tmp_path: Path) -> None:
    record = measure(smaller).records[Cell("ball.sdf", "foreign:smaller.frag", "64x36")]
    with opened() as renderer:
        compiled = entrants.entrant(pipeline.load(Source("ball.sdf", BALL)), "proven", None, renderer)
        assert isinstance(compiled, entrants.Traced)
        judge = court(compiled.compiled, RayDrawing(renderer.device, compiled.compiled.vertex()), SIZE)
        o, d, radius = judge.unanswered.o, judge.unanswered.d, compiled.compiled.plan.radius
    along = (o * d).sum(axis=0)
    nearest = np.sqrt((o * o).sum(axis=0) - along**2) * radius
    sure, grid = judge.truth.sure, record.errors["grid"]
    assert grid.missed == int((sure & (nearest > 0.8) & (nearest < 1.0)).sum()) > 20
    assert (grid.false, grid.early) == (0, 0)
    assert grid.late == int((sure & (nearest < 0.8)).sum()) > 100
    assert record.work is not None and (record.work.steps_mean, record.work.evaluations_mean) == (3.0, 2.0)
    both = sure & (nearest < 0.8)
    away = np.sqrt(1.0 - nearest[both] ** 2) - np.sqrt(0.64 - nearest[both] ** 2)
    pixels = away / radius / (2.0 * judge.cone[1] * judge.truth.t[both])
    assert grid.mean_pixels == pytest.approx(pixels.mean(), rel=1e-4)
    assert grid.pixels.maximum == pytest.approx(pixels.max(), rel=1e-4)


def test_the_examples_of_foreign_shaders(wanted: Wanted, measure: Measure) -> None:
    shaders = tuple(sorted((ROOT / "bench" / "foreign").glob("*.frag")))
    csg5 = replace(wanted, scenes=(ROOT / "scenes" / "csg5.sdf",), tolerances=(1.0,), budgets=(), foreign=shaders)
    found = {c.tracer: r for c, r in measure(csg5).records.items()}
    by_hand, marched = found["foreign:csg5_intervals.frag"], found["foreign:csg5_map.frag"]
    assert by_hand.wrong == 0 and by_hand.p99 < 1e-2
    assert marched.errors["grid"].missed == 0 and by_hand.p99 < marched.p99 < 1.0


def test_a_distance_without_macros_is_what_sphere_marches(wanted: Wanted, measure: Measure, tmp_path: Path) -> None:
    (tmp_path / "own.frag").write_text("#version 450\nfloat map(vec3 p) { return length(p) - 1.0; }\n")
    found = measure(replace(wanted, scenes=wanted.scenes[:1], foreign=(tmp_path / "own.frag",))).records
    for tolerance in wanted.tolerances:
        foreign, own = (found[Cell("ball.sdf", name, "64x36", tolerance)] for name in ("foreign:own.frag", "sphere"))
        assert foreign.work is not None and own.work is not None
        assert foreign.work.evaluations_mean == pytest.approx(own.work.evaluations_mean, rel=0.02)
        assert foreign.p99 == pytest.approx(own.p99, rel=0.02)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("void mein() {}", "neither `void main()` nor `float map(vec3 p)`"),
        ("float map(vec3 p) {\n    return lenght(p);\n}", "line 2: "),
        ("out vec4 c;\nvoid main() {\n    c = vec4(1.0)\n}", "line 4: "),
        ("uniform float iTime; out vec4 c; void main() { c = vec4(iTime); }", "asks for iTime; the uniforms"),
    ],
)
def test_foreign_mistakes(wanted: Wanted, measure: Measure, tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "bad.frag").write_text(text)
    with pytest.raises(RequestError, match=r"bad\.frag") as caught:
        measure(replace(wanted, scenes=wanted.scenes[:1], foreign=(tmp_path / "bad.frag",)))
    assert message in str(caught.value)


def test_a_colour_is_judged_by_its_alpha(wanted: Wanted, measure: Measure, tmp_path: Path) -> None:
    hit = SMALLER.replace("depth_out", "color_out").replace("0.64", "1.0")
    (tmp_path / "flat.frag").write_text(hit)
    (tmp_path / "opaque.frag").write_text("out vec4 c; void main() { c = vec4(1.0); }")
    shaders = (tmp_path / "flat.frag", tmp_path / "opaque.frag")
    found = {
        c.tracer: r for c, r in measure(replace(wanted, scenes=wanted.scenes[:1], foreign=shaders)).records.items()
    }
    flat, opaque = found["foreign:flat.frag"], found["foreign:opaque.frag"]
    assert flat.wrong == 0 and flat.errors["grid"].hits == found["proven"].errors["grid"].hits
    assert flat.work is None and np.isnan(flat.p99)
    assert opaque.errors == {} and opaque.timing is not None


def test_a_tracer_that_is_not_legal_says_so(wanted: Wanted, measure: Measure, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = entrants.asked

    def refused(scene: Scene, spec: str, planned: entrants.Planned | None) -> tuple[Options, str]:
        if spec == "sphere":
            raise scene_error("no Lipschitz constant")
        return asked(scene, spec, planned)

    monkeypatch.setattr(entrants, "asked", refused)
    found = measure(replace(wanted, scenes=wanted.scenes[:1]))
    illegal = found.records[Cell("ball.sdf", "sphere", "64x36")]
    assert illegal.illegal == "no Lipschitz constant" and illegal.timing is None
    proven = found.records[Cell("ball.sdf", "proven", "64x36")]
    assert proven.wrong == 0 and proven.timing is not None and np.isnan(proven.timing.reference)
    assert "illegal: no Lipschitz constant" in tables.page(found)


def test_a_bug_on_one_scene_does_not_cost_the_others(
    wanted: Wanted, measure: Measure, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = entrants.asked

    def broken(scene: Scene, spec: str, planned: entrants.Planned | None) -> tuple[Options, str]:
        if "ball" in scene.source.name:
            raise InternalError("two proofs disagree")
        return asked(scene, spec, planned)

    monkeypatch.setattr(entrants, "asked", broken)
    found = measure(wanted)
    assert [text.split(": ") for text in found.failures] == [["ball.sdf", "two proofs disagree"]]
    assert {c.scene for c in found.records} == {"blob.sdf"}


def test_sweeps_and_additions_are_cells_of_their_own(wanted: Wanted, measure: Measure) -> None:
    names = ("relaxed:omega=1.5", "sphere+prepass", "proven+rays", "auto")
    one = replace(wanted, scenes=wanted.scenes[1:], tracers=("sphere",), tolerances=(1.0,), budgets=())
    found = measure(replace(one, sweeps=(Sweep(names, 8.0),), swept=("blob.sdf",))).records
    assert {c.tracer for c in found if c.tolerance == 8.0} == set(names)
    assert found[Cell("blob.sdf", "auto", "64x36", 8.0)].note != ""


def test_budgets_and_sweeps_may_be_smaller(wanted: Wanted, measure: Measure) -> None:
    halved = replace(wanted, aside=2, sweeps=(Sweep(("sphere", "relaxed"), 64.0),), swept=("ball.sdf",))
    found = measure(halved).records
    assert len(found) == halved.cells
    aside = {c for c in found if c.size == "32x18"}
    assert aside == {c for c in found if c.budget is not None or c.tolerance == 64.0} and len(aside) == 4
    assert {c.size for c in found} == {"64x36", "32x18"}


def test_results_survive_the_file(wanted: Wanted, measure: Measure, tmp_path: Path) -> None:
    store = measure(wanted)
    kept = read(tmp_path / "kept")
    assert kept.text() == store.text() == (tmp_path / "kept" / RESULTS).read_text()
    for record in kept.records.values():
        assert json.dumps(Record.from_json(record.to_json()).to_json()) == json.dumps(record.to_json())
    assert tables.page(kept).count("\n| proven") == 2 * 2 + 1


def test_comparing(wanted: Wanted, measure: Measure) -> None:
    before = measure(wanted)
    text, is_worse = tables.comparison(before, before)
    assert not is_worse and "geometric mean: 1.00" in text
    cell = Cell("ball.sdf", "proven", "64x36")
    record = before.records[cell]
    errors = {**record.errors, "grid": replace(record.errors["grid"], missed=1)}
    after = Store(records={**before.records, cell: replace(record, errors=errors)})
    text, is_worse = tables.comparison(before, after)
    assert is_worse and "worse: ball.sdf, proven, 64x36, tolerance 1: 0 -> 1 wrong" in text
    assert not tables.comparison(after, before)[1]


def test_the_page_is_what_the_kept_results_make(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    page = Path("docs/benchmarks.md")
    text = page.read_text()
    folder = Path(text.split("--report ", 1)[1].split(" ", 1)[0])  # the page says what it was made from
    assert text == report(read(folder), folder, page)
