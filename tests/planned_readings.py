"""What a robot would read if everything went as planned: the stabilizer's tests begin there."""

from __future__ import annotations

import dataclasses

import numpy as np

from stepover.control.dcm_feedback import DcmFeedback
from stepover.control.estimator import SIDES, Estimate
from stepover.control.reference import Reference, reference
from stepover.control.sensors import Sensed
from stepover.model import pose
from stepover.model.robot import Robot
from stepover.motion.motion import Motion


def planned_estimate(planned: Reference, sample: int) -> Estimate:
    """The robot as planned; loads and pressures are left to be filled in."""
    return Estimate(
        attitude=planned.attitude[sample], waist=planned.waist[sample, :3], com=planned.com[sample],
        com_velocity=planned.com_velocity[sample], dcm=planned.dcm[sample], zmp=planned.zmp[sample],
        loads=np.zeros(2), cops=np.zeros((2, 2)), soles=planned.soles[sample],
        weights=np.array({0: (0.5, 0.5), 1: (1.0, 0.0), -1: (0.0, 1.0)}[int(planned.support[sample])]),
        feet=planned.feet[sample],
    )  # fmt: skip


def changed(estimate: Estimate, **values: object) -> Estimate:
    """An estimate with other values."""
    return dataclasses.replace(estimate, **values)


def planned_wrenches(robot: Robot, motion: Motion) -> np.ndarray:
    """Wrenches (N, 2, 6) on both feet about the world's origin: RNEA's, shared as the stabilizer would share them."""
    planned = reference(robot, motion)
    feedback = DcmFeedback(robot, motion, planned)
    whole = robot.body.contact_wrench(motion.q, motion.dt)
    wrenches = np.zeros((len(whole), 2, 6))
    for sample, wrench in enumerate(whole):
        zmp = np.array([-wrench[4], wrench[3]]) / wrench[2]
        estimate = changed(planned_estimate(planned, sample), zmp=zmp)
        shares, cops = feedback.desired(sample, estimate).shared
        for foot in range(2):
            place = np.append(planned.soles[sample, foot, :2] + cops[foot], 0.0)
            wrenches[sample, foot, :3] = shares[foot] * wrench[:3]
            wrenches[sample, foot, 3:] = np.cross(place, shares[foot] * wrench[:3])
    return wrenches


def at_ankle(robot: Robot, q: np.ndarray, side: int, wrench: np.ndarray) -> np.ndarray:
    """A wrench (6,) about the world's origin as the sensor in an ankle reads it at a configuration (nq,)."""
    placed = robot.body.placements(q[None])
    joint = robot.body.index(robot.leg(side).joints[-1])
    turn, place = placed.rotations[0, joint], placed.positions[0, joint]
    return np.concatenate([wrench[:3] @ turn, (wrench[3:] - np.cross(place, wrench[:3])) @ turn])


def readings(robot: Robot, q: np.ndarray, wrenches: np.ndarray) -> Sensed:
    """What is read at a configuration (nq,) with wrenches (2, 6) about the world's origin."""
    left, right = (at_ankle(robot, q, side, wrench) for side, wrench in zip(SIDES, wrenches, strict=True))
    return Sensed(q[7:], q[3:7], np.zeros(3), left, right)


def pressed(robot: Robot, sole: np.ndarray, point: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Wrench (6,) about the world's origin of a force (3,) at a point (2,) of a sole (7,), from its middle."""
    place = pose.rotation(sole[None])[0] @ np.append(point, 0.0) + sole[:3]
    return np.concatenate([force, np.cross(place, force)])
