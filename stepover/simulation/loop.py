"""The physics, step by step: the one loop that carries a motion out, and lets observers watch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stepover.model.parameters.physics import Simulation
from stepover.model.pose import axes
from stepover.motion.motion import Motion
from stepover.simulation.commands import Commands
from stepover.simulation.disturbances import Disturbances
from stepover.simulation.engine import NO_CONTACTS, Engine
from stepover.simulation.observers import Observer, Sample
from stepover.simulation.touch import NOTHING, Touch, summed_up
from stepover.simulation.trajectory import JointTrajectory


class Fall(NamedTuple):
    """A fall: the sample that shows it, and the beginning of a sentence that says how."""

    sample: int
    reason: str


def carry_out(
    engine: Engine, motion: Motion, commands: Commands, observers: Sequence[Observer], until: int | None = None
) -> Fall | None:
    """Carry a motion out.

    Args:
        engine: the world, with the robot anywhere.
        motion: what is planned.
        commands: what the motors are told.
        observers: who watches, called in this order.
        until: the sample at which the simulation ends, whatever happens; None: the motion's last one, or a while
            (simulation.after_fall) after a fall.

    Returns:
        The first fall, or None.
    """
    parameters, disturbances = engine.scene.robot.simulation, engine.scene.disturbances
    last = len(motion.time) - 1 if until is None else until
    floor = floor_changes(motion, disturbances)
    engine.reset(motion.q[0])
    if floor:
        engine.set_ground(0, 0.0)
    fall: Fall | None = None
    contacts, touch, torque, saturated = NO_CONTACTS, NOTHING, engine.torque, engine.saturated
    for k in range(last + 1):
        base, (angles, speeds) = engine.base_pose(), engine.joints()
        commands.sense(touch)
        reason = has_fallen(parameters, base, motion.waist[k], touch) if k and not fall else None
        if reason:
            fall = Fall(k, reason)
            last = min(last, k + round(parameters.after_fall / motion.dt)) if until is None else last
        q = np.concatenate([base, angles])
        sample = Sample(k, last, q, speeds, torque, saturated, engine.bush(), contacts, touch, commands.estimate)
        for observer in observers:
            observer.sampled(sample)
        if k == last:
            break
        for side, height in floor.get(k, ()):
            engine.set_ground(0 if side > 0 else 1, height)
        trajectory = commands.trajectory(k + 1)
        torque, saturated = _one_sample(engine, trajectory, motion.time[k], observers)
        contacts = engine.contacts()
        touch = summed_up(contacts, engine.links, len(trajectory))
    return fall


def _one_sample(
    engine: Engine, trajectory: JointTrajectory, time: float, observers: Sequence[Observer]
) -> tuple[np.ndarray, np.ndarray]:
    """The time steps of a trajectory, which begins at a time [s].

    Returns:
        Mean motor torques (J,), and which motors were saturated in any step.
    """
    disturbances, time_step = engine.scene.disturbances, engine.scene.robot.simulation.time_step
    torque, saturated = np.zeros(len(engine.torque)), np.zeros(len(engine.torque), dtype=bool)
    for step, (start, end, speed) in enumerate(trajectory):
        engine.command(start, end, speed)
        if disturbances.pushes:
            engine.push(disturbances.push(time + step * time_step))
        engine.step()
        for observer in observers:
            observer.stepped(engine)
        torque += engine.torque
        saturated |= engine.saturated
    return torque / len(trajectory), saturated


def has_fallen(parameters: Simulation, waist: np.ndarray, planned: np.ndarray, touch: Touch) -> str | None:
    """Why a robot counts as fallen, as the beginning of a sentence; None while it stands.

    Args:
        parameters: of the simulation, for the limits.
        waist: (7,) measured pose.
        planned: (7,) planned pose.
        touch: what touches it.
    """
    up, planned_up = (axes(x[3:].tolist())[:, 2] for x in (waist, planned))
    tilt = math.degrees(math.acos(min(max(up @ planned_up, -1.0), 1.0)))
    drop = float(planned[2] - waist[2])
    if touch.others:
        return f"the floor is touched by {' and '.join(sorted(touch.others))}"
    if tilt > parameters.fall_tilt_deg:
        return f"the waist is tilted by {tilt:.0f} degrees against the plan"
    if drop > parameters.fall_drop:
        return f"the waist is {1e3 * drop:.0f} mm below the plan"
    return None


def floor_changes(motion: Motion, disturbances: Disturbances) -> dict[int, list[tuple[int, float]]]:
    """When the floor of a foot moves, in the middle of the swing to each foothold: by sample, side and height [m]."""
    heights = disturbances.floor(motion)
    changes: dict[int, list[tuple[int, float]]] = {}
    if not heights.any():
        return changes
    for touch_down, side, height in zip(motion.footsteps.time, motion.footsteps.side, heights, strict=True):
        landing = int(np.searchsorted(motion.time, touch_down - 1e-9))
        if landing == len(motion.time):
            continue  # a motion that was cut
        swinging = motion.support[:landing] == -side
        still = np.flatnonzero(~swinging[: int(np.flatnonzero(swinging)[-1])])
        lift_off = int(still[-1]) if len(still) else 0
        changes.setdefault((lift_off + landing) // 2, []).append((int(side), float(height)))
    return changes
