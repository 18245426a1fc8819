"""What is around Algorithm 1, beside the yardstick of the 15 cm case: Fig. 2, distances, the physics, the start."""

from __future__ import annotations

import subprocess
import sys

from prepared import HIGHER, WIDTH, ready

from stepover.analysis.planar.feasibility_domain import feasibility_domains
from stepover.model.collision import clearance
from stepover.model.obstacle import Obstacle
from stepover.simulation.run import simulate

HEIGHT, GROUP, ROUNDS = 0.15, "15 cm", 9
COLD = """
import resource
from stepover import Obstacle, load_robot, plan
plan(load_robot("hrp2"), Obstacle({height}, 0.05))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""


def standing(number):
    """A motion that is planned already."""
    return (ready(HEIGHT, number % ROUNDS).plan.motion,)


def test_fig_2(measure, robot):
    def call(obstacle):
        feasibility_domains(robot, obstacle, points=200)

    measure("Fig. 2, 200 x 200", GROUP, call, lambda k: (Obstacle(HEIGHT + HIGHER * k, WIDTH),), ROUNDS)


def test_placements(measure, robot):
    measure("forward kinematics", GROUP, lambda motion: robot.body.placements(motion.q), standing, ROUNDS)


def test_clearance(measure, robot):
    placed = [robot.body.placements(standing(k)[0].q) for k in range(ROUNDS)]

    def call(motion, placements):
        clearance(robot.shapes, placements, motion.bare_obstacle)

    measure("clearance of all links", GROUP, call, lambda k: (*standing(k), placed[k % ROUNDS]), ROUNDS)


def test_simulate(measure, benchmark):
    run = measure("simulate, ideal motors", GROUP, simulate, standing, 3)
    benchmark.extra_info["simulated"] = float(run.motion.time[-1] - run.motion.time[0])
    assert run.crossed


def process(measure, what, *arguments, rounds=ROUNDS):
    """Time a process from its start to its end."""

    def call(*arguments):
        return subprocess.run([sys.executable, *arguments], check=True, capture_output=True, text=True).stdout

    return measure(what, GROUP, call, lambda number: tuple(text.format(height=HEIGHT + HIGHER * number)
                                                          for text in arguments), rounds)  # fmt: skip


def test_python_itself(measure):
    process(measure, "python, empty", "-c", "pass")


def test_import(measure):
    process(measure, "import stepover", "-c", "import stepover")


def test_help(measure):
    process(measure, "stepover --help", "-m", "stepover", "--help")


def test_cold_plan(measure, benchmark):
    benchmark.extra_info["resident_bytes"] = int(process(measure, "plan, from a cold start", "-c", COLD, rounds=5))
