"""What the page does when the server, the driver or the connection does what they seldom do."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from devtools import Browser, Open, until
from hands import COUNTED, SIZE, another, copied, picture, share_of_others
from PIL import Image
from servers import Actor, Watch

pytestmark = pytest.mark.gpu

EDITS = 200
LOSING = """new Promise((done) => {
  const canvas = document.querySelector("#picture");
  globalThis.loss = canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
  canvas.addEventListener("webglcontextlost", () => done(true));
  loss.loseContext();
})"""


@pytest.fixture
def actor(watch: Watch) -> Iterator[Actor]:
    with closing(Actor(watch.told())) as opened:
        yield opened


def changed(scene: dict[str, Any], number: int) -> dict[str, Any]:
    """The scene, with other shaders."""
    shaders = {name: f"{text}\nconst float CHANGED = {number}.0;\n" for name, text in scene["shaders"].items()}
    return {**scene, "id": number, "shaders": shaders}


def test_many_edits_leave_nothing_behind(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=SIZE, prepare=COUNTED)
    before = picture(tab)
    alive, nodes = tab.run("counted.alive"), tab.run("document.querySelectorAll('*').length")
    for number in range(2, EDITS + 2):
        actor.say(changed(actor.scene, number))
        actor.say({"type": "values", "id": number, "values": {"set_size": [0.3 + 0.001 * number]}})
        if number % 20 == 0:
            tab.rest()
    actor.say(actor.scene)
    tab.until("!document.querySelector('#view').matches('[aria-busy=true]')")
    assert share_of_others(another(tab, before * 0), before) == 0
    assert tab.run("counted.programs") > 15, "some of them were compiled"
    assert tab.run("counted.alive") == alive
    assert tab.run("document.querySelectorAll('*').length") == nodes


def test_a_shader_that_the_driver_refuses_is_told(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=SIZE)
    before = picture(tab)
    shaders = {**actor.scene["shaders"], "picture": "#version 300 es\nvoid main() {"}
    actor.say({**actor.scene, "id": 2, "shaders": shaders})
    tab.until("!document.querySelector('#problem').hidden")
    assert "ERROR" in tab.text("#problem pre")
    assert share_of_others(picture(tab)[:80], before[:80]) == 0, "the last good picture stays"
    actor.say({"type": "errors", "text": "s.sdf:1:1: error: no", "diagnostics": [{"message": "no"}]})
    tab.until("document.querySelector('#problem pre').textContent.includes('s.sdf')")
    actor.say({**actor.scene, "id": 3, "shaders": shaders})
    tab.until("document.querySelector('#problem pre').textContent.includes('ERROR')")
    assert not tab.run("document.querySelector('#problem').hidden"), "and is told again"
    actor.say({**actor.scene, "id": 4})
    tab.until("document.querySelector('#problem').hidden")


def test_what_the_driver_refuses_is_told_until_another_shader_comes(actor: Actor, page: Open) -> None:
    """Edits of numbers, a camera, errors that are mended: the shader is still the one that is refused."""
    tab = page(actor.url, size=SIZE)
    shaders = {**actor.scene["shaders"], "picture": "#version 300 es\nvoid main() {"}
    actor.say({**actor.scene, "id": 2, "shaders": shaders})
    tab.until("document.querySelector('#problem pre').textContent.includes('ERROR')")
    heard: list[dict[str, Any]] = [
        {"type": "values", "id": 2, "values": {"set_size": [0.3]}},
        {"type": "camera", "id": 2, "camera": actor.scene["camera"]},
        {"type": "well"},
    ]
    for number, message in enumerate(heard):
        actor.say({"type": "errors", "text": f"error {number}", "diagnostics": [{"message": "no"}]})
        tab.until(f"document.querySelector('#problem pre').textContent === 'error {number}'")
        actor.say(message)
        tab.until("document.querySelector('#problem pre').textContent.includes('ERROR')")
        assert not tab.run("document.querySelector('#problem').hidden"), message
    tab.key("3")
    tab.until("document.querySelector('#problem').hidden")
    tab.key("1")
    assert not tab.run("document.querySelector('#problem').hidden"), "of the view that it is wanted for"
    actor.say({**actor.scene, "id": 3})
    tab.until("document.querySelector('#problem').hidden")


def test_a_lost_context_is_told_and_restored(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=SIZE)
    before = picture(tab)
    tab.run(LOSING)
    assert "took the GPU away" in tab.text("#problem h2") and not tab.run("document.querySelector('#problem').hidden")
    actor.say({"type": "well"})
    actor.say({"type": "note", "text": "heard"})
    tab.until("document.querySelector('#note').textContent === 'heard'")
    assert not tab.run("document.querySelector('#problem').hidden")
    tab.key("6")
    until(lambda: actor.heard, "the server is asked")
    assert tab.run("document.querySelector('#problem').hidden"), "it does without the browser's"
    tab.key("1")
    assert not tab.run("document.querySelector('#problem').hidden")
    tab.run("loss.restoreContext()")
    tab.until("document.querySelector('#problem').hidden")
    assert share_of_others(another(tab, before * 0), before) == 0


def test_it_connects_again_by_itself(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=SIZE)
    before = picture(tab)
    assert tab.text("#connection .words") == "Live"
    actor.close()
    tab.until("document.querySelector('#connection .words').textContent.startsWith('Connection lost')")
    assert share_of_others(picture(tab), before) == 0, "what there is stays, and can be turned"
    tab.key("ArrowLeft")
    turned = another(tab, before)
    with closing(Actor(actor.scene, actor.port)):
        tab.until("document.querySelector('#connection .words').textContent === 'Live'")
        assert share_of_others(picture(tab), turned) == 0, "and the camera stays where it is"
    refused = [c for c in tab.complaints() if "WebSocket" not in c]  # the browser itself tells of those
    assert refused == []


def test_another_scene_at_the_same_address_is_seen_as_its_text_says(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=SIZE)
    before = picture(tab)
    tab.key("ArrowLeft")
    tab.run("document.querySelector('#param-size-0').focus()")
    turned = another(tab, before)
    tab.key("ArrowRight")
    tab.until("document.querySelector('#reset-all').matches(':not(.unused)')")
    moved = another(tab, turned)
    actor.say({**actor.scene, "id": 2})
    tab.until("document.querySelector('#reset-all').matches(':not(.unused)')")
    assert share_of_others(picture(tab), moved) == 0
    actor.say({**actor.scene, "title": "other.sdf"})
    tab.until("document.querySelector('#reset-all').matches('.unused')")
    tab.until("document.title.startsWith('other.sdf')")
    assert share_of_others(picture(tab), before) == 0


def test_it_asks_for_pictures_that_the_server_can_draw(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=(2600, 400))
    tab.key("6")
    tab.until("document.querySelector('#served-state') !== null")
    for _ in range(3):
        tab.key("ArrowLeft")
    tab.run("new Promise(done => setTimeout(done, 400))")  # longer than a camera must rest
    assert len(actor.heard) == 1, "once, when the camera rests"
    (asked,) = actor.heard
    width, height = asked["size"]
    assert max(width, height) == 1920 and abs(width / height - 2312 / 400) < 0.02
    assert asked["type"] == "draw" and set(asked["params"]) == {"size", "turn", "paint"}
    actor.say({"type": "refused", "request": asked["request"], "text": "not today"})
    tab.until("document.querySelector('#served-state').textContent === 'not today'")


def test_the_servers_picture_is_saved_when_it_is_there(actor: Actor, page: Open, tmp_path: Path) -> None:
    tab = page(actor.url, size=SIZE)
    tab.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    tab.key("6")
    tab.key("s")
    until(lambda: actor.heard, "the server is asked")
    tab.key("ArrowLeft")
    until(lambda: len(actor.heard) == 2, "the server is asked again")
    assert list(tmp_path.iterdir()) == [], "it is drawing"
    drawn = io.BytesIO()
    Image.new("RGB", tuple(actor.heard[1]["size"]), (20, 200, 90)).save(drawn, "png")
    actor.show(actor.heard[1]["request"], drawn.getvalue())
    file = tmp_path / "model-server.png"
    until(lambda: file.exists() and file.read_bytes() == drawn.getvalue(), "what the server drew")
    tab.key("ArrowLeft")
    until(lambda: len(actor.heard) == 3, "the server is asked again")
    tab.key("s")
    actor.say({"type": "refused", "request": actor.heard[2]["request"], "text": "not today"})
    tab.until("document.querySelector('#toast').textContent === 'There is no picture to save'")
    assert list(tmp_path.iterdir()) == [file]


def test_a_picture_that_the_server_cannot_be_asked_for_is_asked_for_later(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=SIZE)
    tab.key("6")
    until(lambda: actor.heard, "the server is asked")
    actor.close()
    tab.until("document.querySelector('#served-state').textContent.startsWith('Connection lost')")
    tab.key("ArrowLeft")
    tab.until("document.querySelector('#served-state').textContent === 'sdfc is drawing…'")
    tab.until("document.querySelector('#served-state').textContent.startsWith('Connection lost')")
    nothing = {"type": "errors", "text": "s.sdf:1:1: error: no", "diagnostics": [{"message": "no"}]}
    with closing(Actor(nothing, actor.port)) as again:  # that has no scene to begin with
        until(lambda: again.heard, "the other one is asked")
        assert again.heard[0]["camera"]["eye"] != actor.heard[0]["camera"]["eye"]
        assert tab.text("#served-state") == "sdfc is drawing…"
    tab.complaints()  # of the connection, by the browser itself


def test_what_is_being_typed_is_left_alone_by_a_save(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=SIZE)
    field, slider = ("document.querySelector('#param-size-0-number').value", "document.querySelector('#param-size-0')")
    tab.run("document.querySelector('#param-size-0-number').select()")
    tab.type("0.7")
    actor.say({"type": "values", "id": 1, "values": {"set_size": [0.3]}})
    tab.until(f"{slider}.value === '0.3'")
    actor.say({**actor.scene, "id": 2})
    tab.until(f"{slider}.value === '0.5'")
    assert tab.run(field) == "0.7"
    tab.key("Enter")
    tab.until(f"{slider}.value === '0.7'")
    actor.say({"type": "values", "id": 2, "values": {"set_size": [0.4]}})
    tab.until(f"{field} === '0.4'")


def test_arrows_are_the_cameras_only_where_nothing_else_takes_them(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=SIZE)
    actor.say({"type": "errors", "text": "s.sdf:1:1: error: no\n" * 40, "diagnostics": [{"message": "no"}]})
    tab.until("!document.querySelector('#problem').hidden")
    eye = copied(tab).eye.numbers
    assert tab.run("(p => p.scrollHeight > p.clientHeight)(document.querySelector('#panel'))")
    for place in ("#problem pre", "#home", "#param-size-0", "#show-bounds"):
        tab.run(f"document.querySelector('{place}').focus()")
        for key in ("Home", "ArrowDown", "ArrowLeft"):
            tab.key(key)
            assert copied(tab).eye.numbers == eye, (place, key)
    for place in ("#view", "#toggle"):
        tab.run(f"document.querySelector('{place}').focus()")
        tab.key("ArrowLeft")
        assert copied(tab).eye.numbers != eye, place
        tab.key("Home")
        assert copied(tab).eye.numbers == eye, place


def test_long_names_and_numbers_are_seen_whole(actor: Actor, page: Open) -> None:
    actor.scene = {**actor.scene, "materials": ["polished_" * 12, "b"], "values": {**actor.scene["values"]}}
    actor.scene["values"]["set_turn"] = [-1.9634954]
    tab = page(actor.url, size=SIZE)
    tab.key("5")
    within = "(e => e.scrollWidth <= e.clientWidth)"
    for place in ("#panel", ".swatches", "#param-turn-0-number"):
        assert tab.run(f"{within}(document.querySelector('{place}'))"), place
    assert len(tab.run("document.querySelector('#param-turn-0-number').value")) >= 6
    assert tab.run("getComputedStyle(document.querySelector('dl div:has(#note)')).display") == "none"


def test_a_scene_that_is_wrong_from_the_start(actor: Actor, browser: Browser) -> None:
    scene = actor.scene
    actor.scene = {"type": "errors", "text": "s.sdf:1:1: error: no", "diagnostics": [{"message": "no"}]}
    tab = browser.open(size=SIZE)
    tab.go(actor.url)
    tab.until("document.querySelector('#problem')?.hidden === false")
    assert tab.run("!document.querySelector('#waiting').hidden")
    for key in ("ArrowLeft", "+", "s", "c", "b", "4", "Home", "1"):
        tab.key(key)
    actor.say(scene)
    tab.until("document.querySelector('#waiting').hidden && document.querySelector('#problem').hidden")
    assert picture(tab).std() > 20
    assert tab.complaints() == []
    tab.close()


FAKE = """import("/pace.js").then(({ Pace }) => {
  const gl = {
    fenceSync: () => ({}), flush: () => {}, deleteSync: () => {}, isContextLost: () => false, getSyncParameter: () => 1,
    SIGNALED: 1,
  };
  const real = performance.now;
  let now = 0;
  performance.now = () => now;
  const pace = new Pace();
  const of = (milliseconds) => {
    for (let i = 0; i < 3; i++) { pace.drew(gl, 1e6); now += milliseconds; pace.isBusy(gl); }
    const size = [1000, 1000];
    return [pace.estimate(1e6), pace.scale(1e6), pace.rows(size), pace.samples(1e6, 8)];
  };
  const found = [1, 20, 100, 400, 1e4].map(of);
  performance.now = real;
  return found;
})"""


def test_a_slow_device_draws_coarser_and_in_smaller_pieces(actor: Actor, page: Open) -> None:
    tab = page(actor.url, size=SIZE)
    measured = tab.run(FAKE)
    for estimate, scale, rows, samples in measured:
        assert scale == 1 or scale == 0.25 or abs(estimate * scale * scale - 30) < 1, "30 ms while it moves"
        assert rows in (1000, 8) or abs(estimate * rows / 1000 - 60) <= estimate / 1000, "60 ms a piece at rest"
        assert 1 <= samples <= 8
    assert [m[0] for m in measured] == [1, 20, 100, 400, 1e4]
    assert measured[0][1:] == [1, 1000, 8]
    assert measured[-1][1:] == [0.25, 8, 1]
