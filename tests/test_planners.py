"""planning/planner.py: every planner is found by its name; a new one takes one new file and one line."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from stepover import Course, InvalidInput, Motion, Obstacle, optimal_plan, plan, quasi_static_plan
from stepover.cli import main
from stepover.planning.checks import require
from stepover.planning.planner import PLANNERS, find_planner


@pytest.fixture
def toy(monkeypatch):
    """A planner in one new file, with its one line in the registry."""
    monkeypatch.syspath_prepend(Path(__file__).parent / "files")
    monkeypatch.setitem(PLANNERS, "toy", "toy_planner:stand_still")


def test_all_planners_are_found_by_name():
    assert find_planner("paper") is plan
    assert find_planner("quasi-static") is quasi_static_plan
    assert find_planner("optimal") is optimal_plan
    with pytest.raises(InvalidInput, match="unknown planner 'best': known are paper, optimal, quasi-static"):
        find_planner("best")


def test_no_planner_is_imported_before_it_is_asked_for():
    code = "import sys, stepover.planning.planner; print([name for name in sys.modules if 'algorithm_1' in name])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_a_new_planner_is_one_file_and_one_line(robot, toy, tmp_path):
    motion = find_planner("toy")(robot, Obstacle(0.15, 0.05))
    motion.save(tmp_path / "m.npz")
    again = Motion.load(tmp_path / "m.npz")
    assert (again.planner, again.hash(), len(again.footsteps)) == ("toy", motion.hash(), 0)


def test_the_command_line_prints_what_a_new_planner_knows(toy, tmp_path, monkeypatch):
    """The option lists the registry as it is when the command is made, so its list is renewed here."""
    (option,) = [option for option in main.commands["plan"].params if option.name == "planner"]
    monkeypatch.setattr(option.type, "choices", tuple(PLANNERS))
    asked = ["plan", "--height", "0.15", "--width", "0.05", "--planner", "toy", "--output", str(tmp_path / "m.npz")]
    result = CliRunner().invoke(main, [*asked, "--json"])
    assert result.exit_code == 0, result.output
    printed = json.loads(result.stdout)
    assert printed["planner"] == "toy"
    assert printed["step_over_duration"] is None
    assert not {"key_configuration", "zmp_rms_first_stage", "adaptations", "epsilon"} & set(printed)
    told = CliRunner().invoke(main, asked).stdout
    assert "of which - over the obstacle" in told


@pytest.mark.parametrize("name", ["paper", "quasi-static"])
class TestEveryPlanner:
    def test_a_course_of_one_is_its_obstacle(self, robot, name):
        alone = find_planner(name)(robot, Obstacle(0.05, 0.05))
        course = find_planner(name)(robot, Course([Obstacle(0.05, 0.05)]))
        assert course.hash() == alone.hash()
        np.testing.assert_array_equal(course.obstacles, alone.obstacles)
        assert (course.planner, course.robot_fingerprint) == (name, robot.fingerprint)

    def test_a_course_of_several_is_refused(self, robot, name):
        course = Course([Obstacle(0.05, 0.05, distance=0.6), Obstacle(0.05, 0.05, distance=2.4)])
        with pytest.raises(InvalidInput, match="takes one obstacle; the course has 2"):
            find_planner(name)(robot, course)

    def test_an_obstacle_that_is_turned_is_refused(self, robot, name):
        with pytest.raises(InvalidInput, match=r"square to the path; obstacle yaw = 0\.2 rad"):
            find_planner(name)(robot, Obstacle(0.05, 0.05, yaw=0.2))

    def test_a_finished_motion_passes_the_checks(self, robot, name):
        require(robot, find_planner(name)(robot, Obstacle(0.05, 0.05)))
