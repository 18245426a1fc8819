"""motion.py: the file is what DESIGN promises, a round trip keeps everything, nothing broken is read or left behind."""

from __future__ import annotations

import csv
import dataclasses
import os
import zipfile

import numpy as np
import pytest

import stepover.motion.motion
from stepover import CorruptMotion, InvalidInput, Motion

ARRAYS = [field.name for field in dataclasses.fields(Motion) if field.name not in ("robot", "format", "version")]
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


def test_round_trip(motion, file):
    again = Motion.load(file)
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(again, name), getattr(motion, name))
        assert getattr(again, name).dtype == getattr(motion, name).dtype
    assert (again.robot, again.format, again.version) == (motion.robot, motion.format, motion.version)
    assert again.hash() == motion.hash()


def test_numpy_alone_reads_the_promised_keys_shapes_and_types(motion, file):
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
    scalars = {key: arrays[key] for key in ("robot", "format", "version")}
    assert all(value.shape == () for value in scalars.values())
    assert scalars["robot"].item() == "hrp2"
    assert scalars["format"].item() == 1
    assert scalars["version"].item() == stepover.__version__
    others = {"joint_names", "footsteps", "key_configuration", "obstacle", *scalars}
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
    with pytest.raises(CorruptMotion, match=r"cut\.npz is not a whole motion file"):
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
                np.testing.assert_array_equal(getattr(again, name), getattr(motion, name))
    assert len(refused) > 40
    assert all("flipped.npz" in message and "\n" not in message for message in refused)


@pytest.mark.parametrize("content", [b"", b"\x00" * 100, os.urandom(5000), b"PK\x03\x04" + os.urandom(200), b"x = 1\n"],
                         ids=["empty", "zeros", "random", "zip", "text"])  # fmt: skip
def test_what_is_no_motion(tmp_path, content):
    path = tmp_path / "no.npz"
    path.write_bytes(content)
    with pytest.raises(CorruptMotion, match=r"no\.npz is not a whole motion file"):
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


@pytest.mark.parametrize("key", [*ARRAYS, "robot", "format", "version"])
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
    if key not in ("footsteps", "time"):
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
    assert "format 2" in spoilt(format=np.array(2))


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
        row = contents["obstacle"].copy()
        row[index] = -row[index]
        assert "obstacle" in spoilt(obstacle=row)


def test_a_single_sample_is_no_motion(spoilt, contents):
    one = {key: value[:1] for key, value in contents.items() if value.ndim and len(value) == len(contents["time"])}
    assert "time" in spoilt(**one)
    none = {key: value[:0] for key, value in one.items()}
    assert "time" in spoilt(**none)


def test_more_keys_than_needed_do_no_harm(contents, motion, tmp_path):
    np.savez(tmp_path / "more.npz", **contents, note=np.array("mine"))
    assert Motion.load(tmp_path / "more.npz").hash() == motion.hash()


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
