"""Inputs that once hung, hoarded memory or passed unnoticed: each ends soon, in one line, or works."""

from __future__ import annotations

import copy
import dataclasses
import gc
import multiprocessing
import os
import pickle
import resource
import subprocess
import sys
import threading
import tracemalloc
import warnings
import zipfile
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import stepover
from stepover import CorruptMotion, Infeasible, InvalidInput, Motion, Obstacle, load_robot, plan, simulate
from stepover.cli import main
from stepover.cli.simulate import plot_failure
from stepover.output import write_whole
from stepover.planning.nearest import nearest_crossable
from stepover.studies.obstacle_list import read_list

MEGABYTE = 2**20
NO_REAL_NUMBERS = [
    True, np.bool_(True), None, "0.1", Decimal("0.1"), Fraction(1, 10), 0.1 + 0j, np.array(0.1), np.array([[0.1]] * 9),
]  # fmt: skip
LENGTHS = ("height", "width", "margin_height", "margin_width", "distance")


@pytest.fixture(scope="module")
def coarse(robot):
    """HRP-2 with 10 ms samples: half the work."""
    return dataclasses.replace(robot, walk=dataclasses.replace(robot.walk, sample_time=0.01))


def test_a_refusal_keeps_no_memory(coarse):
    gc.collect()
    gc.disable()
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        with pytest.raises(Infeasible, match="the nearest obstacle that can be stepped over") as caught:
            plan(coarse, Obstacle(0.30, 0.10), arms="on", extras=False)
        now, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
        gc.enable()
    assert caught.value.__cause__ is None
    assert caught.value.__context__ is None
    assert now - before < 10 * MEGABYTE
    assert peak - before < 100 * MEGABYTE


def test_where_the_size_is_not_what_is_wrong_the_search_for_the_nearest_ends_soon():
    tried = []
    assert nearest_crossable(Obstacle(0.2, 0.1), lambda other: bool(tried.append(other))) is None
    assert [(one.height, one.width) for one in tried] == [(0.02, 0.1), (0.02, 0.02)]


def test_a_distance_in_millimetres_is_refused_at_once():
    with pytest.raises(InvalidInput, match="distance = 570 must be 20 m at most"):
        Obstacle(0.1, 0.05, distance=570)
    assert Obstacle(0.1, 0.05, distance=20).distance == 20.0


@pytest.mark.parametrize("name", [*LENGTHS, "yaw"])
@pytest.mark.parametrize("value", NO_REAL_NUMBERS, ids=lambda value: type(value).__name__)
def test_what_is_no_real_number_is_refused(name, value):
    if name == "distance" and value is None:
        return  # the nominal steps say where
    with pytest.raises(InvalidInput, match=f"obstacle {name} = ") as caught:
        Obstacle(**{"height": 0.1, "width": 0.05, name: value})
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 120


@pytest.mark.parametrize("name", LENGTHS)
@pytest.mark.parametrize("value", [1e306, 1e15, 10**300, np.float32(1e30)], ids=str)
def test_what_is_too_long_is_refused_with_the_true_reason(name, value):
    with pytest.raises(InvalidInput, match=rf"obstacle {name} = .* must be (10|20) m at most"):
        Obstacle(**{"height": 0.1, "width": 0.05, name: value})


def test_an_integer_that_python_does_not_write_is_refused():
    with pytest.raises(InvalidInput, match="obstacle height = "):
        Obstacle(10**5000, 0.05)


@pytest.mark.parametrize("name", [*LENGTHS, "yaw"])
@pytest.mark.parametrize("kind", [int, np.int64, np.uint8, np.float16, np.float32, np.float64, np.longdouble])
def test_numbers_become_floats_once(name, kind):
    value = getattr(Obstacle(**{"height": 2, "width": 2, name: kind(1)}), name)
    assert type(value) is float
    assert value == 1.0


@pytest.mark.parametrize("extras", ["no", 0, None])
def test_extras_is_true_or_false(robot, obstacle, extras):
    with pytest.raises(InvalidInput, match=f"extras = {extras!r} must be True or False"):
        plan(robot, obstacle, extras=extras)


# Motion files


def refusal(path):
    """Why a file is refused as a motion, without a warning; "" where it loads."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            Motion.load(path)
        except CorruptMotion as error:
            return str(error)
    return ""


@pytest.fixture
def contents(motion, tmp_path):
    """The arrays of the 15 cm motion's file."""
    motion.save(tmp_path / "good.npz")
    with np.load(tmp_path / "good.npz") as archive:
        return {key: archive[key] for key in archive.files}


@pytest.fixture
def refused(contents, tmp_path):
    """Load the motion with changes, which must be refused in one line, without a warning."""

    def load(**changes):
        np.savez(tmp_path / "bad.npz", **(contents | changes))
        message = refusal(tmp_path / "bad.npz")
        assert "\n" not in message
        assert 0 < len(message) < 400
        return message

    return load


FLOATS = ("q", "time", "com", "footsteps", "obstacle", "zmp")


@pytest.mark.parametrize("key", FLOATS)
@pytest.mark.parametrize("kind", [np.float16, np.float32, np.longdouble, complex, np.int64, bool, "S8", "U8"], ids=str)
def test_numbers_of_another_type_are_refused(refused, contents, key, kind):
    assert f"{key} has the type" in refused(**{key: contents[key].astype(kind)})


@pytest.mark.parametrize("key", FLOATS)
@pytest.mark.parametrize("value", [1e300, -1e300, 1e6])
def test_numbers_beyond_sense_are_refused(refused, contents, key, value):
    array = contents[key].copy()
    array.flat[0] = value
    assert f"{key} holds values beyond 1e+06" in refused(**{key: array})


def test_numbers_of_the_other_byte_order_are_read(contents, motion, tmp_path):
    swapped = {key: array.astype(array.dtype.newbyteorder(">")) for key, array in contents.items()}
    np.savez(tmp_path / "swapped.npz", **swapped)
    again = Motion.load(tmp_path / "swapped.npz")
    assert again.hash() == motion.hash()
    assert again.q.dtype.isnative


@pytest.mark.parametrize("value", [0.0, 1e-6, 0.9, 1.1])
def test_quaternions_of_q_have_unit_length(refused, contents, value):
    q = contents["q"].copy()
    q[100, 3:7] *= value
    assert "q holds quaternions" in refused(q=q)


def test_phases_come_in_their_order(refused, contents):
    phase = contents["phase"]
    swap = np.array([0, 2, 1, 3])
    for wrong in (swap[phase], phase[::-1], np.where(phase == 0, -1, phase), np.full_like(phase, -1)):
        assert "phase must be 0 throughout" in refused(phase=wrong)
    again = phase.copy()
    again[5] = 1
    assert "phase must be 0 throughout" in refused(phase=again)


@pytest.mark.parametrize("dt", [5.0, 0.051, 5e-5])
def test_a_sample_time_beyond_sense_is_refused(refused, contents, dt):
    assert "time goes in steps of" in refused(time=np.arange(len(contents["time"])) * dt)


@pytest.mark.parametrize("key", ["robot", "planner", "version", "robot_fingerprint"])
@pytest.mark.parametrize("name", ["a\x00b", "a\ud800b", "a\nb", "\x1b[31m", "x" * 201], ids=repr)
def test_a_name_prints_and_is_short(refused, key, name):
    assert f"{key} holds a text that is no name" in refused(**{key: np.array(name)})


def test_the_names_of_joints_print(refused, contents):
    names = contents["joint_names"].copy()
    names[3] = "a\x00b"
    assert "joint_names holds a text that is no name" in refused(joint_names=names)


def test_an_obstacle_larger_than_any_is_refused(refused, contents):
    rows = contents["obstacles"].copy()
    rows[0, 2] = 11.0
    assert "more than 10 m" in refused(obstacles=rows, obstacle=rows[0, :6])


def test_large_members_are_refused_unread(file_with, contents):
    """A file of some kilobytes may hold gigabytes of zeros."""
    tracemalloc.start()
    try:
        for member, words in (("note.npy", "unknown members, such as 'note'"), ("com.npy", "bytes, a motion has")):
            with pytest.raises(CorruptMotion, match=words):
                Motion.load(file_with(member, 300))
        assert tracemalloc.get_traced_memory()[1] < 20 * MEGABYTE
    finally:
        tracemalloc.stop()


@pytest.fixture
def file_with(contents, tmp_path):
    """Write the motion with one member of some megabytes of zeros."""

    def write(member, megabytes):
        others = {key: value for key, value in contents.items() if f"{key}.npy" != member}
        np.savez(tmp_path / "large.npz", **others)
        with (
            zipfile.ZipFile(tmp_path / "large.npz", "a", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
            archive.open(member, "w") as stream,
        ):
            for _ in range(megabytes):
                stream.write(bytes(10**6))
        return tmp_path / "large.npz"

    return write


def test_a_header_that_promises_more_than_there_is_is_refused(contents, tmp_path):
    np.savez(tmp_path / "m.npz", **contents)
    with zipfile.ZipFile(tmp_path / "m.npz") as old, zipfile.ZipFile(tmp_path / "lies.npz", "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "com.npy":
                count = str(len(contents["time"])).encode()
                content = content.replace(b"(" + count, b"(9" + count).replace(b"     \n", b"    \n", 1)
            new.writestr(name, content)
    with pytest.raises(CorruptMotion, match="com is shorter than it says"):
        Motion.load(tmp_path / "lies.npz")


def test_only_regular_files_of_a_sensible_size_are_read(tmp_path):
    os.mkfifo(tmp_path / "pipe.npz")
    (tmp_path / "zero.npz").symlink_to("/dev/zero")
    with open(tmp_path / "large.npz", "wb") as file:
        file.truncate(10**10)
    for name, words in (
        ("pipe", "not a regular file"),
        ("zero", "not a regular file"),
        ("large", "0,000,000 are read at most"),
    ):
        for read in (Motion.load, read_list):
            with pytest.raises(InvalidInput, match=words):
                read(tmp_path / f"{name}.npz")
    with pytest.raises(InvalidInput, match="is no path"):
        Motion.load("a\0b")


@pytest.mark.parametrize("name", ["pipe.toml", "/dev/zero", "..", "a\\b"])
def test_a_motion_opens_no_path(motion, tmp_path, monkeypatch, capsys, name):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe.toml")
    other = dataclasses.replace(motion, robot=name)
    other.save("m.npz")
    words = "unknown robot" if name == ".." else "names its robot by the path"
    with pytest.raises(InvalidInput, match=words):
        simulate(other)
    for command in (["simulate", "m.npz"], ["view", "m.npz", "--output", "m.html"]):
        with pytest.raises(SystemExit) as left:
            main(command)
        assert left.value.code == 2
        error = capsys.readouterr().err
        assert words in error
        assert error.count("\n") == 1
    assert not Path("m.html").exists()


def test_mutated_files_are_refused_or_load(contents, tmp_path):
    """Odd numbers anywhere: CorruptMotion, or a motion; never a warning."""
    rng, messages = np.random.default_rng(5), []
    odd = [np.nan, np.inf, -1e308, 1e300, 1e15, -1.0, 0.0, 5e-324]
    for _ in range(150):
        spoilt = {key: array.copy() for key, array in contents.items()}
        for key in rng.choice([key for key, array in contents.items() if array.dtype.kind in "if"], 2):
            array = spoilt[key]
            with np.errstate(invalid="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                array.flat[rng.integers(array.size)] = np.array(rng.choice(odd)).astype(array.dtype)
        np.savez(tmp_path / "odd.npz", **spoilt)
        messages.append(refusal(tmp_path / "odd.npz"))
    assert sum(bool(message) for message in messages) > 100
    assert not any("\n" in message for message in messages)


# Writing


@pytest.mark.parametrize("write", ["save", "save_csv"])
def test_threads_may_save_to_one_path(motion, tmp_path, write):

    path, failed = tmp_path / "m", []

    def save():
        for _ in range(3):
            try:
                getattr(motion, write)(path)
            except BaseException as error:
                failed.append(error)

    threads = [threading.Thread(target=save) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failed == []
    assert [one.name for one in tmp_path.iterdir()] == ["m"]
    if write == "save":
        assert Motion.load(path).hash() == motion.hash()


def test_the_longest_name_of_a_file_is_written(tmp_path):
    path = tmp_path / ("x" * 251 + ".npz")
    write_whole(path, lambda file: file.write(b"1"))
    assert [one.name for one in tmp_path.iterdir()] == [path.name]


# A robot in other processes


@pytest.mark.parametrize(
    "how",
    [copy.deepcopy, copy.copy, lambda robot: pickle.loads(pickle.dumps(robot))],
    ids=["deep copy", "copy", "pickle"],
)
@pytest.mark.parametrize("name", ["hrp2", "jvrc1"])
def test_a_robot_is_copied_and_pickled(how, name):
    robot = load_robot(name)
    robot.shapes, robot.leg(1), robot.slowed  # what is cached must not stand in the way
    other = how(robot)
    assert other is not robot
    assert (other.fingerprint, other.posture, other.body.mass) == (robot.fingerprint, robot.posture, robot.body.mass)
    assert other.slow == robot.slow
    with pytest.raises(TypeError):
        other.posture.angles_deg["LLEG_JOINT3"] = 1.0
    q = np.tile(robot.half_sitting(), (5, 1))
    np.testing.assert_array_equal(other.half_sitting(), robot.half_sitting())
    np.testing.assert_array_equal(other.body.zmp(q, 0.005), robot.body.zmp(q, 0.005))
    for one, own in zip(other.shapes, robot.shapes, strict=True):
        np.testing.assert_array_equal(one.vertices, own.vertices)


def test_a_robot_goes_through_a_pool_of_spawned_processes(robot, obstacle, motion):
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        (planned,) = pool.starmap(plan, [(robot, obstacle)])
    for name in ("q", "zmp", "com", "waist"):
        np.testing.assert_array_equal(getattr(planned, name), getattr(motion, name))
    planned.require_robot(robot)


# Streams and disks

PLAN = ("plan", "--height", "0.05", "--width", "0.05", "--output", "m.npz")
REFUSED = ("plan", "--height", "-1", "--width", "0.05", "--output", "m.npz")


def run(folder, *arguments, **options):
    """Run a command; what it says on the streams that are not given otherwise."""
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
    command = [sys.executable, "-m", "stepover", *arguments]
    return subprocess.run(command, cwd=folder, text=True, timeout=120, check=False, env=ENVIRONMENT, **streams)


ENVIRONMENT = os.environ | {"PYTHONPATH": str(Path(stepover.__file__).parents[1])}


@pytest.fixture
def gone():
    """A pipe whose reader has gone."""
    reader, writer = os.pipe()
    os.close(reader)
    yield writer
    os.close(writer)


@pytest.mark.parametrize("arguments", [PLAN, ("--help",), ("plan", "--help")], ids=" ".join)
def test_a_reader_that_has_gone_is_no_error(tmp_path, gone, arguments):
    done = run(tmp_path, *arguments, stdout=gone)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "m.npz").exists() == (arguments is PLAN)


@pytest.mark.parametrize("arguments", [PLAN, ("--help",)], ids=" ".join)
def test_a_full_disk_behind_stdout_is_one_line(tmp_path, arguments):
    with open("/dev/full", "w") as full:
        done = run(tmp_path, *arguments, stdout=full)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "No space left on device" in done.stderr


@pytest.mark.parametrize(("arguments", "code"), [(PLAN, 0), (REFUSED, 2)], ids=["plan", "refused"])
@pytest.mark.parametrize("closed", [(0,), (1,), (2,), (0, 1, 2)], ids=str)
def test_closed_streams_change_no_exit_code(tmp_path, arguments, code, closed):
    done = run(tmp_path, *arguments, preexec_fn=lambda: [os.close(one) for one in closed])
    assert done.returncode == code
    assert done.stderr.count("\n") == (code == 2 and 2 not in closed)
    assert (tmp_path / "m.npz").exists() == (code == 0)
    if code == 0:
        Motion.load(tmp_path / "m.npz")


def test_a_full_disk_behind_stderr_changes_no_exit_code(tmp_path):
    with open("/dev/full", "w") as full:
        assert run(tmp_path, *REFUSED, stderr=full).returncode == 2


def test_a_full_disk_is_one_line_and_leaves_no_part(tmp_path):
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000))  # noqa: E731
    done = run(tmp_path, *PLAN, preexec_fn=limit)
    assert done.returncode == 2
    assert done.stderr == "error: m.npz cannot be written: File too large\n"
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_in_a_sweep_is_one_line(tmp_path):
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (10, 10))  # noqa: E731
    (tmp_path / "sizes.csv").write_text("height,width\n0.05,0.05\n")
    done = run(tmp_path, "sweep", "sizes.csv", "--output", "t.csv", "--jobs", "1", preexec_fn=limit)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == "error: a file cannot be read or written: File too large"
    assert "Traceback" not in done.stderr


def test_where_a_failure_cannot_be_plotted_it_says_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(os, "access", lambda *_: False)
    monkeypatch.setattr("stepover.report.figures.failure", lambda *_: None)
    Path("build").write_text("a file")
    assert plot_failure(None, Path("m.npz"), None).startswith("there is no plot of the last second before it: ")
