"""The command line: what it prints, where it complains, and with which exit code it ends."""

import dataclasses
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stepover.locations
from stepover import Motion, Obstacle, __version__, load_robot
from stepover.cli import main
from stepover.cli.commands import Command, progress
from stepover.cli.simulate import plot_failure
from stepover.errors import InvalidInput
from stepover.planning.algorithm_1 import planner
from stepover.report import summary
from stepover.reproduction import run as module
from stepover.reproduction.pages import tally
from stepover.reproduction.verdicts import RECORDED

PLAN_KEYS = {
    "robot", "planner", "obstacle", "key_configuration", "duration", "step_over_duration", "samples",
    "zmp_rms_first_stage", "zmp_rms", "zmp_error_max", "zmp_margin_min", "clearance_min", "clearance_link",
    "clearance_time",
    "joint_margin_min", "joint_margin_joint", "joint_speed_ratio_max", "joint_speed_joint",
    "com_travel_double_support", "com_acceleration_ratio_max", "adaptations", "planning_time",
}  # fmt: skip
SIMULATE_KEYS = {
    "crossed", "fell", "fall_time", "fall_reason", "obstacle_contacts", "clearance_min", "clearance_link", "zmp_rms",
    "landing_force_peak", "waist_error_max", "torque_ratio_max", "speed_ratio_max", "torque_saturated_samples",
    "actuators", "sole", "stabilizer", "duration", "realtime_factor", "state_hash",
    "speed_violation_samples", "perturb", "engine",
}  # fmt: skip
SMALL = ["--height", "0.05", "--width", "0.05"]


@pytest.fixture(scope="module")
def motion():
    return planner.plan(load_robot("hrp2"), Obstacle(0.05, 0.05))


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Each test runs in a folder of its own, so that what it leaves behind is seen."""
    monkeypatch.chdir(tmp_path)


def call(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments], prog_name="python -m stepover")


def refused(result, code, *words):
    """Whether a command ended with this code, one line on stderr with these words, and nothing else."""
    assert result.exit_code == code, result.output
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    for word in words:
        assert word in result.stderr
    assert os.listdir() == []


def run_without(module):
    """`plan` in a Python that has everything but this module."""
    code = (
        f"import runpy, sys; sys.modules['{module}'] = None; sys.argv = ['stepover', 'plan', *{SMALL}, '--output', "
        "'m.npz']; runpy.run_module('stepover', run_name='__main__')"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)


class TestPlan:
    def test_json_is_one_object_with_the_promised_keys(self):
        result = call("plan", *SMALL, "--output", "m.npz", "--json")
        assert result.exit_code == 0, result.output
        assert len(result.stdout.splitlines()) == 1
        printed = json.loads(result.stdout)
        assert set(printed) == PLAN_KEYS
        assert set(printed["key_configuration"]) == {"x_ads", "x_hds", "z_hds"}
        assert set(printed["planning_time"]) == {"feasibility", "trajectories", "total"}
        assert printed["obstacle"]["height"] == 0.05
        assert printed["obstacle"]["distance"] == pytest.approx(Motion.load("m.npz").obstacle[0])
        assert printed["samples"] == len(Motion.load("m.npz").time)

    def test_summary_and_csv(self):
        result = call("plan", *SMALL, "--output", "m.npz", "--csv", "m.csv")
        assert result.exit_code == 0, result.output
        lines = result.stdout.splitlines()
        assert lines[-1] == "written to m.npz"
        assert len({re.match(r"\S+( \S+)*  +", line).end() for line in lines[:-2]}) == 1, "the values are aligned"
        assert len(Path("m.csv").read_text().splitlines()) == len(Motion.load("m.npz").time) + 1

    @pytest.mark.parametrize("value", ["0", "-0.1", "nan", "inf", "1e400", "abc"])
    @pytest.mark.parametrize("option", ["--height", "--width"])
    def test_what_is_no_obstacle(self, option, value):
        sizes = {"--height": "0.1", "--width": "0.05"} | {option: value}
        refused(call("plan", *sum(sizes.items(), ()), "--output", "m.npz"), 2, option[2:])

    @pytest.mark.parametrize(
        ("arguments", "word"),
        [
            (["--margin-height", "-0.01"], "margin_height"),
            (["--margin-width", "nan"], "margin_width"),
            (["--distance", "0"], "distance"),
            (["--robot", "hrp3"], "hrp2"),
            (["--robot", "nowhere.toml"], "nowhere.toml"),
            (["--arms", "maybe"], "--arms"),
            (["--speed-limits", "maybe"], "--speed-limits"),
            (["--colour", "red"], "--colour"),
            (["--output", "nowhere/m.npz"], "nowhere"),
            (["--csv", "nowhere/m.csv"], "nowhere"),
            (["--output", "m.txt"], ".npz"),
            (["--output", "m"], ".npz"),
            (["--csv", "m.npz"], ".csv"),
            (["--planner", "best"], "quasi-static"),
            (["--planner", "quasi-static", "--epsilon", "5"], "epsilon"),
            (["--height", "0.2"], "--height is given twice"),
            (["--output", "."], "folder"),
        ],
    )
    def test_bad_options(self, arguments, word):
        output = [] if "--output" in arguments else ["--output", "m.npz"]
        refused(call("plan", *SMALL, *output, *arguments), 2, word)

    def test_places_are_looked_at_before_the_work(self, monkeypatch):
        monkeypatch.setattr(planner, "plan_in_detail", lambda *_, **__: pytest.fail("it planned"))
        refused(call("plan", *SMALL, "--output", "nowhere/m.npz"), 2, "does not exist")

    @pytest.mark.parametrize("missing", ["--height", "--width", "--output"])
    def test_required_options(self, missing):
        given = {"--height": "0.1", "--width": "0.05", "--output": "m.npz"}
        del given[missing]
        refused(call("plan", *sum(given.items(), ())), 2, missing)

    def test_an_obstacle_nearer_than_the_first_step(self):
        refused(call("plan", *SMALL, "--distance", "0.2", "--output", "m.npz", "--json"), 3, "nearer", "nearest")

    def test_the_old_file_stays_where_there_is_no_new_one(self):
        Path("m.npz").write_text("old")
        assert call("plan", *SMALL, "--distance", "0.2", "--output", "m.npz").exit_code == 3
        assert Path("m.npz").read_text() == "old"

    def test_the_quasi_static_planner(self):
        slow = ["--planner", "quasi-static", "--epsilon", "0.02"]
        result = call("plan", "--height", "0.15", "--width", "0.05", *slow, "--output", "m.npz", "--json")
        assert result.exit_code == 0, result.output
        printed, motion = json.loads(result.stdout), Motion.load("m.npz")
        own = {"epsilon", "margins_refused"}
        assert set(printed) == PLAN_KEYS - {"zmp_rms_first_stage", "adaptations", "planning_time"} | own
        assert (printed["planner"], motion.planner, printed["epsilon"]) == ("quasi-static", "quasi-static", 0.02)
        assert printed["obstacle"]["margin_height"] == motion.obstacle[4] == 0.01
        assert "phase 1" in printed["margins_refused"]
        assert printed["duration"] == pytest.approx(motion.time[-1])
        told = call("plan", "--height", "0.15", "--width", "0.05", *slow, "--output", "m.npz").stdout
        assert re.search("^planner +quasi-static$", told, re.MULTILINE)
        assert re.search("^ZMP to CoM +20 mm at most, epsilon$", told, re.MULTILINE)
        assert "dynamic filter" not in told

    def test_the_optimising_planner(self):
        result = call("plan", *SMALL, "--planner", "optimal", "--output", "m.npz", "--json")
        assert result.exit_code == 0, result.output
        printed, motion = json.loads(result.stdout), Motion.load("m.npz")
        own = {"torque_ratio_max", "torque_ratio_joint", "self_clearance_min", "iterations", "attempts", "durations"}
        paper = {"zmp_rms_first_stage", "adaptations", "planning_time", "key_configuration"}
        assert set(printed) == PLAN_KEYS - paper | own
        assert (printed["planner"], motion.planner) == ("optimal", "optimal")
        assert printed["torque_ratio_max"] < 1.0
        assert printed["iterations"] == sum(attempt["iterations"] for attempt in printed["attempts"])

    def test_the_paper_alone(self):
        result = call("plan", *SMALL, "--no-extras", "--output", "m.npz", "--json")
        assert json.loads(result.stdout)["adaptations"]["beyond_paper_level"] == 0
        high = ["--height", "0.25", "--width", "0.05", "--no-extras"]
        used = json.loads(call("plan", *high, "--output", "n.npz", "--json").stdout)["adaptations"]
        assert (used["beyond_paper_level"], used["late_swing"]) == (0, 2)

    @pytest.mark.parametrize(
        ("planner", "arguments", "owner"),
        [
            ("paper", ["--epsilon", "0.001"], "quasi-static"),
            ("quasi-static", ["--arms", "auto"], "paper"),
            ("quasi-static", ["--speed-limits", "ignore"], "paper"),
            ("quasi-static", ["--extras"], "paper"),
        ],
    )
    def test_an_option_of_another_planner(self, planner, arguments, owner):
        result = call("plan", *SMALL, "--planner", planner, *arguments, "--output", "m.npz")
        refused(result, 2, arguments[0], f"option of the planner '{owner}', not of '{planner}'")

    def test_interrupted(self, monkeypatch):
        def interrupt(*_, **__):
            raise KeyboardInterrupt

        monkeypatch.setattr(planner, "plan_in_detail", interrupt)
        result = call("plan", *SMALL, "--output", "m.npz")
        assert (result.exit_code, result.stderr.split()) == (130, ["error:", "interrupted"])


def without_a_key(content):
    content.pop("com")


def with_nan(content):
    content["q"] = np.where(np.arange(content["q"].shape[1]) == 9, np.nan, content["q"])


def of_another_robot(content):
    content["robot"] = np.array("hrp3")


class TestSimulate:
    @pytest.mark.parametrize("damage", [without_a_key, with_nan, of_another_robot])
    def test_motions_that_contradict_themselves(self, motion, damage, tmp_path_factory):
        path = tmp_path_factory.mktemp("motions") / "m.npz"
        motion.save(path)
        with np.load(path) as archive:
            content = dict(archive)
        damage(content)
        np.savez(path, **content)
        refused(call("simulate", path), 2)

    @pytest.mark.parametrize("size", [0, 100, 50_000, None])
    def test_files_that_are_no_motion(self, motion, size, tmp_path_factory):
        path = tmp_path_factory.mktemp("motions") / "m.npz"
        motion.save(path)
        whole = path.read_bytes()
        path.write_bytes(whole[:size] if size is not None else np.random.default_rng(0).bytes(len(whole)))
        refused(call("simulate", path), 2, "m.npz")

    @pytest.mark.parametrize(
        ("arguments", "word"),
        [
            (["nowhere.npz"], "no such file"),
            ([], "MOTION"),
            (["nowhere.npz", "--video", "nowhere/m.mp4"], "does not exist"),
            (["nowhere.npz", "--video", "m.avi"], ".mp4"),
            (["nowhere.npz", "--actuators", "strong"], "--actuators"),
            (["nowhere.npz", "--perturb", "push"], "name=value"),
            (["nowhere.npz", "--perturb", "push=hard"], "finite number"),
            (["nowhere.npz", "--perturb", "push=nan"], "finite number"),
            (["nowhere.npz", "--perturb", "push=1", "--perturb", "push=2"], "twice"),
            (["nowhere.npz", "--perturb", "push_x=1", "--perturb", "push_y=2"], "no such file"),
        ],
    )
    def test_bad_options(self, arguments, word):
        refused(call("simulate", *arguments), 2, word)

    def test_crossing_as_a_user_calls_it(self, motion):
        motion.save("m.npz")
        done = subprocess.run(
            [sys.executable, "-m", "stepover", "simulate", "m.npz", "--json"], capture_output=True, text=True
        )
        assert (done.returncode, done.stderr) == (0, "")
        assert len(done.stdout.splitlines()) == 1
        printed = json.loads(done.stdout)
        assert set(printed) == SIMULATE_KEYS
        assert (printed["crossed"], printed["fell"]) == (True, False)
        assert printed["fall_time"] is None
        assert set(printed["landing_force_peak"]) == {"first", "second"}
        assert os.listdir() == ["m.npz"]

    def test_help_lists_the_disturbances(self):
        text = " ".join(call("simulate", "--help").stdout.split())
        for part in ("Disturbances, for --perturb:", "slope_ahead [deg]", "push_y [N]", "ground_1, ... [m]"):
            assert part in text

    def test_unknown_disturbances(self, motion, tmp_path_factory):
        path = tmp_path_factory.mktemp("motions") / "m.npz"
        motion.save(path)
        refused(call("simulate", path, "--perturb", "wind=1"), 2, "'wind'")
        refused(call("simulate", path, "--perturb", "friction=9"), 2, "0.01 to 2")

    def test_what_does_not_cross_explains_itself(self, motion):
        higher = motion.obstacles.copy()
        higher[0, 2] += 0.15
        dataclasses.replace(motion, obstacles=higher).save("m.npz")
        result = call("simulate", "m.npz", "--json")
        assert result.exit_code == 4
        assert json.loads(result.stdout)["obstacle_contacts"] > 0
        assert json.loads(result.stdout)["crossed"] is False
        assert len(result.stderr.splitlines()) == 1
        assert "hit the obstacle" in result.stderr
        assert "m_failure.png" in result.stderr
        told = call("simulate", "m.npz").stdout
        assert re.search("^outcome +touched the obstacle( and fell)?$", told, re.MULTILINE), "the sentence is on stderr"
        assert re.search("^torque (at|beyond) its limit", told, re.MULTILINE)
        assert "times the speed of real time" in told
        assert Path("m_failure.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.filterwarnings("ignore:zmq.eventloop:DeprecationWarning")
class TestView:
    def test_as_a_user_calls_it(self, motion):
        motion.save("m.npz")
        command = [sys.executable, "-m", "stepover", "view", "m.npz", "--output", "m.html"]
        done = subprocess.run(command, capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout == "written to m.html; open it in a browser\n"
        assert sorted(os.listdir()) == ["m.html", "m.npz"]
        assert "<title>hrp2 steps over an obstacle 5 cm high, 5 cm wide</title>" in Path("m.html").read_text()

    def test_a_robot_that_is_none_under_data(self, motion, spoilt, tmp_path_factory):
        path = tmp_path_factory.mktemp("motions") / "m.npz"
        motion.save(path)
        with np.load(path) as archive:
            content = dict(archive) | {"robot": np.array("mine")}
        np.savez(path, **content)
        refused(call("view", path, "--output", "m.html"), 2, "mine")
        result = call("view", path, "--output", "m.html", "--robot", spoilt({("name",): "mine"}))
        assert result.exit_code == 0, result.output
        assert Path("m.html").is_file()

    @pytest.mark.parametrize(
        ("arguments", "word"),
        [
            (["--output", "nowhere/m.html"], "does not exist"),
            (["--output", "m.npz"], ".html"),
            (["--output", "m.html", "--time", "99"], "from 0.00 s"),
            (["--output", "m.html", "--time", "nan"], "from 0.00 s"),
            ([], "--output"),
        ],
    )
    def test_bad_options(self, motion, arguments, word, tmp_path_factory):
        path = tmp_path_factory.mktemp("motions") / "m.npz"
        motion.save(path)
        refused(call("view", path, *arguments), 2, word)

    @pytest.mark.parametrize("damage", [without_a_key, of_another_robot])
    def test_motions_that_cannot_be_shown(self, motion, damage, tmp_path_factory):
        path = tmp_path_factory.mktemp("motions") / "m.npz"
        motion.save(path)
        with np.load(path) as archive:
            content = dict(archive)
        damage(content)
        np.savez(path, **content)
        refused(call("view", path, "--output", "m.html"), 2)
        refused(call("view", "nowhere.npz", "--output", "m.html"), 2, "no such file")


class TestReproduce:
    def test_an_unknown_parameter(self):
        refused(call("reproduce", "-p", "hight=0.2"), 2, "hight", "height")

    def test_a_value_of_the_wrong_type(self):
        refused(call("reproduce", "-p", "height=high"), 2, "height", "a finite number, such as")

    def test_where_the_figures_go_is_not_for_the_user_to_say(self):
        refused(call("reproduce", "-p", "output=here"), 2, "output")

    def test_it_says_what_and_where_in_few_lines(self, monkeypatch, tmp_path_factory):
        top = tmp_path_factory.mktemp("top")
        written = [top / "figures" / "a.png", top / "figures" / "b.png", top / "README.md"]
        monkeypatch.setattr(stepover.locations, "checkout", lambda: top)
        monkeypatch.setattr(module, "reproduce", lambda *_: written)
        (top / "figures").mkdir()
        row = {"verdict": "holds", "judged_by": "ours"} | dict.fromkeys(RECORDED[2:]) | {"measured": 1}
        entries = [{"id": str(k)} | row for k in range(3)]
        (top / "figures" / "claims.json").write_text(json.dumps(entries))
        result = call("reproduce")
        told = "written: 2 files in figures/, executed notebooks in build/notebooks/"
        assert result.stdout.splitlines() == [told, tally(entries)]
        written[:] = [top / "build" / "figures" / "a.png"]
        result = call("reproduce", "-p", "height=0.1")
        assert result.stdout == "written: 1 file in build/figures/, executed notebooks in build/experiment/\n"

    def test_an_unknown_notebook(self):
        refused(call("reproduce", "--only", "stepover_99cm"), 2, "stepover_99cm", "stepover_15cm")


class TestWhole:
    def test_wrong_usage(self):
        refused(call("plam"), 2, "plam")
        result = call()
        assert (result.exit_code, result.stdout) == (2, "")
        assert "Commands:" in result.stderr

    def test_help(self):
        overview = call("--help")
        assert overview.exit_code == 0
        assert list(main.commands) == ["plan", "simulate", "view", "study", "sweep", "reproduce"]
        for name in main.commands:
            assert name in overview.stdout
            page = call(name, "--help")
            assert page.exit_code == 0
            assert f"Usage: python -m stepover {name}" in page.stdout

    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            (["plan", *SMALL, "--output", "m.npz", "--output", "n.npz"], "--output"),
            (["plan", *SMALL, "--output", "m.npz", "--extras", "--no-extras"], "--extras / --no-extras"),
            (["simulate", "m.npz", "--sole", "rigid", "--sole=rigid"], "--sole"),
            (["view", "m.npz", "--output", "m.html", "--time", "1", "--time", "2"], "--time"),
            (["study", "m.npz", "--output", "m.csv", "--seed", "1", "--seed", "2"], "--seed"),
            (["sweep", "--heights", "0.1", "--heights", "0.2", "--output", "m.csv"], "--heights"),
            (["reproduce", "--only", "a", "--only", "b"], "--only"),
        ],
    )
    def test_an_option_given_twice(self, arguments, words):
        refused(call(*arguments), 2, f"{words} is given twice", f"{arguments[0]} --help")

    def test_every_command_refuses_an_option_given_twice(self):
        assert all(isinstance(command, Command) for command in main.commands.values())

    def test_version(self):
        assert __version__ in call("--version").stdout

    def test_nothing_heavy_is_imported_before_it_is_needed(self):
        heavy = ["pinocchio", "pybullet", "meshcat", "matplotlib", "scipy", "numpy", "papermill"]
        code = f"import stepover, stepover.cli, sys; print(set({heavy}) & set(sys.modules))"
        assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "set()\n"

    @pytest.mark.parametrize("lacking", ["click", "pinocchio"])
    def test_a_python_without_our_requirements_is_told_so(self, lacking):
        done = run_without(lacking)
        assert (done.returncode, done.stdout) == (2, "")
        assert len(done.stderr.splitlines()) == 1
        for word in (sys.executable, f"no module '{lacking}'", "make env", ".venv/bin/python"):
            assert word in done.stderr

    def test_a_module_of_our_own_that_is_missing_is_a_bug(self):
        done = run_without("stepover.planning.algorithm_1.planner")
        assert done.returncode == 1
        assert "Traceback" in done.stderr

    def test_null_for_what_is_no_number(self):
        values = {"nan": float("nan"), "many": np.array([1.0, np.inf]), "n": np.int64(3), "none": (None, True)}
        assert json.loads(summary.as_line(values)) == {"nan": None, "many": [1.0, None], "n": 3, "none": [None, True]}

    def test_a_bug_is_no_bad_input(self, monkeypatch):
        def broken(*_, **__):
            raise ZeroDivisionError

        monkeypatch.setattr(planner, "plan_in_detail", broken)
        result = call("plan", *SMALL, "--output", "m.npz")
        assert result.exit_code == 1
        assert isinstance(result.exception, ZeroDivisionError)

    def test_errors_are_one_line(self, monkeypatch):
        def complain(*_, **__):
            raise InvalidInput("this\nand that")

        monkeypatch.setattr(planner, "plan_in_detail", complain)
        refused(call("plan", *SMALL, "--output", "m.npz"), 2, "this and that")


def test_the_failure_plot_goes_to_build_where_the_motion_may_not(monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_: False)
    monkeypatch.setattr("stepover.report.figures.failure", lambda *_: None)
    monkeypatch.setattr("stepover.report.figures.save", lambda _, path: path.write_bytes(b""))
    assert "build/m_failure.png" in plot_failure(None, Path("/m.npz"), None)
    assert os.listdir("build") == ["m_failure.png"]


def test_a_bar_is_there_from_the_first_share_on_and_gone_at_the_end(monkeypatch):
    terminal = io.StringIO()
    terminal.isatty = lambda: True
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress("looking"):
        pass
    assert terminal.getvalue() == ""
    with progress("looking") as advance:
        advance(0.25)
        assert "looking:  25%" in terminal.getvalue()
    assert terminal.getvalue().rsplit("\r", 2)[1].strip() == "", "the line is empty again"
