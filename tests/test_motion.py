"""motion/: the file is what DESIGN promises, a round trip keeps everything, nothing broken is read or left behind."""

from __future__ import annotations

import copy
import csv
import dataclasses
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest
from conftest import HRP2, as_toml

import stepover.motion.motion
from stepover import CorruptMotion, InvalidInput, Motion, load_robot, simulate
from stepover.motion import formats
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.motion.formats.npz import SHAPES
from stepover.motion.motion import obstacle_row
from stepover.report import viewer

SCALARS = ("robot", "robot_fingerprint", "planner", "format", "version")
ARRAYS = [key for key in SHAPES if key not in SCALARS]
FORMAT_1 = Path(__file__).parent / "files" / "format_1.npz"
# key, columns (None: one dimension; (): a scalar), kind of type: the promise to whoever reads the file with numpy
TABLE = {
    "time": (None, "f"), "q": (37, "f"), "left_foot": (7, "f"), "right_foot": (7, "f"), "waist": (7, "f"),
    "com": (3, "f"), "zmp_reference": (2, "f"), "zmp_first_stage": (2, "f"), "zmp": (2, "f"),
    "support": (None, "i"), "phase": (None, "i"),
}  # fmt: skip


@pytest.fixture(scope="module")
def file(motion, tmp_path_factory):
    """The 15 cm motion on disk."""
    path = tmp_path_factory.mktemp("motion") / "m.npz"
    motion.save(path)
    return path


@pytest.fixture
def contents(file):
    """Its arrays, to be spoilt."""
    with np.load(file) as archive:
        return {key: archive[key] for key in archive.files}


@pytest.fixture
def spoilt(contents, tmp_path):
    """Write the arrays with changes and load them again; None drops a key."""

    def load(**changes):
        arrays = {key: value for key, value in (contents | changes).items() if value is not None}
        path = tmp_path / "spoilt.npz"
        np.savez(path, **arrays)
        with pytest.raises(CorruptMotion) as caught:
            Motion.load(path)
        assert str(path) in str(caught.value)
        assert "\n" not in str(caught.value)
        return str(caught.value)

    return load


@pytest.fixture
def spoilt_robot(tmp_path, robot_table):
    """HRP-2 with changes in its robot.toml."""

    def make(changes):
        table = copy.deepcopy(robot_table) | {"urdf": str(HRP2 / robot_table["urdf"])}
        for (*above, key), value in changes.items():
            place = table
            for name in above:
                place = place.setdefault(name, {})
            place[key] = value
        (tmp_path / "robot.toml").write_text(as_toml(table))
        return load_robot(tmp_path / "robot.toml")

    return make


def array(motion, name):
    """An array of a motion as its file holds it."""
    return motion.footsteps.rows() if name == "footsteps" else getattr(motion, name)


def test_round_trip(motion, file):
    again = Motion.load(file)
    for name in ARRAYS:
        np.testing.assert_array_equal(array(again, name), array(motion, name))
        assert array(again, name).dtype == array(motion, name).dtype
    for name in ("robot", "robot_fingerprint", "planner", "version"):
        assert getattr(again, name) == getattr(motion, name)
    assert again.footsteps.kind.dtype == motion.footsteps.kind.dtype
    assert again.hash() == motion.hash()


def test_numpy_alone_reads_the_promised_keys_shapes_and_types(robot, file):
    with np.load(file, allow_pickle=False) as archive:
        arrays = {key: archive[key] for key in archive.files}
    count = len(arrays["time"])
    for key, (columns, kind) in TABLE.items():
        assert arrays[key].shape == ((count,) if columns is None else (count, columns)), key
        assert arrays[key].dtype.kind == kind, key
    assert arrays["joint_names"].shape == (30,)
    assert arrays["joint_names"].dtype.kind == "U"
    assert arrays["footsteps"].shape == (7, 6)
    assert arrays["key_configuration"].shape == (3,)
    assert arrays["obstacle"].shape == (6,)
    assert arrays["obstacles"].shape == (1, 7)
    np.testing.assert_array_equal(arrays["obstacles"][0], [*arrays["obstacle"], 0.0])
    scalars = {key: arrays[key] for key in SCALARS}
    assert all(value.shape == () for value in scalars.values())
    assert scalars["robot"].item() == "hrp2"
    assert scalars["robot_fingerprint"].item() == robot.fingerprint
    assert scalars["planner"].item() == "paper"
    assert scalars["format"].item() == 2
    assert scalars["version"].item() == stepover.__version__
    others = {"joint_names", "footsteps", "key_configuration", "obstacle", "obstacles", *scalars}
    assert set(arrays) == set(TABLE) | others
    np.testing.assert_allclose(np.diff(arrays["time"]), 0.005)
    assert set(np.unique(arrays["support"])) == {-1, 0, 1}
    assert set(np.unique(arrays["phase"])) == {0, 1, 2, 3}


def test_small_helpers(motion):
    assert motion.dt == pytest.approx(0.005)
    assert motion.foot(1) is motion.left_foot
    assert motion.foot(-1) is motion.right_foot
    for phase in (1, 2, 3):
        inside = motion.samples(phase)
        assert (motion.phase[inside] == phase).all()
        assert (motion.phase == phase).sum() == inside.stop - inside.start


def test_hash_sees_a_micrometre_and_no_rounding_noise(motion):
    noise = dataclasses.replace(motion, q=motion.q + 1e-12)
    moved = motion.q.copy()
    moved[5, 0] += 2e-6
    assert dataclasses.replace(motion, q=moved).hash() != motion.hash()
    zero = dataclasses.replace(motion, q=np.zeros((3, 37)))
    assert zero.hash() == dataclasses.replace(motion, q=-np.zeros((3, 37))).hash()
    assert len(noise.hash()) == 64


def test_saving_over_a_file_replaces_it(motion, tmp_path):
    path = tmp_path / "m.npz"
    path.write_bytes(b"old")
    motion.save(path)
    assert Motion.load(path).hash() == motion.hash()
    assert [p.name for p in tmp_path.iterdir()] == ["m.npz"]


def test_any_file_name_is_kept(motion, tmp_path):
    motion.save(tmp_path / "crossing")
    assert Motion.load(tmp_path / "crossing").hash() == motion.hash()


@pytest.mark.parametrize("share", [0.001, 0.1, 0.5, 0.9, 0.999, "last"])
def test_cut_short(file, tmp_path, share):
    whole = file.read_bytes()
    path = tmp_path / "cut.npz"
    path.write_bytes(whole[:-1] if share == "last" else whole[: int(share * len(whole))])
    with pytest.raises(CorruptMotion, match=r"cut\.npz is not a complete motion file"):
        Motion.load(path)


def test_every_cut_is_refused(file, tmp_path):
    whole, path = file.read_bytes(), tmp_path / "cut.npz"
    for length in np.random.default_rng(1).integers(0, len(whole), 60):
        path.write_bytes(whole[:length])
        with pytest.raises(CorruptMotion):
            Motion.load(path)


def test_changed_bytes_are_refused_or_harmless(file, motion, tmp_path):
    """Flipped bytes anywhere: either it says so, or they were in no data (then every array is the same)."""
    whole, path = file.read_bytes(), tmp_path / "flipped.npz"
    rng, refused = np.random.default_rng(2), []
    for _ in range(60):
        broken = bytearray(whole)
        for at in rng.integers(0, len(whole), 3):
            broken[at] ^= int(rng.integers(1, 256))
        path.write_bytes(broken)
        try:
            again = Motion.load(path)
        except CorruptMotion as error:
            refused.append(str(error))
        else:
            for name in ARRAYS:
                np.testing.assert_array_equal(array(again, name), array(motion, name))
    assert len(refused) > 40
    assert all("flipped.npz" in message and "\n" not in message for message in refused)


@pytest.mark.parametrize("content", [b"", b"\x00" * 100, os.urandom(5000), b"PK\x03\x04" + os.urandom(200), b"x = 1\n"],
                         ids=["empty", "zeros", "random", "zip", "text"])  # fmt: skip
def test_what_is_no_motion(tmp_path, content):
    path = tmp_path / "no.npz"
    path.write_bytes(content)
    with pytest.raises(CorruptMotion, match=r"no\.npz is not a complete motion file"):
        Motion.load(path)


def test_an_array_alone_is_no_motion(tmp_path):
    np.save(tmp_path / "alone.npy", np.zeros(3))
    with pytest.raises(CorruptMotion, match=r"alone\.npy"):
        Motion.load(tmp_path / "alone.npy")


def test_another_zip_is_no_motion(tmp_path):
    with zipfile.ZipFile(tmp_path / "other.npz", "w") as archive:
        archive.writestr("readme.txt", "hello")
    with pytest.raises(CorruptMotion, match=r"other\.npz"):
        Motion.load(tmp_path / "other.npz")


def test_pickles_are_not_opened(contents, tmp_path):
    path = tmp_path / "pickle.npz"
    np.savez(path, **(contents | {"joint_names": np.array([print, len], dtype=object)}))
    with pytest.raises(CorruptMotion, match=r"pickle\.npz"):
        Motion.load(path)


@pytest.mark.parametrize("key", [key for key in SHAPES if key not in ("zmp_first_stage", "key_configuration")])
def test_a_missing_key_is_named(spoilt, key):
    assert f"lacks {key}" in spoilt(**{key: None})


@pytest.mark.parametrize("key", [key for key in ARRAYS if key not in ("joint_names", "support", "phase")])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_values_that_are_not_finite_are_named(spoilt, contents, key, value):
    array = contents[key].copy()
    array.flat[array.size // 2] = value
    message = spoilt(**{key: array})
    assert key in message
    assert "not finite" in message


@pytest.mark.parametrize("key", ARRAYS)
def test_wrong_shapes_are_named(spoilt, contents, key):
    array = contents[key]
    assert key in spoilt(**{key: array[None]})
    if array.ndim > 1:
        assert key in spoilt(**{key: array[:, :-1]})
    if key not in ("footsteps", "time", "obstacles"):
        assert "shape" in spoilt(**{key: array[:-1]}) or "columns" in spoilt(**{key: array[:-1]})


@pytest.mark.parametrize("key", ["q", "time", "com", "support", "format"])
def test_wrong_types_are_named(spoilt, contents, key):
    assert key in spoilt(**{key: contents[key].astype(str)})


def test_numbers_for_names_are_refused(spoilt):
    assert "joint_names" in spoilt(joint_names=np.arange(30.0))
    assert "robot" in spoilt(robot=np.array(3))


def test_time_must_be_uniform(spoilt, contents):
    time = contents["time"].copy()
    time[1000:] += 0.003
    assert "time is not uniform" in spoilt(time=time)
    assert "time is not uniform" in spoilt(time=contents["time"][::-1])
    assert "time is not uniform" in spoilt(time=np.zeros_like(contents["time"]))


def test_another_format_is_refused(spoilt):
    assert "format 3" in spoilt(format=np.array(3))
    assert "format 0" in spoilt(format=np.array(0))


def test_quaternions_must_have_unit_length(spoilt, contents):
    for key in ("left_foot", "right_foot", "waist"):
        poses = contents[key].copy()
        poses[7, 3:] *= 1.1
        assert key in spoilt(**{key: poses})


def test_waist_and_q_must_agree(spoilt, contents):
    waist = contents["waist"].copy()
    waist[:, 0] += 0.01
    assert "waist and q disagree" in spoilt(waist=waist)


def test_an_obstacle_has_sizes(spoilt, contents):
    for index in (1, 2):
        rows = contents["obstacles"].copy()
        rows[0, index] = -rows[0, index]
        assert "no positive width and height" in spoilt(obstacle=rows[0, :6], obstacles=rows)


def test_a_single_sample_is_no_motion(spoilt, contents):
    one = {key: value[:1] for key, value in contents.items() if value.ndim and len(value) == len(contents["time"])}
    assert "time" in spoilt(**one)
    none = {key: value[:0] for key, value in one.items()}
    assert "time" in spoilt(**none)


def test_unknown_members_are_refused(spoilt):
    assert "unknown members, such as 'note'" in spoilt(note=np.array("mine"))


def test_a_file_that_is_not_there_is_bad_input(tmp_path):
    for path in (tmp_path / "nowhere.npz", tmp_path):
        with pytest.raises(InvalidInput, match=path.name):
            Motion.load(path)


@pytest.mark.parametrize("write", ["save", "save_csv"])
def test_a_missing_folder_is_bad_input_and_stays_missing(motion, tmp_path, write):
    path = tmp_path / "no" / "such" / "m.npz"
    with pytest.raises(InvalidInput, match="cannot be written: No such file or directory"):
        getattr(motion, write)(path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("write", ["save", "save_csv"])
def test_a_folder_in_the_files_place_is_bad_input(motion, tmp_path, write):
    (tmp_path / "m.npz").mkdir()
    with pytest.raises(InvalidInput, match=r"m\.npz cannot be written"):
        getattr(motion, write)(tmp_path / "m.npz")
    assert [p.name for p in tmp_path.iterdir()] == ["m.npz"]


@pytest.mark.parametrize("write", ["save", "save_csv"])
@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()], ids=["disk", "user"])
def test_writing_that_fails_midway_leaves_the_old_file_and_nothing_else(motion, tmp_path, monkeypatch, write, failure):
    path = tmp_path / "m.npz"
    path.write_bytes(b"old")
    opened = open

    def fragile(*args, **kwargs):
        file = opened(*args, **kwargs)
        real, count = file.write, iter(range(3))

        def fail(data):
            real(data)
            if next(count, None) is None:
                raise failure
            return len(data)

        return Fragile(file, fail)

    monkeypatch.setattr(stepover.output, "open", fragile, raising=False)
    with pytest.raises((InvalidInput, KeyboardInterrupt)):
        getattr(motion, write)(path)
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["m.npz"]


class Fragile:
    """A file whose disk fills up."""

    def __init__(self, file, write):
        self._file, self.write = file, write

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._file.close()

    def __getattr__(self, name):
        return getattr(self._file, name)


def test_csv_holds_the_motion_sample_by_sample(motion, tmp_path):
    motion.save_csv(tmp_path / "m.csv")
    with open(tmp_path / "m.csv", newline="") as file:
        rows = list(csv.reader(file))
    header, table = rows[0], np.array(rows[1:], dtype=float)
    assert len(set(header)) == len(header) == table.shape[1]
    assert len(table) == len(motion.time)

    def columns(*names):
        return table[:, [header.index(name) for name in names]]

    np.testing.assert_allclose(columns("time")[:, 0], motion.time, atol=1e-8)
    np.testing.assert_allclose(columns("com_x", "com_y", "com_z"), motion.com, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(columns("zmp_x", "zmp_y"), motion.zmp, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(columns("zmp_reference_x", "zmp_reference_y"), motion.zmp_reference, rtol=1e-8)
    for name in ("waist", "left_foot", "right_foot"):
        own = columns(*(f"{name}_{axis}" for axis in ("x", "y", "z", "qx", "qy", "qz", "qw")))
        np.testing.assert_allclose(own, getattr(motion, name), rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(columns(*motion.joint_names), motion.q[:, 7:], rtol=1e-8, atol=1e-9)
    assert [p.name for p in tmp_path.iterdir()] == ["m.csv"]


# Formats


def test_what_only_algorithm_1_knows_may_be_missing(motion, tmp_path):
    plain = dataclasses.replace(motion, zmp_first_stage=None, key_configuration=None, phase=np.zeros_like(motion.phase))
    plain.save(tmp_path / "m.npz")
    with np.load(tmp_path / "m.npz") as archive:
        assert {"zmp_first_stage", "key_configuration"} & set(archive.files) == set()
    again = Motion.load(tmp_path / "m.npz")
    assert (again.zmp_first_stage, again.key_configuration, again.has_phases) == (None, None, False)
    assert again.hash() == motion.hash()


def test_a_motion_may_hold_several_obstacles(motion, tmp_path):
    rows = np.array([motion.obstacles[0], motion.obstacles[0] + [2.0, 0.01, 0.02, 0.0, 0.0, 0.0, 0.1]])
    dataclasses.replace(motion, obstacles=rows).save(tmp_path / "m.npz")
    again = Motion.load(tmp_path / "m.npz")
    np.testing.assert_array_equal(again.obstacles, rows)
    np.testing.assert_array_equal(again.obstacle, rows[0, :6])
    front, width, height, beside, above = rows[1, :5]
    expected = [front - beside, front + width + beside, height + above]
    np.testing.assert_allclose(again.profile(1, margins=True)[[0, 1, 3]], expected)


def test_obstacles_that_contradict_themselves(spoilt, contents):
    rows = contents["obstacles"]
    assert "first row" in spoilt(obstacle=contents["obstacle"] + 0.1)
    assert "obstacle" in spoilt(obstacles=rows[:0])
    for column, value in ((3, -0.01), (4, -0.01), (6, 1.6)):
        changed = rows.copy()
        changed[0, column] = value
        assert "negative margin or extent, or is turned" in spoilt(obstacle=changed[0, :6], obstacles=changed)


def test_the_obstacle_of_a_planner_is_the_row(obstacle, motion):
    np.testing.assert_array_equal(obstacle_row(obstacle, motion.obstacle[0]), motion.obstacles[0])


def test_phases_supports_and_footsteps_exist(spoilt, contents):
    phase = contents["phase"]
    assert "phase" in spoilt(phase=np.where(phase == 2, 0, phase))
    assert "phase" in spoilt(phase=np.full_like(phase, 3))
    assert "end with 0" in spoilt(phase=np.where(np.arange(len(phase)) == len(phase) - 1, 3, phase))
    assert "support" in spoilt(support=contents["support"] + 1)
    for column, value in ((1, 0.0), (5, 7.0)):
        rows = contents["footsteps"].copy()
        rows[0, column] = value
        assert "footsteps" in spoilt(footsteps=rows)


def test_a_member_that_is_no_array_is_refused(file, tmp_path):
    path = tmp_path / "m.npz"
    with zipfile.ZipFile(file) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            new.writestr(name, b"hello" if name == "com.npy" else old.read(name))
    with pytest.raises(CorruptMotion, match="not a complete motion file"):
        Motion.load(path)


def test_a_file_of_format_1_loads(tmp_path):
    with np.load(FORMAT_1) as archive:
        old = {key: archive[key] for key in archive.files}
    assert old["format"].item() == 1
    again = Motion.load(FORMAT_1)
    np.testing.assert_array_equal(again.obstacles, [[*old["obstacle"], 0.0]])
    np.testing.assert_array_equal(again.footsteps.rows(), old["footsteps"])
    assert (again.robot, again.robot_fingerprint, again.planner) == ("hrp2", "", "")
    for key in set(old) - {"footsteps", "robot", "format", "version"}:
        np.testing.assert_array_equal(getattr(again, key), old[key])
    again.save(tmp_path / "new.npz")
    assert Motion.load(tmp_path / "new.npz").hash() == again.hash()
    np.savez(tmp_path / "short.npz", **{key: value for key, value in old.items() if key != "zmp_first_stage"})
    with pytest.raises(CorruptMotion, match="lacks zmp_first_stage"):
        Motion.load(tmp_path / "short.npz")


def test_formats_are_found_in_their_folder(motion, tmp_path):
    assert formats.known() == ["csv", "npz"]
    motion.export(tmp_path / "m.csv", "csv")
    motion.save_csv(tmp_path / "same.csv")
    assert (tmp_path / "m.csv").read_bytes() == (tmp_path / "same.csv").read_bytes()
    motion.export(str(tmp_path / "m.npz"), "npz")
    assert Motion.load(tmp_path / "m.npz").hash() == motion.hash()
    with pytest.raises(InvalidInput, match=r"unknown format 'gif': known are csv, npz"):
        motion.export(tmp_path / "m.gif", "gif")


def test_a_new_exporter_is_one_new_file(motion, tmp_path, monkeypatch):
    (tmp_path / "toy_text.py").write_text(
        "def export(motion, path):\n    path.write_text(f'{len(motion.time)} samples')\n"
    )
    monkeypatch.setattr(formats, "__path__", [*formats.__path__, str(tmp_path)])
    assert formats.known() == ["csv", "npz", "toy-text"]
    motion.export(tmp_path / "m.txt", "toy-text")
    assert (tmp_path / "m.txt").read_text() == f"{len(motion.time)} samples"


# Footsteps and robot


def test_footsteps_are_selected_by_side_and_kind(motion):
    steps = motion.footsteps
    rows = steps.rows()
    np.testing.assert_array_equal(steps.of_side(-1).rows(), rows[rows[:, 1] == -1.0])
    assert [int(steps.of_kind(kind).side[0]) for kind in (LEG_1, LEG_2)] == [-1, 1]
    assert len(steps.select(slice(2))) == 2
    assert len(steps.of_kind(LEG_1)) == 1


def test_another_robot_of_the_same_name_is_refused(robot, motion, spoilt_robot):
    assert motion.robot_fingerprint == robot.fingerprint
    motion.require_robot(robot)
    longer = spoilt_robot({("foot", "toe"): robot.foot.toe + 0.001})
    assert longer.name == robot.name
    for use in (
        motion.require_robot,
        lambda other: simulate(motion, robot=other),
        lambda other: viewer.page(other, motion),
    ):
        with pytest.raises(InvalidInput, match="was planned for another robot") as caught:
            use(longer)
        assert "\n" not in str(caught.value)
    dataclasses.replace(motion, robot_fingerprint="").require_robot(longer)


def test_a_fingerprint_knows_facts_and_urdf_and_no_names_or_parameters(robot, spoilt_robot, tmp_path):
    assert len(robot.fingerprint) == 16
    assert spoilt_robot({("name",): "mine"}).fingerprint == robot.fingerprint
    assert spoilt_robot({("walk", "lift"): 0.07}).fingerprint == robot.fingerprint
    assert robot.slowed.fingerprint == robot.fingerprint
    assert spoilt_robot({("foot", "toe"): robot.foot.toe + 0.001}).fingerprint != robot.fingerprint
    heavier = robot.urdf_path.read_text().replace('<mass value="', '<mass value="1', 1)
    for mesh in robot.urdf_path.parent.glob("*.obj"):
        (tmp_path / mesh.name).write_bytes(mesh.read_bytes())
    (tmp_path / "hrp2.urdf").write_text(heavier)
    other = spoilt_robot({("urdf",): str(tmp_path / "hrp2.urdf")}).fingerprint
    assert other != robot.fingerprint
    mesh = next(tmp_path.glob("*.obj"))
    text = mesh.read_text()
    mesh.write_text(text + "# a comment\n")
    assert spoilt_robot({("urdf",): str(tmp_path / "hrp2.urdf")}).fingerprint == other
    corner = next(line for line in text.splitlines() if line.startswith("v "))
    mesh.write_text(text.replace(corner, corner + "1", 1))
    assert spoilt_robot({("urdf",): str(tmp_path / "hrp2.urdf")}).fingerprint not in (other, robot.fingerprint)


def test_the_simulation_says_that_it_takes_one_obstacle(robot, motion):
    two = dataclasses.replace(motion, obstacles=np.repeat(motion.obstacles, 2, axis=0))
    with pytest.raises(InvalidInput, match="takes one obstacle"):
        simulate(two, robot=robot)
