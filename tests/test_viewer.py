"""The 3-D page: what is in it, that it needs no server and no network, and what a real browser makes of it."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import dataclasses
import html
import io
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import time
import urllib.request
import warnings
from importlib import import_module

import imageio.v3 as iio
import numpy as np
import pytest
from tornado.websocket import websocket_connect

from stepover.errors import InvalidInput
from stepover.model import pose
from stepover.report import scene
from stepover.report.render.gif import PHASES

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # meshcat's, about how it imports zmq
    from stepover.report import viewer

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
SHOWN, SCRUBBED, WAIT = 5.1, 6.3, 1.0
FEET = {"left": "robot/LLEG_LINK5", "right": "robot/RLEG_LINK5"}

ASK = """(async () => {
  const drawn = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  const wait = (seconds) => new Promise((done) => setTimeout(done, 1e3 * seconds)).then(drawn);
  const sole = (path) => {
    const link = viewer.scene_tree.find(["meshcat", ...path.split("/")]).object;
    link.updateWorldMatrix(true, false);
    const {x, y, z} = link.localToWorld(new MeshCat.THREE.Vector3(0, 0, -ANKLE));
    return [x, -z, y];
  };
  const state = () => ({soles: FEET.map(sole), clock: clock.textContent, scrub: Number(scrub.value),
                        label: play.textContent, phase: phase.textContent});
  const report = {};
  await wait(0.2);
  report.shown = state();
  report.picture = viewer.capture_image();
  scrub.value = SCRUBBED;
  scrub.dispatchEvent(new Event("input"));
  await wait(0.2);
  report.scrubbed = state();
  play.click();
  await wait(WAIT);
  report.playing = state();
  play.click();
  await wait(0.2);
  report.paused = state();
  await wait(0.2);
  report.later = state();
  report.trouble = document.getElementById("trouble").textContent;
  report.controls = getComputedStyle(document.querySelector(".dg.main")).display;
  report.loaded = performance.getEntriesByType("resource").map((entry) => entry.name);
  return report;
})()"""


@pytest.fixture(scope="module")
def page(robot, motion):
    return viewer.page(robot, motion, SHOWN)


@pytest.fixture(scope="module")
def commands(page):
    """What the page tells meshcat's viewer."""
    packed = json.loads(re.search(r"for \(const command of (\[.*\])\)", page)[1])
    return [import_module("umsgpack").unpackb(base64.b64decode(command)) for command in packed]


def corners(commands, name):
    """Corners (V, 3) of what stands in the page under a name."""
    (found,) = (c for c in commands if c["type"] == "set_object" and c["path"] == f"/meshcat/{name}")
    packed = found["object"]["geometries"][0]["data"]["attributes"]["position"]["array"]
    return np.frombuffer(packed.data, dtype=np.float32).reshape(-1, 3)


def sole_at(motion, foot, moment):
    """Where the motion has a sole (3,) at a moment."""
    return getattr(motion, f"{foot}_foot")[round((moment - motion.time[0]) / motion.dt), :3]


class TestPage:
    def test_everything_is_there_once(self, robot, motion, commands):
        paths = [c["path"] for c in commands if c["type"] == "set_object"]
        assert len(paths) == len(set(paths))
        for name in (
            "floor/0",
            "obstacle",
            "margin/inside",
            "soles/left 0",
            "CoM/way",
            "CoM/now",
            "ZMP/way",
            "ZMP/now",
        ):
            assert any(path.startswith(f"/meshcat/{name}") for path in paths), name
        links = [path.split("/")[3:] for path in paths if path.startswith("/meshcat/robot/")]
        assert {link[0] for link in links if len(link) == 1} == {shape.link for shape in robot.shapes}
        assert [link[1:] for link in links if link[0] == "RLEG_LINK3"] == [[], ["joints"]]
        assert sum(path.endswith("/inside") and "soles" in path for path in paths) == 2 + len(motion.footsteps)

    def test_obstacle_and_margin_are_as_large_as_the_motion_says(self, motion, commands):
        front, width, height, beside, above = motion.obstacle[:5]
        bare, safe = corners(commands, "obstacle"), corners(commands, "margin/inside")
        assert bare.min(axis=0)[[0, 2]] == pytest.approx([front, 0.0])
        assert bare.max(axis=0)[[0, 2]] == pytest.approx([front + width, height])
        assert safe.min(axis=0)[[0, 2]] == pytest.approx([front - beside, 0.0])
        assert safe.max(axis=0)[[0, 2]] == pytest.approx([front + width + beside, height + above])

    def test_traces_end_where_the_motion_does(self, motion, commands):
        for name, way in (("CoM", motion.com), ("ZMP", motion.zmp), ("CoM's projection", motion.com[:, :2])):
            trace = corners(commands, f"{name}/way")
            assert trace[[0, -1], : way.shape[1]] == pytest.approx(way[[0, -1]], abs=1e-6), name
            assert np.linalg.norm(np.diff(trace, axis=0), axis=1).max() < scene.TRACE, name

    def test_the_same_motion_gives_the_same_page(self, robot, motion, page):
        assert viewer.page(robot, motion, SHOWN) == page

    def test_title_and_size(self, page):
        assert "<title>hrp2 steps over an obstacle 15 cm high, 5 cm wide</title>" in page
        assert len(page) < 3e6

    def test_neither_process_nor_port(self, robot, motion, page, monkeypatch):
        monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: pytest.fail("a process"))
        monkeypatch.setattr(socket, "socket", lambda *_, **__: pytest.fail("a port"))
        assert viewer.page(robot, motion, SHOWN) == page

    def test_nothing_is_loaded(self, page):
        own = re.sub(r"<script\b.*?</script>", "", page, flags=re.DOTALL)
        assert not re.search(r"""src\s*=|href\s*=|url\(|@import|https?:""", own)
        assert own.index("default-src 'none'") < own.index("<title>")
        programs = "".join(re.findall(r"<script>.*?</script>", page, flags=re.DOTALL))
        assert set(re.findall(r"https?://[\w./]+", programs)) == {"http://www.w3.org/1999/xhtml"}, "a name, not a place"

    def test_the_licences_of_what_it_carries_are_in_it(self, page):
        assert "Copyright (c) 2018 Robin Deits" in page
        assert "Three.js Authors" in page

    def test_a_motion_without_margins(self, robot, motion, commands):
        bare = dataclasses.replace(motion, obstacles=motion.obstacles * [1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0])
        names = [thing.name for thing in scene.surroundings(robot, bare)]
        assert "obstacle" in names
        assert not any(name.startswith("margin") for name in names)

    @pytest.mark.parametrize("moment", [-0.01, 99.0, float("nan")])
    def test_a_time_outside_the_motion(self, robot, motion, moment):
        with pytest.raises(InvalidInput, match=r"from 0\.00 s to 11\.\d\d s"):
            viewer.page(robot, motion, moment)

    def test_a_motion_that_begins_later(self, robot, motion):
        later = dataclasses.replace(motion, time=motion.time + 2.0)
        assert "(2.0 + animator.time)" in viewer.page(robot, later)
        assert "seek(0.0)" in viewer.page(robot, later)

    def test_a_motion_of_another_robot(self, robot, motion):
        other = dataclasses.replace(motion, joint_names=motion.joint_names[::-1], robot="hrp3")
        with pytest.raises(InvalidInput, match="hrp3"):
            viewer.page(robot, other)


class TestScene:
    def test_soles_lie_where_the_feet_stand(self, motion):
        for side in (1, -1):
            steps = motion.footsteps.of_side(side)
            samples = [0, *np.round(steps.time / motion.dt).astype(int)]
            assert scene.soles(motion, side)[:, :3] == pytest.approx(motion.foot(side)[samples, :3], abs=1e-6)

    def test_feet_move_as_the_motion_says(self, robot, motion):
        times, moves = scene.moves(robot, motion)
        assert (times[0], times[-1]) == (0.0, pytest.approx(motion.time[-1]))
        assert np.diff(times).max() == pytest.approx(1.0 / scene.RATE)
        for foot, name in FEET.items():
            sole = pose.offset(np.column_stack(moves[name]), [0.0, 0.0, -robot.foot.ankle_height])
            expected = np.array([sole_at(motion, foot, moment) for moment in times])
            assert sole[:, :3] == pytest.approx(expected, abs=2e-4)
            assert np.abs(np.diff(moves[name].quaternions, axis=0)).max() < 0.2, "no sign jumps"

    def test_between_the_poses_nothing_is_off_by_much(self, robot, motion):
        times, moves = scene.moves(robot, motion)
        for foot, name in FEET.items():
            exact = pose.offset(getattr(motion, f"{foot}_foot"), [0.0, 0.0, robot.foot.ankle_height])[:, :3]
            shown = np.column_stack([np.interp(motion.time, times, column) for column in moves[name].positions.T])
            assert np.abs(shown - exact).max() < 1e-3

    def test_evenly(self):
        way = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.01, 0.0]])
        points = scene.evenly(way, 0.1)
        assert points[[0, -1]] == pytest.approx(way[[0, -1]])
        assert len(points) == 12
        assert scene.evenly(way[:2], 0.1) == pytest.approx(way[:1])


class TestFiles:
    def test_saved(self, robot, motion, page, tmp_path):
        viewer.save_page(robot, motion, tmp_path / "m.html", SHOWN)
        assert (tmp_path / "m.html").read_text(encoding="utf-8") == page
        assert os.listdir(tmp_path) == ["m.html"]

    def test_nowhere_to_write(self, robot, motion, tmp_path):
        with pytest.raises(InvalidInput, match="cannot be written"):
            viewer.save_page(robot, motion, tmp_path / "nowhere" / "m.html")

    def test_interrupted_while_writing(self, robot, motion, tmp_path, monkeypatch):
        def interrupt(*_):
            raise KeyboardInterrupt

        path = tmp_path / "m.html"
        path.write_text("old")
        monkeypatch.setattr(os, "replace", interrupt)
        with pytest.raises(KeyboardInterrupt):
            viewer.save_page(robot, motion, path)
        assert (os.listdir(tmp_path), path.read_text()) == (["m.html"], "old")

    def test_inline(self, robot, motion, page):
        shown = viewer.show(robot, motion, SHOWN, height=300)
        frame = re.fullmatch(r'<iframe srcdoc="([^"]*)" style="([^"]*)"></iframe>', shown._repr_html_())
        assert html.unescape(frame[1]) == page
        assert "height: 300px" in frame[2]
        assert len(repr(shown)) < 100, "the page once, not again as text"


@contextlib.contextmanager
def chromium(folder):
    """A headless Chromium without a network; yields where its first page can be told what to do."""
    options = [
        "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", f"--user-data-dir={folder}",
        "--window-size=1280,720", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
        "--host-resolver-rules=MAP * ~NOTFOUND", "--remote-debugging-port=0", "about:blank",
    ]  # fmt: skip
    with subprocess.Popen([CHROMIUM, *options], stderr=subprocess.DEVNULL, start_new_session=True) as process:
        try:
            yield first_page(folder)
        finally:
            os.killpg(process.pid, signal.SIGKILL)


def first_page(folder, patience=60.0):
    """Address of the first page of the Chromium that has its profile in a folder, once it answers."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        with contextlib.suppress(OSError, IndexError, StopIteration):
            port = int((folder / "DevToolsActivePort").read_text().splitlines()[0])
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list", timeout=patience) as answer:
                return next(page["webSocketDebuggerUrl"] for page in json.load(answer) if page["type"] == "page")
        time.sleep(0.1)
    raise AssertionError("Chromium does not answer")


async def visit(address, url, expression):
    """Open a page and evaluate an expression in it: its value, and the errors that came up meanwhile."""
    connection = await websocket_connect(address, max_message_size=2**26)
    events = []

    async def tell(method, **parameters):
        await connection.write_message(json.dumps({"id": 1, "method": method, "params": parameters}))
        while True:
            message = json.loads(await asyncio.wait_for(connection.read_message(), 60))
            if "id" in message:
                assert "exceptionDetails" not in message.get("result", message), message
                return message["result"]
            events.append(message)

    for domain in ("Runtime", "Log", "Page"):
        await tell(f"{domain}.enable")
    await tell("Page.navigate", url=url)
    while not any(event["method"] == "Page.loadEventFired" for event in events):
        await tell("Runtime.evaluate", expression="1")
    result = await tell("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
    bad = [e for e in events if e["method"] == "Runtime.exceptionThrown" or is_error(e)]
    return result["result"]["value"], bad


def is_error(event):
    """Whether the console shows it as an error."""
    return event["method"] == "Log.entryAdded" and event["params"]["entry"]["level"] == "error"


@pytest.fixture(scope="module")
def report(robot, page, tmp_path_factory):
    """What the page says of itself in a browser while it is shown, scrubbed, played and paused."""
    if CHROMIUM is None:
        pytest.skip("no Chromium here; Debian's package is chromium")
    folder = tmp_path_factory.mktemp("browser")
    (folder / "m.html").write_text(page, encoding="utf-8")
    values = {"FEET": list(FEET.values()), "ANKLE": robot.foot.ankle_height, "SCRUBBED": SCRUBBED, "WAIT": WAIT}
    question = re.sub("|".join(values), lambda name: json.dumps(values[name[0]]), ASK)
    with chromium(folder) as address:
        answer, errors = asyncio.run(visit(address, (folder / "m.html").as_uri(), question))
    return answer | {"errors": errors}


class TestBrowser:
    def test_no_trouble_and_no_fetches(self, report):
        assert (report["errors"], report["trouble"], report["loaded"]) == ([], "", [])

    @pytest.mark.parametrize(("state", "moment"), [("shown", SHOWN), ("scrubbed", SCRUBBED)])
    def test_the_robot_is_where_it_is_then(self, report, motion, state, moment):
        assert report[state]["clock"] == f"{moment:.2f} s"
        assert report[state]["scrub"] == pytest.approx(moment, abs=1e-3)
        for sole, foot in zip(report[state]["soles"], FEET, strict=True):
            assert sole == pytest.approx(sole_at(motion, foot, moment), abs=1e-3)

    @pytest.mark.parametrize(("state", "moment"), [("shown", SHOWN), ("scrubbed", SCRUBBED)])
    def test_the_phase_is_named(self, report, motion, state, moment):
        number = motion.phase[round((moment - motion.time[0]) / motion.dt)]
        assert number in (1, 3)
        assert report[state]["phase"] == PHASES[number]

    def test_the_viewers_own_controls_are_hidden(self, report):
        assert report["controls"] == "none"

    def test_play_and_pause(self, report, motion):
        assert [report[state]["label"] for state in ("shown", "scrubbed", "playing", "paused")] == [
            "play", "play", "pause", "play",
        ]  # fmt: skip
        assert 0.2 * WAIT < report["playing"]["scrub"] - SCRUBBED < 3.0 * WAIT
        assert report["later"] == report["paused"]
        for sole, foot in zip(report["paused"]["soles"], FEET, strict=True):
            assert sole == pytest.approx(sole_at(motion, foot, report["paused"]["scrub"]), abs=1e-2)

    def test_the_picture(self, report):
        picture = iio.imread(io.BytesIO(base64.b64decode(report["picture"].split(",")[1])))[..., :3].astype(int)
        red, green, blue = picture.transpose(2, 0, 1)
        assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 300
        share = {
            "left": (red > green + 40) & (blue > green + 20),
            "right": (blue > red + 80) & (green > red + 40),
            "CoM": (red > blue + 120) & (green > blue + 80),
            "ZMP": (blue > red + 80) & (red < 40),
        }
        for name, pixels in share.items():
            assert pixels.mean() > 1e-4, name
        assert share["left"].mean() > 5e-3
        assert share["right"].mean() > 5e-3

    @pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here; Debian's package is chromium")
    def test_twice_in_one_notebook(self, robot, motion, tmp_path):
        frames = [viewer.show(robot, motion, moment)._repr_html_() for moment in (SHOWN, SCRUBBED)]
        (tmp_path / "two.html").write_text(f"<!DOCTYPE html><body>{''.join(frames)}", encoding="utf-8")
        question = """[...document.querySelectorAll("iframe")].map((frame) => {
          const shown = frame.contentDocument;
          return [shown.getElementById("clock").textContent, shown.querySelectorAll("canvas").length > 0,
                  shown.getElementById("trouble").textContent];
        })"""
        with chromium(tmp_path) as address:
            answer, errors = asyncio.run(visit(address, (tmp_path / "two.html").as_uri(), question))
        assert errors == []
        assert answer == [[f"{SHOWN:.2f} s", True, ""], [f"{SCRUBBED:.2f} s", True, ""]]
