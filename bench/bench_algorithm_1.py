"""Algorithm 1 at 5, 15 and 25 cm: each unit alone, the whole, and the yardstick for both.

The yardstick is one evaluation of the rigid-body dynamics over the motion's samples, on one thread: what a single
look at the multi-body ZMP costs at the least.
"""

from __future__ import annotations

import tracemalloc

import pytest
from prepared import HIGHER, WIDTH, ready

from stepover.model.body import _pool as rigid_joints
from stepover.model.obstacle import Obstacle
from stepover.planning.algorithm_1.beyond_paper import extra_zmp, waist_delay
from stepover.planning.algorithm_1.com_waist import com_and_waist
from stepover.planning.algorithm_1.dynamic_filter import filtered_waist
from stepover.planning.algorithm_1.feasibility import key_configurations
from stepover.planning.algorithm_1.feet_adaptor import adapt_feet
from stepover.planning.algorithm_1.feet_trajectories import feet_trajectories, swing_shape
from stepover.planning.algorithm_1.planner import plan_in_detail, whole_body
from stepover.planning.algorithm_1.step_sequence import Crossing, step_sequence
from stepover.planning.algorithm_1.upper_body import upper_body
from stepover.planning.checks import require

ROUNDS = 9
HEIGHTS = (0.05, 0.15, 0.25)
heights = pytest.mark.parametrize("height", HEIGHTS, ids=[f"{100 * height:.0f}cm" for height in HEIGHTS])


def group(height):
    """Benchmarks that have one yardstick."""
    return f"{100 * height:.0f} cm"


def other(height):
    """Another obstacle for each number, none of those that stand ready."""
    return lambda number: (Obstacle(height + HIGHER * (number + 0.5), WIDTH),)


@heights
def test_yardstick(measure, robot, height):
    sweeps = [robot.body.dynamics_sweep(ready(height, k).q, robot.walk.sample_time) for k in range(3)]
    measure("yardstick", group(height), lambda sweep: sweep(), lambda number: (sweeps[number % 3],), 75)


@heights
def test_multi_body_zmp(measure, robot, height):
    unit(measure, height, "multi-body ZMP, once", lambda at: robot.body.zmp(at.q, robot.walk.sample_time))


@heights
def test_whole(measure, benchmark, robot, height):
    plan = measure("plan, the whole", group(height), lambda obstacle: plan_in_detail(robot, obstacle), other(height),
                   ROUNDS)  # fmt: skip
    tracemalloc.start()
    plan_in_detail(robot, Obstacle(height, WIDTH))
    benchmark.extra_info |= {"peak_bytes": tracemalloc.get_traced_memory()[1], "samples": len(plan.motion.time)}
    tracemalloc.stop()


@pytest.fixture
def one_thread(monkeypatch):
    """The ZMP on one core."""
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    rigid_joints.cache_clear()
    yield
    rigid_joints.cache_clear()


@heights
@pytest.mark.usefixtures("one_thread")
def test_on_one_thread(measure, robot, height):
    """As where several planners share the cores, which is what `sweep` and the studies do."""
    measure("plan, on one thread", group(height), lambda obstacle: plan_in_detail(robot, obstacle), other(height),
            ROUNDS)  # fmt: skip


@heights
def test_feasibility(measure, robot, height):
    measure("1 FU", group(height), lambda obstacle: key_configurations(robot, obstacle), other(height), 2 * ROUNDS)


def unit(measure, height, what, call):
    """Time a step of Algorithm 1 on what stands ready for it, of another obstacle each time."""
    measure(what, group(height), call, lambda number: (ready(height, number % ROUNDS),), ROUNDS)


@heights
def test_steps_and_feet(measure, robot, height):
    def call(at):
        level = at.plan.options.level
        sequence = extra_zmp(robot, step_sequence(robot, at.obstacle, at.plan.key, robot.rest_zmp()), level)
        feet_trajectories(Crossing(robot, at.obstacle, sequence), swing_shape(robot, 0, leg_2_late=level > 0))

    unit(measure, height, "2 FTG", call)


@heights
def test_com_and_waist(measure, robot, height):
    def call(at):
        com_and_waist(robot, at.plan.sequence, at.plan.key, waist_delay(robot, at.plan.options.level))

    unit(measure, height, "3 CWTG1", call)


@heights
def test_inverse_kinematics(measure, robot, height):
    def call(at):
        whole_body(robot, at.poses, at.plan.nominal.upper.q, at.plan.sequence.time)

    unit(measure, height, "4 IK", call)


@heights
def test_upper_body(measure, robot, height):
    def call(at):
        upper_body(robot, at.plan.sequence, at.plan.nominal.feet, at.plan.nominal.first_stage, at.plan.options.arms)

    unit(measure, height, "5 UBMG", call)


@heights
def test_dynamic_filter(measure, robot, height):
    def call(at):
        zmp = robot.body.zmp(at.q, robot.walk.sample_time)
        filtered_waist(robot, at.poses.waist, at.plan.sequence.zmp, zmp)

    unit(measure, height, "6 CWTG2, one pass", call)


@heights
def test_feet_adaptor(measure, robot, height):
    def call(at):
        adapt_feet(at.plan.nominal.crossing, at.filtered)

    unit(measure, height, "7 FTA, one pass", call)


@heights
def test_checks(measure, robot, height):
    unit(measure, height, "checks", lambda at: require(robot, at.plan.motion))
