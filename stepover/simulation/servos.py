"""Servos with limits, and the rubber of compliant soles: torques that are computed anew at every time step.

Both are springs with dampers, and stiff ones on light links: the damping of an ankle servo turns the velocity of a
free foot around within one step of 1 ms, so that explicit torques would shake it. A real joint has the inertia of its
rotor on top, which is not published for HRP-2 and which PyBullet does not know. So the torques are those that belong
to the end of the step, after Tan, Liu, Turk (2011); for the acceleration on the way there it counts which corners of
the feet stood on the floor in the step before, since a foot on the floor does not give way.
"""

from __future__ import annotations

import numpy as np

from stepover.model.implicit import Prediction
from stepover.model.robot import Robot
from stepover.simulation.motors import Course
from stepover.simulation.pybullet.description import BUSH
from stepover.simulation.pybullet.world import World

STIFFER = 10.0
"""Ideal motors on rubber are servos so many times as stiff, without limits: PyBullet's own position control lets two
feet on the floor fight each other through the rubber."""


class Servos:
    """Springs in the joints: the motors, limited or not, and the bushes where there are any."""

    def __init__(self, robot: Robot, world: World, limited: bool) -> None:
        """Take hold of a world's joints."""
        self._world, self._dt = world, robot.simulation.time_step
        self._joints = world.joints + world.passive
        world.release(self._joints)
        self._stiffness, self._damping = springs(robot, len(world.passive) // len(BUSH), 1.0 if limited else STIFFER)
        self._armature = self._dt * (self._damping + self._dt * self._stiffness)
        names = robot.body.joint_names + world.description.passive
        points = _points(robot, world)
        self._prediction = Prediction(world.description.text(), names, self._armature, points, self._dt)
        self._prediction.set_gravity(world.gravity)
        self._limits = robot.body.effort_limits if limited else np.full(len(world.joints), np.inf)
        self._speed_limits, self._fade = robot.body.speed_limits, robot.servo.speed_fade
        self._goal, self._speed = np.zeros((2, len(self._joints)))
        self._standing: tuple[int, ...] = ()
        self.torque, self.saturated = np.zeros(len(world.joints)), np.zeros(len(world.joints), dtype=bool)

    def drive(self, course: Course, step: int) -> None:
        """Torques for one time step: those of the springs and dampers at its end."""
        count = len(self.torque)
        self._goal[:count], self._speed[:count] = course.angles[step + 1], course.speeds[step]
        angles, speeds = self._world.joint_motion(self._joints)
        wanted = self._stiffness * (self._goal - angles - self._dt * speeds) + self._damping * (self._speed - speeds)
        pose, twist = self._world.base_motion()
        wanted -= self._armature * self._prediction.acceleration(pose, twist, angles, speeds, wanted, self._standing)
        self.torque = wanted[:count] = self._limited(wanted[:count], speeds[:count])
        self.saturated = np.abs(self.torque) >= self._limits
        self._world.drive(self._joints, wanted)

    def look(self, contacts: list[tuple]) -> None:
        """See which corners of the feet stood on the floor."""
        bearing = self._world.standing(contacts)
        corners: set[int] = set()
        for foot in (0, 1):
            places = [c[5] for c in bearing if self._world.foot_of(c) == foot]
            if places:
                corners.update((4 * foot + self._prediction.nearest(foot, np.array(places))).tolist())
        self._standing = tuple(sorted(corners))

    def _limited(self, wanted: np.ndarray, speeds: np.ndarray) -> np.ndarray:
        """Torques within the limits; those that accelerate fade below a joint's speed limit to none at it."""
        if np.isinf(self._limits[0]):
            return wanted
        share = speeds / self._speed_limits
        most = np.minimum((1.0 - share) / self._fade, 1.0) * self._limits
        least = np.minimum((1.0 + share) / self._fade, 1.0) * self._limits
        return np.minimum(np.maximum(wanted, -np.maximum(least, 0.0)), np.maximum(most, 0.0))


def springs(robot: Robot, bushes: int, stiffer: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness [N m/rad, N/m] and damping [N m s/rad, N s/m] of all servos and of some bushes: (nq - 7 + 3 B,)."""
    stiffness = stiffer * robot.servo.stiffness_per_torque * robot.body.effort_limits
    legs = [robot.body.column(joint) - 7 for joint in (*robot.legs.left, *robot.legs.right)]
    stiffness[legs] = stiffer * robot.servo.leg_stiffness
    rubber = robot.sole
    spring = [rubber.vertical_stiffness, rubber.tilt_stiffness, rubber.tilt_stiffness]
    damper = [rubber.vertical_damping, rubber.tilt_damping, rubber.tilt_damping]
    damping = robot.servo.damping_time * stiffness
    return np.concatenate([stiffness, spring * bushes]), np.concatenate([damping, damper * bushes])


def _points(robot: Robot, world: World) -> list[tuple[str, np.ndarray]]:
    """Of the left and the right foot the joint that moves the sole, and the corners of its contact patch."""
    description = world.description
    points = []
    for row, (side, leg) in enumerate(((1, robot.legs.left), (-1, robot.legs.right))):
        joint = description.passive[len(BUSH) * row + len(BUSH) - 1] if description.passive else leg[-1]
        depth = description.bush_height - robot.foot.ankle_height
        points.append((joint, np.column_stack([robot.contact_patch(side), np.full(4, depth)])))
    return points
