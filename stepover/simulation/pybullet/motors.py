"""Motors in PyBullet: ideal ones, and springs in the joints whose torques are computed anew at every time step.

Servos and rubber are springs with dampers, and stiff ones on light links: the damping of an ankle servo turns the
velocity of a free foot around within one step of 1 ms, so that explicit torques would shake it. A real joint has the
inertia of its rotor on top, which is not published for HRP-2 and which PyBullet does not know. So the torques are those
that belong to the end of the step, after Tan, Liu, Turk (2011), and so do the limits. For the acceleration on the way
there it counts which corners of the feet stood on the floor in the step before, since a foot on the floor does not give
way.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from stepover.model.description.urdf_text import urdf_text
from stepover.model.implicit import Prediction
from stepover.model.robot import Robot
from stepover.simulation.engine import Scene
from stepover.simulation.pybullet.robot import Body
from stepover.simulation.pybullet.surroundings import Point
from stepover.simulation.servos import fading, springs, within_limits
from stepover.simulation.simulated import SimulatedRobot
from stepover.simulation.soles import BUSH

STIFFER = 10.0
"""Ideal motors on rubber are servos so many times as stiff, without limits: PyBullet's own position control lets two
feet on the floor fight each other through the rubber."""


class Motors(Protocol):
    """Motors of all joints.

    Attributes:
        torque: (J,) of the last step [N m].
        saturated: (J,) whether the last step took all the torque that a motor has.
    """

    torque: np.ndarray
    saturated: np.ndarray

    def command(self, start: np.ndarray, end: np.ndarray, speed: np.ndarray) -> None:
        """Drive the next step: as Engine.command."""

    def look(self, on_floor: Sequence[Point]) -> None:
        """Take notice of a step that has passed, and of its contact points on the floor."""


class IdealMotors:
    """Position-controlled motors that follow without any limit that they could reach."""

    def __init__(self, scene: Scene, body: Body) -> None:
        """Take hold of the joints."""
        self._body, self._parameters = body, scene.robot.simulation
        self.torque, self.saturated = np.zeros(len(body.joints)), np.zeros(len(body.joints), dtype=bool)

    def command(self, start: np.ndarray, end: np.ndarray, speed: np.ndarray) -> None:
        """From the start, with the speed."""
        torque, correction = self._parameters.ideal_motor_torque, self._parameters.ideal_motor_correction
        self._body.follow(start, speed, torque, correction)

    def look(self, on_floor: Sequence[Point]) -> None:
        """Read the torques that the step took."""
        self.torque = self._body.motor_torques()


class Servos:
    """Springs in the joints: the motors, limited or not, and the bushes where there are any."""

    def __init__(self, scene: Scene, body: Body, simulated: SimulatedRobot) -> None:
        """Take hold of the joints."""
        robot, limited = scene.robot, scene.actuators == "limited"
        self._robot, self._body, self._dt = robot, body, robot.simulation.time_step
        self._joints = body.joints + body.passive
        body.release(self._joints)
        self._stiffness, self._damping = springs(robot, len(body.passive) // len(BUSH), 1.0 if limited else STIFFER)
        self._armature = self._dt * (self._damping + self._dt * self._stiffness)
        names, points = [*robot.body.joint_names, *simulated.passive], _points(robot, simulated)
        self._prediction = Prediction(urdf_text(simulated.description), names, points, self._dt)
        self._prediction.set_gravity(scene.disturbances.gravity)
        self._limited = limited
        self._limits = robot.body.effort_limits if limited else np.full(len(body.joints), np.inf)
        self._goal, self._speed = np.zeros((2, len(self._joints)))
        self._standing: tuple[int, ...] = ()
        self._state: tuple[np.ndarray, ...] = ()
        self.torque, self.saturated = np.zeros(len(body.joints)), np.zeros(len(body.joints), dtype=bool)

    def command(self, start: np.ndarray, end: np.ndarray, speed: np.ndarray) -> None:
        """Torques of the springs and dampers at the end of the step."""
        count = len(self.torque)
        self._goal[:count], self._speed[:count] = end, speed
        angles, speeds = self._body.joint_motion(self._joints)
        self._state = *self._body.base_motion(), angles, speeds
        wanted = self._stiffness * (self._goal - angles - self._dt * speeds) + self._damping * (self._speed - speeds)
        torque, speeds = self._at_end(wanted, self._armature)
        if self._limited:
            torque = self._within_limits(wanted, torque, speeds)
        self.torque = torque[:count]
        self.saturated = np.abs(self.torque) >= self._limits
        self._body.drive(self._joints, torque)

    def _at_end(self, wanted: np.ndarray, armature: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Torques and joint speeds at the end of the step, from torques (J + 3 B,) at its beginning."""
        pose, twist, angles, speeds = self._state
        acceleration = self._prediction.acceleration(pose, twist, angles, speeds, wanted, self._standing, armature)
        return wanted - armature * acceleration, speeds + self._dt * acceleration

    def _within_limits(self, wanted: np.ndarray, torque: np.ndarray, speeds: np.ndarray) -> np.ndarray:
        """Torques at the end of the step, of servos that have limits then.

        A torque that fades near the speed limit is a damper, far stiffer than the servo's own. Taken from the beginning
        of the step, it would let a joint overshoot its speed limit and brake in turns.

        Args:
            wanted: torques at the beginning of the step.
            torque: torques at its end without limits.
            speeds: joint speeds at its end without limits.
        """
        count = len(self.torque)
        within = within_limits(self._robot, torque[:count], speeds[:count])
        beyond = np.flatnonzero(within != torque[:count])
        if len(beyond):
            line, slope = fading(self._robot, torque[:count], self._state[3][:count])
            full = np.abs(within) >= self._limits
            wanted, armature, sign = wanted.copy(), self._armature.copy(), np.sign(torque[beyond])
            wanted[beyond] = np.where(full, within, line)[beyond]
            armature[beyond] = np.where(full, 0.0, self._dt * slope)[beyond]
            torque, _ = self._at_end(wanted, armature)
            torque[beyond] = sign * np.maximum(sign * torque[beyond], 0.0)
            torque[:count] = np.minimum(np.maximum(torque[:count], -self._limits), self._limits)
        return torque

    def look(self, on_floor: Sequence[Point]) -> None:
        """See which corners of the feet stood on the floor."""
        corners: set[int] = set()
        for foot in (0, 1):
            places = [point[5] for point in on_floor if self._body.feet.get(point[3]) == foot]
            if places:
                corners.update((4 * foot + self._prediction.nearest(foot, np.array(places))).tolist())
        self._standing = tuple(sorted(corners))


def motors_of(scene: Scene, body: Body, simulated: SimulatedRobot) -> Motors:
    """The motors that a scene asks for; on rubber, ideal ones are stiff servos."""
    if scene.actuators == "ideal" and not body.passive:
        return IdealMotors(scene, body)
    return Servos(scene, body, simulated)


def _points(robot: Robot, simulated: SimulatedRobot) -> list[tuple[str, np.ndarray]]:
    """Of the left and the right foot the joint that moves the sole, and the corners of its contact patch."""
    points = []
    for row, (side, leg) in enumerate(((1, robot.legs.left), (-1, robot.legs.right))):
        joint = simulated.passive[len(BUSH) * row + len(BUSH) - 1] if simulated.passive else leg[-1]
        depth = simulated.bush_depth - robot.foot.ankle_height
        points.append((joint, np.column_stack([robot.contact_patch(side), np.full(4, depth)])))
    return points
