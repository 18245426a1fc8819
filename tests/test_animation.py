"""The animation: layers put together by distance are what one camera sees, the margin is a veil; and its GIF."""

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image

from stepover.errors import InvalidInput
from stepover.report.figures import crossing_times, save_film, style
from stepover.simulation.pybullet import animation
from stepover.simulation.pybullet.animation import crossing_frames
from stepover.simulation.pybullet.client import pybullet
from stepover.simulation.pybullet.video import draw_surroundings, replay, seen, stage

SIZE = (160, 110)


@pytest.fixture(scope="module")
def over(motion):
    """Times at which leg 1, and then leg 2, is over the obstacle."""
    return [float(motion.time[motion.samples(phase)].mean()) for phase in (1, 3)]


def test_layers_are_what_one_camera_sees(motion, robot, over, monkeypatch):
    monkeypatch.setattr(animation, "OPACITY", 0.0)
    monkeypatch.setattr(animation, "HAZE", (100.0, 200.0))
    monkeypatch.setattr(animation, "FINENESS", 1)
    middle = np.array([motion.bare_obstacle[:2].mean(), 0.0, 0.0])
    camera = (middle + animation.EYE).tolist(), (middle + animation.TARGET).tolist(), animation.FIELD_OF_VIEW, SIZE
    with stage() as client:
        draw_surroundings(client, motion, motion.bare_obstacle)
        whole = [seen(client, *camera)[0].copy() for _ in replay(client, motion, np.array(over), robot)]
    layered = crossing_frames(motion, over, SIZE, robot)
    for one, other in zip(whole, layered, strict=True):
        assert (np.abs(one.astype(int) - other) > 1).mean() < 0.001


def test_the_margin_is_a_veil_before_and_not_over_what_is_nearer(motion, robot, over, monkeypatch):
    plain, veiled = [], []
    for opacity, pictures in ((0.0, plain), (animation.OPACITY, veiled)):
        monkeypatch.setattr(animation, "OPACITY", opacity)
        pictures += crossing_frames(motion, [0.0, *over], SIZE, robot)
    changed = [(one != other).any(axis=2) for one, other in zip(plain, veiled, strict=True)]
    assert 200 < changed[0].sum() < 0.1 * changed[0].size
    redder = veiled[0].astype(int) - plain[0]
    assert (redder[changed[0]][:, 0] >= redder[changed[0]][:, 1] - 1).mean() > 0.95
    assert (changed[0] & ~changed[1]).any(), "a leg is before it"
    assert not (changed[1] & ~changed[0]).sum() > 0.05 * changed[0].sum()


def test_film(motion, robot, tmp_path):
    times = crossing_times(motion, rate=5.0)
    lift_off, touch_down = motion.time[motion.samples(1).start], motion.time[motion.samples(3).stop]
    assert lift_off - 1.0 < times[0] < lift_off
    assert touch_down < times[-1] < touch_down + 1.0
    pictures = crossing_frames(motion, times, SIZE, robot)
    film = save_film(motion, pictures, times, tmp_path, "film")
    with Image.open(film) as image:
        assert (image.size, image.n_frames) == (SIZE, len(times))
        assert (image.info["duration"], image.info["loop"]) == (200, 0)
        image.seek(4)
        off = np.abs(np.asarray(image.convert("RGB")).astype(int) - pictures[4])
    assert off[30:].max() <= 12, "a GIF has 256 colours; above them stand time and phase"
    content = film.read_bytes()
    assert save_film(motion, pictures, times, tmp_path, "film").read_bytes() == content
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]
    with pytest.raises(InvalidInput, match="cannot be written"):
        save_film(motion, pictures, times, tmp_path / "missing", "film")


def test_the_legs_have_the_colours_of_the_figures(motion, robot):
    with stage() as client:
        next(replay(client, motion, np.array([0.0]), robot))
        shown = {pybullet.getJointInfo(0, k, client)[1].decode(): k for k in range(pybullet.getNumJoints(0, client))}
        looks = {shape[1]: shape[7][:3] for shape in pybullet.getVisualShapeData(0, physicsClientId=client)}
    for joints, colour in ((robot.legs.left, style.LEFT), (robot.legs.right, style.RIGHT)):
        painted = [looks[shown[joint]] for joint in joints if shown[joint] in looks]
        assert len(painted) >= 3
        assert painted == [pytest.approx(to_rgb(colour), abs=2e-3)] * len(painted)
