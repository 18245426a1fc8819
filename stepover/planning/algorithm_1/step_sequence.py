"""Which foot steps where and when, and the ZMP reference that follows from it. Sec. V and III-C2.

Normal steps, stretched so that they end where the rear foot must stand, the step before, leg 1, leg 2, the step
after, a normal step and a closing one. Each single support is followed by its own double support, over which the
reference moves linearly from the one foot to the other; in single support it stays under the ankle.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from stepover.errors import Infeasible
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import AFTER, BEFORE, LEG_1, LEG_2, NORMAL
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.leg_check import LegLimits


@dataclass(frozen=True)
class Step:
    """One step: a swing from one foothold to the next.

    Attributes:
        side: of the swing foot, +1 left, -1 right.
        kind: motion.footsteps.Kind.
        start, end: footholds (2,) of the ankle's projection [m].
        lift_off, touch_down: first sample of the swing, first sample on the ground again.
    """

    side: int
    kind: int
    start: tuple[float, float]
    end: tuple[float, float]
    lift_off: int
    touch_down: int

    @property
    def swing(self) -> slice:
        """Samples from lift-off to touch-down, both included."""
        return slice(self.lift_off, self.touch_down + 1)

    @property
    def share(self) -> np.ndarray:
        """Share of the swing's time that has passed at each of these samples, 0 to 1."""
        return np.linspace(0.0, 1.0, self.touch_down - self.lift_off + 1)


@dataclass(frozen=True, eq=False)
class StepSequence:
    """All steps of a motion.

    Attributes:
        steps: in their order.
        time: (N,) [s].
        support: (N,) 0 double, +1 left foot, -1 right foot.
        phase: (N,) 0 walking, 1, 2, 3 the phases of Sec. II.
        zmp: (N, 2) desired ZMP [m].
        front_face: x of the obstacle's front face [m].
    """

    steps: tuple[Step, ...]
    time: np.ndarray
    support: np.ndarray
    phase: np.ndarray
    zmp: np.ndarray
    front_face: float

    def step(self, kind: int) -> Step:
        """The step of one of the kinds that occur once: BEFORE, LEG_1, LEG_2, AFTER."""
        return next(step for step in self.steps if step.kind == kind)


@dataclass(frozen=True, eq=False)
class Crossing:
    """A robot that steps over an obstacle in a sequence of steps: what the later units all need.

    Attributes:
        robot: the robot.
        obstacle: the obstacle with its margins.
        sequence: the steps, which place the obstacle.
    """

    robot: Robot
    obstacle: Obstacle
    sequence: StepSequence

    @property
    def limits(self) -> LegLimits:
        """What the legs must keep all along: the obstacle's margins, and the knees' margin from straight."""
        rectangle = self.obstacle.profile(self.sequence.front_face, margins=True)
        return LegLimits(rectangle, np.radians(self.robot.checks.knee_margin_deg))


def step_sequence(
    robot: Robot, obstacle: Obstacle, key: KeyConfiguration, rest_zmp: np.ndarray, leading: int = -1
) -> StepSequence:
    """Lay out the steps: first half of step 2 of Algorithm 1.

    Args:
        robot: the robot.
        obstacle: the obstacle; its distance says where the rear foot must stand.
        key: key configuration.
        rest_zmp: (2,) where the ZMP rests between the feet in half-sitting, from the midpoint of the ankles [m].
        leading: the side that steps over first.

    Raises:
        Infeasible: the obstacle is nearer than the first step.
    """
    walk, dt = robot.walk, robot.walk.sample_time
    steps: list[Step] = []
    feet = {side: (0.0, side * robot.posture.feet_apart / 2.0) for side in (-1, 1)}
    now = _samples(walk.standing, dt)
    knots = [(0, rest_zmp), (now, rest_zmp)]
    now += _samples(walk.double_support, dt)
    footholds, front_face = _footholds(robot, obstacle, key, leading)
    for index, (side, kind, x) in enumerate(footholds):
        over = walk.single_support_leg_2 if kind == LEG_2 else walk.single_support_over
        single = walk.single_support if kind == NORMAL else over
        double = walk.double_support if kind == NORMAL else walk.double_support_over
        end = (x, feet[side][1])
        step = Step(side, kind, feet[side], end, now, now + _samples(single, dt))
        knots += [(step.lift_off, np.array(feet[-side])), (step.touch_down, np.array(feet[-side]))]
        feet[side] = end
        steps.append(step)
        now = step.touch_down + _samples(double, dt)
        if index == len(footholds) - 1:
            knots.append((now, rest_zmp + np.mean([feet[1], feet[-1]], axis=0)))
    count = now + _samples(walk.standing, dt) + 1
    samples, corners = np.array([k for k, _ in knots]), np.array([p for _, p in knots])
    zmp = np.column_stack([np.interp(np.arange(count), samples, corners[:, axis]) for axis in (0, 1)])
    support, phase = np.zeros((2, count), dtype=int)
    for step in steps:
        support[step.lift_off : step.touch_down] = -step.side
    first, second = (next(step for step in steps if step.kind == kind) for kind in (LEG_1, LEG_2))
    phase[first.lift_off : first.touch_down] = 1
    phase[first.touch_down : second.lift_off] = 2
    phase[second.lift_off : second.touch_down] = 3
    return StepSequence(tuple(steps), np.arange(count) * dt, support, phase, zmp, front_face)


def _footholds(
    robot: Robot, obstacle: Obstacle, key: KeyConfiguration, leading: int
) -> tuple[list[tuple[int, int, float]], float]:
    """Side, kind and x of each step, and the obstacle's front face [m]."""
    walk, ahead = robot.walk, key.front_face(robot, obstacle)
    rear = 2.0 * walk.step_length if obstacle.distance is None else obstacle.distance - ahead
    count = max(1, int(np.ceil(rear / walk.step_length_max - 1e-9)))
    if rear < walk.step_length_min - 1e-9:
        nearest = dataclasses.replace(obstacle, distance=ahead + walk.step_length_min)
        raise Infeasible(
            f"the obstacle is nearer than the first step: at {obstacle.distance:.3f} m the rear foot would have to "
            f"stand at {rear:.3f} m, the shortest step is {walk.step_length_min:.3f} m",
            nearest,
        )
    approach: list[tuple[int, int, float]] = [
        (-leading if (count - i) % 2 == 0 else leading, BEFORE if i == count else NORMAL, rear * i / count)
        for i in range(1, count + 1)
    ]
    front = rear + key.x_ads
    over = robot.stepping_over.landing_step
    beyond = front + over + walk.step_length
    crossing: list[tuple[int, int, float]] = [
        (leading, LEG_1, front),
        (-leading, LEG_2, front + over),
        (leading, AFTER, beyond),
        (-leading, NORMAL, beyond + walk.step_length),
        (leading, NORMAL, beyond + walk.step_length),
    ]
    return approach + crossing, rear + ahead


def _samples(duration: float, dt: float) -> int:
    """Whole number of samples of a duration."""
    return round(duration / dt)
