"""A motion carried out in the physics, and what was measured: Sec. V's simulation, with PyBullet for OpenHRP."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.robot import Robot, load_robot
from stepover.motion import Motion
from stepover.simulation.measurements import Run, measured
from stepover.simulation.motors import IdealMotors
from stepover.simulation.recording import Recording, has_fallen
from stepover.simulation.world import Touch, World

AVAILABLE: dict[str, tuple[object, ...]] = {
    "actuators": ("ideal",), "sole": ("rigid",), "stabilizer": (False,), "perturb": (None, {}),
}  # fmt: skip
"""Values that each option of simulate may have."""


def simulate(
    motion: Motion,
    *,
    actuators: str = "ideal",
    sole: str = "rigid",
    stabilizer: bool = False,
    perturb: dict[str, float] | None = None,
    robot: Robot | None = None,
    obstacle: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Carry a motion out in PyBullet, open loop: a fresh world each time, so that two runs are equal to the bit.

    Args:
        motion: from plan or Motion.load.
        actuators: "ideal": position-controlled motors without limits, as in the paper's simulation.
        sole: "rigid".
        stabilizer: False.
        perturb: None.
        robot: the motion's own unless given.
        obstacle: put the bare obstacle into the world.
        progress: called now and then with the share done, 0 to 1.

    Raises:
        InvalidInput: an option that is not available, or a robot that the motion is not for.
    """
    options = {"actuators": actuators, "sole": sole, "stabilizer": stabilizer, "perturb": perturb}
    for name, value in options.items():
        if value not in AVAILABLE[name]:
            known = ", ".join(str(x) for x in AVAILABLE[name])
            raise InvalidInput(f"{name} = {value!r} is not available; available: {known}")
    robot = robot or load_robot(motion.robot)
    if list(motion.joint_names) != robot.body.joint_names:
        raise InvalidInput(f"the motion is for {motion.robot!r}: its joints are not those of {robot.name!r}")
    motors = IdealMotors(motion, robot.simulation)
    begin = time.perf_counter()
    with World(robot, motion.obstacle if obstacle else None) as world:
        recording, fall = _carry_out(world, robot, motion, motors, progress or (lambda share: None))
    factor = float(motion.time[recording.count - 1] - motion.time[0]) / (time.perf_counter() - begin)
    how = {"actuators": actuators, "sole": sole, "stabilizer": stabilizer, "realtime_factor": factor}
    return measured(robot, motion, recording, fall, how)


def _carry_out(
    world: World, robot: Robot, motion: Motion, motors: IdealMotors, progress: Callable[[float], None]
) -> tuple[Recording, tuple[int, str] | None]:
    """The physics itself: to the end of the motion, or a while after a fall.

    Returns:
        What was recorded; the sample of a fall and what it shows by, or None.
    """
    parameters, count = robot.simulation, len(motion.time)
    recording = Recording(count, len(motion.joint_names))
    fall: tuple[int, str] | None = None
    last = count - 1
    world.reset(motion.q[0])
    recording.add(world, Touch(np.zeros((2, 6)), np.zeros(6), set(), {}), np.zeros(len(motion.joint_names)))
    while recording.count <= last:
        k = recording.count
        touch, torque = _one_sample(world, motors, k - 1)
        recording.add(world, touch, torque)
        reason = None if fall else has_fallen(parameters, recording.q[k, :7], motion.waist[k], touch)
        if reason:
            fall = k, reason
            last = min(last, k + round(parameters.after_fall / motion.dt))
        if k % 100 == 0 or k == last:
            progress(k / last)
    return recording, fall


def _one_sample(world: World, motors: IdealMotors, sample: int) -> tuple[Touch, np.ndarray]:
    """The time steps from one sample to the next: mean wrenches and findings, mean motor torques (nq - 7,)."""
    contacts, torque = [], np.zeros(motors.angles.shape[1])
    for step in range(sample * motors.steps, (sample + 1) * motors.steps):
        motors.drive(world, step)
        world.step()
        contacts += world.contacts()
        torque += world.joint_states()[2]
    return world.touch(contacts, motors.steps), torque / motors.steps
