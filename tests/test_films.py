"""Films and strips: what they show, that no engine is needed, that they are whole or not there; and GIFs."""

import dataclasses
import subprocess
import sys
from itertools import pairwise

import imageio.v2 as imageio
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image

from stepover.errors import InvalidInput
from stepover.model.support import corners_on_floor
from stepover.report import scene
from stepover.report.figures import style
from stepover.report.render import film
from stepover.report.render.camera import Camera, checked
from stepover.report.render.film import frames, record
from stepover.report.render.gif import crossing_times, save_gif
from stepover.report.render.mesh import Mesh
from stepover.report.render.raster import Window, nearest, seen

SIZE = (320, 240)


@pytest.fixture(scope="module")
def over(motion):
    """Times at which leg 1, and then leg 2, is over the obstacle."""
    return [float(motion.time[motion.samples(phase)].mean()) for phase in (1, 3)]


@pytest.fixture(scope="module")
def standing(motion):
    """The first 0.6 s of the motion, in which it stands still."""
    names = [one.name for one in dataclasses.fields(motion)]
    along = [name for name in names if np.shape(getattr(motion, name))[:1] == motion.time.shape]
    return dataclasses.replace(motion, **{name: getattr(motion, name)[:120] for name in along})


def like(image, colour):
    """Pixels (height, width) with the hue of a colour, whatever the light."""
    pixels = image / np.maximum(image.max(axis=2, keepdims=True), 1.0)
    wanted = np.array(to_rgb(colour)) / max(to_rgb(colour))
    return np.abs(pixels - wanted).max(axis=2) < 0.06


class TestFrames:
    def test_the_feet_are_where_the_motion_says(self, motion, robot):
        """Just above the middle of each sole's outer edge is the foot, in its leg's colour; beside it is the floor."""
        (image,) = frames(motion, [0.0], (640, 480), robot)
        stage = film._Stage(film.Shown(motion, robot), np.array([0.0]))
        camera = Camera.around(stage.extent(), film.TOWARDS, checked((640, 480)))
        edge = corners_on_floor(robot, -1, motion.right_foot[0])
        toe, side = edge[:, 0].max(), edge[:, 1].min()
        on_foot, before_it = camera.project(np.array([[toe - 0.08, side, 0.015], [toe + 0.05, side, 0.0]]))[0].astype(
            int
        )
        assert like(image, style.RIGHT)[on_foot[1], on_foot[0]]
        assert not like(image, style.RIGHT)[before_it[1], before_it[0]]
        rows, columns = np.nonzero(like(image, style.LEFT))
        assert len(rows) > 100
        left_foot = camera.project(motion.left_foot[0, :3])[0]
        assert np.hypot(columns - left_foot[0], rows - left_foot[1]).min() < 30

    def test_obstacle_and_margin(self, motion, robot, over):
        before, above = frames(motion, [0.0, over[0]], SIZE, robot)
        assert (before.shape, before.dtype) == ((240, 320, 3), np.uint8)
        assert like(before, film.AMBER).sum() > 30, "the obstacle's end has no veil before it"
        bare = dataclasses.replace(motion, obstacles=motion.obstacles * [1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0])
        without = frames(bare, [0.0, over[0]], SIZE, robot)[0].astype(int)
        assert like(without, film.AMBER).sum() > 2 * like(before, film.AMBER).sum()
        assert not np.array_equal(before, above)

    def test_all_of_the_robot_is_seen(self, motion, robot, over):
        stage = film._Stage(film.Shown(motion, robot), np.array([*over, 0.0]))
        camera = Camera.around(stage.extent(), film.TOWARDS, checked(SIZE))
        pixels = camera.project(stage.extent())[0]
        assert (pixels > 0.0).all()
        assert (pixels < SIZE).all()

    def test_a_run_shows_what_it_measured(self, motion, robot, over):
        from stepover.simulation.run import simulate

        run = simulate(motion, robot=robot, engine="mujoco", perturb={"obstacle_x": 0.02})
        shown = film.Shown(run, robot)
        assert shown.q is run.series.q
        assert shown.obstacles[0, 0] == pytest.approx(motion.obstacles[0, 0] + 0.02)
        assert shown.obstacles[0, 1:] == pytest.approx(motion.obstacles[0, 1:])
        moved, planned = frames(run, over, SIZE, robot), frames(motion, over, SIZE, robot)
        assert not np.array_equal(moved[0], planned[0])

    def test_obstacles_of_a_course(self, motion):
        rows = np.vstack([motion.obstacles, motion.obstacles + np.array([0.8, 0.1, 0.0, 0.0, 0.0, 0.0, 0.3])])
        solids = {thing.name: thing for thing in scene.obstacles(rows) if isinstance(thing, scene.Solid)}
        assert list(solids) == ["obstacle", "margin/inside", "obstacle 2", "margin 2/inside"]
        corners = solids["obstacle 2"].hulls[0]
        assert np.ptp(corners[:, 2]) == pytest.approx(motion.obstacles[0, 2])
        back = corners - [rows[1, 0], 0.0, 0.0]
        along = back[:, :2] @ [np.cos(0.3), np.sin(0.3)]
        assert [along.min(), along.max()] == pytest.approx([0.0, rows[1, 1]]), "turned to the left about its front face"

    def test_the_same_bytes_twice(self, motion, robot, over):
        one, other = (frames(motion, over, SIZE, robot) for _ in range(2))
        assert [image.tobytes() for image in one] == [image.tobytes() for image in other]

    def test_no_engine_and_no_display(self, standing, tmp_path):
        standing.save(tmp_path / "m.npz")
        code = f"""
import os, sys
os.environ.pop("DISPLAY", None)
sys.modules.update(pybullet=None, mujoco=None)
from stepover import Motion
from stepover.report.render.film import frames, record
motion = Motion.load({str(tmp_path / "m.npz")!r})
assert len(frames(motion, [0.0, 0.3], (64, 48))) == 2
record(motion, {str(tmp_path / "m.mp4")!r}, size=(64, 48))
"""
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        assert (tmp_path / "m.mp4").stat().st_size > 500

    def test_the_command_films_mujoco_without_pybullet(self, standing, tmp_path):
        standing.save(tmp_path / "m.npz")
        code = """
import runpy, sys
sys.modules.update(pybullet=None)
runpy.run_module("stepover", run_name="__main__", alter_sys=True)
"""
        options = ["simulate", tmp_path / "m.npz", "--engine", "mujoco", "--video", tmp_path / "m.mp4"]
        done = subprocess.run([sys.executable, "-c", code, *options], capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")
        assert f"video written to {tmp_path / 'm.mp4'}" in done.stdout
        assert imageio.get_reader(tmp_path / "m.mp4").get_meta_data()["size"] == film.HD

    @pytest.mark.parametrize(("times", "size"), [([], SIZE), ([np.nan], SIZE), ([0.0], (640, 0)), ([0.0], (6.4, 4.8))])
    def test_bad_input(self, motion, robot, times, size):
        with pytest.raises(InvalidInput, match=r"times|size"):
            frames(motion, times, size, robot)

    def test_another_robot(self, motion, robot):
        with pytest.raises(InvalidInput, match="joints"):
            frames(dataclasses.replace(motion, joint_names=motion.joint_names[::-1]), [0.0], SIZE, robot)


class TestJoints:
    @pytest.mark.parametrize("moment", [0, 1])
    def test_no_gap_at_knees_and_ankles(self, motion, robot, over, moment):
        """From the side, all of the way from the thigh over knee and ankle to the sole is covered, by the rods too."""
        sample = round(over[moment] / motion.dt)
        placed, joints = robot.body.placements(motion.q[[sample]]), robot.legs.right
        own = {robot.body.index(joint) for joint in joints}
        thigh, knee, ankle = (placed.positions[0, robot.body.index(joints[k])] for k in (2, 3, 5))
        places = [(thigh + knee) / 2.0, knee, ankle, motion.right_foot[sample, :3] + np.array([0.0, 0.0, 0.01])]
        way = np.vstack([np.linspace(*ends, 100) for ends in pairwise(places)])
        camera = Camera.around(way, (0.0, 1.0, -1e-3), checked(SIZE))
        gaps = []
        for solids in (
            scene.links(robot),
            (solid for solid in scene.links(robot) if not solid.name.endswith("/joints")),
        ):
            corners, distances = camera.project(
                Mesh.of(solid for solid in solids if solid.joint in own).placed(placed, 0).corners
            )
            shape = seen(nearest(corners, distances, Window(0, 0, *SIZE)))
            columns, rows = camera.project(way)[0].astype(int).T
            gaps.append((~shape[rows, columns]).sum())
        assert gaps[0] == 0
        assert gaps[1] > 5

    def test_the_legs_have_the_colours_of_the_figures(self, robot):
        solids = {solid.name: solid.colour for solid in scene.links(robot) if not solid.name.endswith("/joints")}
        for joints, colour in ((robot.legs.left, style.LEFT), (robot.legs.right, style.RIGHT)):
            indices = {robot.body.index(joint) for joint in joints}
            links = {shape.link for shape in robot.shapes if shape.joint in indices}
            assert len(links) == 4
            assert {solids[f"robot/{link}"] for link in links} == {colour}


class TestVideo:
    def test_it_can_be_read(self, standing, robot, tmp_path):
        shares = []
        record(standing, tmp_path / "film.mp4", size=(160, 120), rate=10, robot=robot, progress=shares.append)
        assert [file.name for file in tmp_path.iterdir()] == ["film.mp4"]
        pictures = imageio.mimread(tmp_path / "film.mp4")
        assert len(pictures) == len(shares) == 6
        assert shares[-1] == 1.0
        assert pictures[0].shape == (120, 160, 3)

    def test_the_camera_follows_the_waist(self, motion, robot):
        stage = film._Stage(film.Shown(motion, robot), motion.time[::200])
        cameras = stage.following((320, 180))
        columns = [c.project(motion.waist[200 * k, :3])[0][0] for k, c in enumerate(cameras)]
        assert np.ptp(columns) < 320 / 20
        assert np.ptp([camera.eye[0] for camera in cameras]) > 1.0

    def test_what_cannot_be_written_leaves_nothing(self, standing, robot, tmp_path):
        with pytest.raises(InvalidInput, match="folder"):
            record(standing, tmp_path / "missing" / "film.mp4")
        with pytest.raises(InvalidInput, match="mp4"):
            record(standing, tmp_path / "film.gif")
        with pytest.raises(InvalidInput, match="even"):
            record(standing, tmp_path / "film.mp4", size=(161, 120))

        def stop(share):
            raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            record(standing, tmp_path / "film.mp4", size=(160, 120), robot=robot, progress=stop)
        assert not list(tmp_path.iterdir())


def test_gif(motion, robot, tmp_path):
    times = crossing_times(motion, rate=5.0)
    lift_off, touch_down = motion.time[motion.samples(1).start], motion.time[motion.samples(3).stop]
    assert lift_off - 1.0 < times[0] < lift_off
    assert touch_down < times[-1] < touch_down + 1.0
    pictures = frames(motion, times, (160, 120), robot)
    film = save_gif(motion, pictures, times, tmp_path, "film")
    with Image.open(film) as image:
        assert (image.size, image.n_frames) == ((160, 120), len(times))
        assert (image.info["duration"], image.info["loop"]) == (200, 0)
        image.seek(4)
        off = np.abs(np.asarray(image.convert("RGB")).astype(int) - pictures[4])
    assert off[30:].max() <= 24, "a GIF has 256 colours; above them stand time and phase"
    assert off[30:].mean() < 2.0
    content = film.read_bytes()
    assert save_gif(motion, pictures, times, tmp_path, "film").read_bytes() == content
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]
    with pytest.raises(InvalidInput, match="cannot be written"):
        save_gif(motion, pictures, times, tmp_path / "missing", "film")
