"""What a person sees and does on the page, in a real browser, with `sdfc watch --serve` behind it."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest
from devtools import Open, Tab, until
from hands import COUNTED, SIZE, Pixels, another, assert_alike, copied, picture, programs, served, share_of_others
from PIL import Image
from servers import Watch

from sdfc.api.program import compile as compile_scene
from sdfc.scene.color import linear

pytestmark = pytest.mark.gpu


def test_the_picture_is_the_one_that_sdfc_draws(watch: Watch, page: Open) -> None:
    tab = page(size=SIZE)
    own = picture(tab)
    assert own.std() > 20, "there is something to see"
    assert_alike(own, served(tab))
    tab.drag((200, 160), (290, 190))
    turned = picture(tab)
    assert share_of_others(own, turned) > 0.1
    assert_alike(turned, served(tab))
    tab.key("+")
    tab.key("ArrowUp", shift=True)
    assert_alike(picture(tab), served(tab))


def test_edits_of_the_text_are_seen(watch: Watch, page: Open) -> None:
    tab = page(size=SIZE, prepare=COUNTED)
    first, made = picture(tab), programs(tab)
    watch.edit("param size = 0.5", "param size = 0.3")
    smaller = another(tab, first)
    assert programs(tab) == made, "a number that is live compiles nothing"
    watch.edit("eye: [2, 1.6, 3]", "eye: [-2, 1.6, 3]")
    moved = another(tab, smaller)
    assert programs(tab) == made, "nor does the camera"
    watch.edit("sphere(radius: size)", "box(size: [size, size, size])")
    boxy = another(tab, moved)
    assert programs(tab) == made + 1
    assert_alike(boxy, served(tab))


def test_what_is_wrong_is_told_over_the_last_good_picture(watch: Watch, page: Open) -> None:
    tab = page(size=(1000, 420))
    first = picture(tab)
    assert tab.run("document.querySelector('#problem').hidden")
    watch.edit("sphere(radius: size)", "sphere(rad: size)")
    tab.until("!document.querySelector('#problem').hidden")
    told = tab.text("#problem pre")
    line, caret = told.splitlines()[1:3]
    assert line[caret.index("^") :].startswith("rad: size") and caret.count("^") == 3, told
    assert "did you mean 'radius'?" in told
    top = slice(0, 120)  # what was wrong is told below
    assert share_of_others(picture(tab)[top], first[top]) == 0
    watch.edit("sphere(rad: size)", "sphere(radius: size)")
    tab.until("document.querySelector('#problem').hidden")
    assert share_of_others(picture(tab), first) == 0


def test_a_slider_moves_a_param(watch: Watch, page: Open) -> None:
    tab = page(size=SIZE, prepare=COUNTED)
    first, made = picture(tab), programs(tab)
    assert tab.run("document.querySelector('#param-turn-0-number').value") == "30", "angles are in degrees"
    tab.run("document.querySelector('#param-size-0').focus()")
    for _ in range(10):
        tab.key("ArrowRight", shift=True)
    assert tab.run("document.querySelector('#param-size-0-number').value") == "0.8", "a slider ends"
    larger = picture(tab)
    assert share_of_others(first, larger) > 0.02
    assert_alike(larger, served(tab))
    assert programs(tab) == made
    tab.click(".control button")
    assert share_of_others(picture(tab), first) == 0, "the button beside it takes it back"
    tab.run("document.querySelector('#param-size-0').focus()")
    tab.key("ArrowRight")
    tab.click("#reset-all")
    assert share_of_others(picture(tab), first) == 0


def test_a_number_is_typed_and_kept_within_its_range(watch: Watch, page: Open) -> None:
    tab = page(size=SIZE)
    for typed, kept in (("77.5", "77.5"), ("-999", "-180")):
        tab.run("document.querySelector('#param-turn-0-number').select()")
        tab.type(typed)
        tab.key("Enter")
        tab.until(f"document.querySelector('#param-turn-0-number').value === '{kept}'")
    assert_alike(picture(tab), served(tab))


def test_a_colour_is_chosen(watch: Watch, page: Open) -> None:
    tab = page(size=SIZE)
    first = picture(tab)
    assert tab.run("document.querySelector('#param-paint').value") == "#c8452f"
    tab.run(
        "(input => { input.value = '#2f8f45'; input.dispatchEvent(new Event('input')) })"
        "(document.querySelector('#param-paint'))"
    )
    green = picture(tab)
    assert share_of_others(first, green) > 0.05
    assert_alike(green, served(tab))


def test_a_slider_follows_the_text_and_keeps_its_place_otherwise(watch: Watch, page: Open) -> None:
    tab = page(size=SIZE)
    tab.run("document.querySelector('#param-size-0').focus()")
    tab.key("ArrowLeft")
    set_by_hand = tab.run("document.querySelector('#param-size-0-number').value")
    assert set_by_hand == "0.494"
    watch.edit("box(size: [1, 1, 1])", "box(size: [1, 1, 1]).round(0.1)")
    tab.until("document.querySelector('#note').textContent.includes('new shader')")
    tab.rest()
    assert tab.run("document.querySelector('#param-size-0-number').value") == set_by_hand
    watch.edit("param size = 0.5", "param size = 0.25")
    tab.until("document.querySelector('#param-size-0-number').value === '0.25'")


def test_the_mouse_and_the_keys_move_the_camera(watch: Watch, page: Open) -> None:
    tab = page(size=SIZE)
    eye = np.array(copied(tab).eye.numbers)
    target = np.array(copied(tab).target.numbers)

    def turned() -> float:
        now = np.array(copied(tab).eye.numbers) - target
        assert math.isclose(np.linalg.norm(now), np.linalg.norm(eye - target), rel_tol=1e-4)
        angle = math.atan2(now[0], now[2]) - math.atan2(*(eye - target)[[0, 2]])
        return math.degrees(angle)

    tab.drag((100, 160), (180, 160))
    assert math.isclose(turned(), -180 * 80 / SIZE[1], abs_tol=0.1), "half a turn for the picture's height"
    tab.key("Home")
    assert math.isclose(turned(), 0, abs_tol=1e-3)
    tab.key("ArrowRight")
    assert math.isclose(turned(), 7.5, abs_tol=0.01)
    tab.key("Home")
    for button, shift in (("right", False), ("left", True)):
        tab.drag((100, 160), (180, 140), button=button, shift=shift)
        moved = np.array(copied(tab).target.numbers) - target
        assert np.allclose(np.array(copied(tab).eye.numbers) - eye, moved, atol=1e-3) and np.linalg.norm(moved) > 0.1
        tab.key("Home")
    tab.mouse("mouseWheel", (100, 100), deltaX=0, deltaY=-120)
    assert until(lambda: np.linalg.norm(np.array(copied(tab).eye.numbers) - target) < np.linalg.norm(eye - target), "")
    tab.key("Home")
    tab.key("-")
    assert np.linalg.norm(np.array(copied(tab).eye.numbers) - target) > np.linalg.norm(eye - target)


def test_two_fingers_zoom_and_do_not_turn(watch: Watch, page: Open) -> None:
    tab = page(size=SIZE)
    before = copied(tab)
    tab.pinch((200, 150), 80, 160)
    after = copied(tab)
    toward = [np.subtract(c.eye.numbers, c.target.numbers) for c in (before, after)]
    assert np.allclose(toward[1], 0.5 * toward[0], rtol=0.02), "twice as far apart is twice as near"
    assert np.allclose(after.target.numbers, before.target.numbers, atol=0.01)


def test_the_views_show_what_the_renderer_measures(watch: Watch, page: Open) -> None:
    tab = page(size=SIZE)
    box = tab.box("#view")
    size = (int(box["width"]), int(box["height"]))
    with compile_scene(watch.scene) as program:
        image = program.render(size, backend="gl", aovs=("depth", "normal", "material"))
    cut = (slice(60, None), slice(None, -60))
    depth, material = image.depth[cut], image.material[cut]
    inside = _away_from_edges(np.dstack([material, 10 * image.normal[cut]]))
    hit = inside & (material >= 0)
    assert hit.mean() > 0.1

    tab.key("3")
    normals = picture(tab)
    assert np.abs(normals - (255 * (0.5 + 0.5 * image.normal[cut])))[hit].max() <= 3

    tab.key("2")
    shades = picture(tab)[hit][:, 0]
    order = np.argsort(depth[hit])
    assert (np.diff(shades[order]) <= 1).all() and shades.max() - shades.min() > 20, "farther is darker"

    tab.key("5")
    flat = picture(tab)
    shown = tab.run("[...document.querySelectorAll('.swatches li')].map(e => e.style.getPropertyValue('--color'))")
    assert len(shown) == len(image.materials)
    for index, color in enumerate(shown):
        where = hit & (material == index)
        if where.any():
            assert np.abs(flat[where] - [int(color[i : i + 2], 16) for i in (1, 3, 5)]).max() <= 1, color


def _away_from_edges(measured: Pixels) -> Pixels:
    """(height, width): where all neighbours, two pixels far, are within 1 of it."""
    height, width = measured.shape[0] - 4, measured.shape[1] - 4
    shifted = [measured[y : y + height, x : x + width] for y in range(5) for x in range(5)]
    even = (np.max(shifted, axis=0) - np.min(shifted, axis=0)).max(axis=-1) < 1
    return np.pad(even, 2)


def test_the_view_of_steps_is_on_its_scale(watch: Watch, page: Open) -> None:
    watch.save("scene { box(size: [1, 2, 1]).twist(60deg) sphere(radius: 0.5).translate([1.5, 0, 0]) }")
    tab = page(size=SIZE)
    tab.until("document.querySelector('#params').hidden")
    tab.key("4")
    heat = picture(tab)
    even = heat[_away_from_edges(heat)]
    ends = np.array([[0, 0, 4], [87, 16, 110], [188, 55, 84], [249, 142, 9], [252, 255, 164]])
    at = np.log2(1.0 + np.arange(128)) / 7 * 4
    scale = np.stack([np.interp(at, range(5), ends[:, c]) for c in range(3)], axis=-1)
    off = np.abs(np.unique(even, axis=0)[:, None] - scale).max(axis=-1)
    assert off.min(axis=1).max() <= 2, "every colour is one of the scale"
    assert len(np.unique(off.argmin(axis=1))) > 2


def test_bounds_lie_around_what_is_seen(watch: Watch, page: Open) -> None:
    watch.save("camera { eye: [0, 0, 6], target: [0, 0, 0], height: 3 }\nscene { sphere(radius: 1) }")
    tab = page(size=SIZE)
    tab.until("document.querySelector('#params').hidden")
    tab.key("3")
    tab.until("document.querySelector('#legend').textContent.includes('x')")
    plain = picture(tab)
    tab.click("#show-bounds")
    lines = picture(tab)
    drawn = np.argwhere(np.abs(lines - plain).max(axis=-1) > 30)
    normals = np.argwhere(np.abs(plain - plain[0, 0]).max(axis=-1) > 8)
    for low_or_high in (np.min, np.max):
        edge, solid = low_or_high(drawn, axis=0), low_or_high(normals, axis=0)
        assert np.abs(edge - solid)[1] <= 3, "left and right"
    assert np.max(drawn, axis=0)[0] - np.max(normals, axis=0)[0] <= 3
    watch.edit("radius: 1", "radius: 0.8")  # compiled: the number becomes live
    tab.until("document.querySelector('#note').textContent.includes('new shader')")
    watch.edit("radius: 0.8", "radius: 0.6")
    tab.until("document.querySelector('#note').textContent.includes('numbers')")
    smaller = picture(tab)
    tab.key("b")
    drawn = np.argwhere(np.abs(picture(tab) - smaller).max(axis=-1) > 30)
    assert np.abs(np.ptp(drawn, axis=0)[1] - 0.6 * np.ptp(normals, axis=0)[1]) <= 6, "they follow numbers"


def test_the_picture_is_saved(watch: Watch, page: Open, tmp_path_factory: pytest.TempPathFactory) -> None:
    tab = page(size=SIZE)
    folder = tmp_path_factory.mktemp("saved")
    tab.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder))
    own = picture(tab)
    tab.key("s")
    file = folder / "model.png"
    until(lambda: file.exists() and file.stat().st_size > 0, "the file")
    saved = np.asarray(Image.open(io.BytesIO(file.read_bytes())).convert("RGB")).astype(int)
    assert share_of_others(saved[60:, :-60], own, by=1) == 0


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize(("size", "ratio"), [((400, 700), 1.0), ((1600, 500), 1.0), ((500, 300), 2.0)])
def test_it_fits_every_window(watch: Watch, page: Open, size: tuple[int, int], ratio: float, scheme: str) -> None:
    tab = page(size=size, ratio=ratio, scheme=scheme)
    assert tab.run("document.documentElement.scrollWidth <= innerWidth"), "nothing to scroll sideways"
    assert tab.run("document.querySelector('#panel').scrollWidth <= document.querySelector('#panel').clientWidth")
    view, panel = tab.box("#view"), tab.box("#panel")
    assert view["width"] * view["height"] > 0.35 * size[0] * size[1], "the picture first"
    assert panel["right"] <= size[0] and panel["bottom"] <= size[1]
    pixels = tab.run("(c => [c.width, c.height])(document.querySelector('#picture'))")
    assert pixels == [round(ratio * view["width"]), round(ratio * view["height"])]
    assert _contrast(tab, "#panel", "#title") > 7
    assert _contrast(tab, "#panel", "#connection") > 4.5
    tab.key("h")
    tab.until("document.querySelector('#view').clientWidth === innerWidth")
    tab.key("h")


def _contrast(tab: Tab, ground: str, words: str) -> float:
    """Of the Web Content Accessibility Guidelines 2.2."""
    colors = tab.run(
        f"[getComputedStyle(document.querySelector('{ground}')).backgroundColor,"
        f" getComputedStyle(document.querySelector('{words}')).color].map(c => c.match(/[\\d.]+/g).map(Number))"
    )
    bright = sorted(float(np.dot([0.2126, 0.7152, 0.0722], [linear(c / 255) for c in rgb[:3]])) for rgb in colors)
    return (bright[1] + 0.05) / (bright[0] + 0.05)


def test_all_of_it_is_reached_by_the_keyboard_and_has_a_name(watch: Watch, page: Open) -> None:
    tab = page(size=(900, 700))
    wanted = tab.run(
        "[...document.querySelectorAll('#view, button:not([disabled]), input')].filter(e => e.checkVisibility("
        "{visibilityProperty: true}) && (e.type !== 'radio' || e.checked)).map(e => e.id || e.value || e.ariaLabel)"
    )
    reached = set()
    for _ in range(len(wanted) + 3):
        tab.key("Tab")
        seen = tab.run("(e => [e.id || e.value || e.ariaLabel, e.matches(':focus-visible')])(document.activeElement)")
        reached.add(seen[0])
        assert seen[1] or seen[0] is None, f"the focus on {seen[0]} is not to be seen"
    assert set(wanted) <= reached
    tab.call("Accessibility.enable")
    roles = {"button", "checkbox", "radio", "slider", "spinbutton", "switch", "application", "ColorWell"}
    nodes = tab.call("Accessibility.getFullAXTree")["nodes"]
    found = [n for n in nodes if not n.get("ignored") and n.get("role", {}).get("value") in roles]
    assert len(found) >= len(wanted)
    assert [n for n in found if not n.get("name", {}).get("value")] == []


def test_the_help_names_every_key(watch: Watch, page: Open) -> None:
    tab = page(size=(900, 700))
    tab.key("?")
    tab.until("document.querySelector('#help').open")
    keys = tab.run("[...document.querySelectorAll('#help kbd')].map(e => e.textContent)")
    assert {"←", "+", "\u2212", "Home", "1", "6", "B", "S", "C", "H", "?", "Shift"} <= set(keys)
    before = picture(tab)
    tab.key("ArrowLeft")
    assert share_of_others(before, picture(tab)) == 0, "behind the help nothing moves"
    tab.key("Enter")
    tab.until("!document.querySelector('#help').open")
