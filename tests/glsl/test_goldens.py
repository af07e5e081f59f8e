"""The text of six small scenes, whole: a change of it is seen, and is made on purpose (pytest --update-golden)."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from glsl_scenes import ROOT, SMALL, compiled_text

STAGES = {"fragment": "frag", "compute": "comp"}
NAMES = {f"{name}.{suffix}" for name in SMALL for suffix in STAGES.values()}
FOLDER = ROOT / "tests" / "golden"


@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("name", SMALL)
def test_golden(name: str, stage: str, golden: Callable[[str, str], None]) -> None:
    golden(f"{name}.{STAGES[stage]}", compiled_text(SMALL[name]).glsl("picture", stage))


def test_no_golden_is_an_orphan() -> None:
    assert {p.name for p in FOLDER.iterdir()} == NAMES


_EMIT = """
import hashlib, sys
sys.path.insert(0, sys.argv[1])
from glsl_scenes import ENTRIES, SMALL, compiled_text
for name in SMALL:
    compiled = compiled_text(SMALL[name])
    for entry, stage in ENTRIES:
        print(name, entry, stage, hashlib.sha256(compiled.glsl(entry, stage).encode()).hexdigest())
"""


def test_two_processes_write_the_same_text() -> None:
    """Whatever the hash seed: no set or dictionary of nodes decides an order."""
    here = str(Path(__file__).parent)
    texts = []
    for seed in ("1", "4711"):
        environment = os.environ | {"PYTHONHASHSEED": seed}
        run = subprocess.run(
            [sys.executable, "-c", _EMIT, here], env=environment, capture_output=True, text=True, check=True, cwd=ROOT
        )
        texts.append(run.stdout)
    assert texts[0] == texts[1]
    assert texts[0].count("\n") == 4 * len(SMALL)


def spheres(count: int) -> str:
    return (
        f"scene {{ union(for i in 0..{count}: sphere(radius: 0.05 + 0.0001 * i).translate("
        "[fract(0.7548776 * i), fract(0.5698402 * i), fract(0.3247179 * i)])) }"
    )


def test_text_grows_by_a_line_a_part() -> None:
    begin = time.process_time()
    small = compiled_text(spheres(300)).glsl()
    print(f"300 spheres: {time.process_time() - begin:.2f} s of CPU, {len(small)} characters")
    large = compiled_text(spheres(600)).glsl()
    lines = large.count("\n") - small.count("\n")
    assert 300 <= lines <= 420
    assert len(large) < 2.0 * len(small)


@pytest.mark.parametrize("count", [20, 40])
def test_cut_parts_grow_evenly_too(count: int) -> None:
    """What is no row of a table: straight lines, the same number for each part."""

    def length(n: int) -> int:
        part = "(box(size: [1, 1, 1]) - sphere(radius: 0.6)).rotate(y: 20deg).translate([2 * i, 0, 0])"
        return len(compiled_text(f"scene {{ union(for i in 0..{n}: {part}) }}").glsl())

    first, second, third = length(count), length(2 * count), length(3 * count)
    assert abs((third - second) - (second - first)) < 0.05 * (second - first)
