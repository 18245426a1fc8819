"""Carry out a motion in the physics and measure it: the simulation of Sec. V, in another engine than OpenHRP."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

from stepover.control.stabilizer import Stabilizer
from stepover.errors import InvalidInput, require_type
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.robots.loading import load_robot
from stepover.simulation.commands import commands_of
from stepover.simulation.disturbances import Disturbances
from stepover.simulation.engine import DEFAULT, Scene, engine_named
from stepover.simulation.judging import measured
from stepover.simulation.loop import carry_out
from stepover.simulation.measurements import Run
from stepover.simulation.observers import Progress
from stepover.simulation.recording import Recording

AVAILABLE: dict[str, tuple[object, ...]] = {
    "actuators": ("ideal", "limited"), "sole": ("rigid", "compliant"), "stabilizer": (False, True),
}  # fmt: skip
"""Allowed values of each option of simulate."""


def simulate(
    motion: Motion,
    *,
    actuators: str = "ideal",
    sole: str = "rigid",
    stabilizer: bool = False,
    perturb: Mapping[str, float] | None = None,
    robot: Robot | None = None,
    obstacle: bool = True,
    engine: str = DEFAULT,
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Carry out a motion in the physics. Each run starts with a new world, so two runs are equal to the bit.

    Args:
        motion: from plan or Motion.load.
        actuators: "ideal": position-controlled motors without limits, as in the paper's simulation; "limited":
            servos with stiffness, damping and limits of torque and speed.
        sole: "rigid", or "compliant": rubber between ankle and sole.
        stabilizer: whether sensor feedback corrects the planned joint angles.
        perturb: disturbances by name; see simulation.disturbances.Disturbances.
        robot: the robot; default: the one named in the motion.
        obstacle: whether the bare obstacle stands in the world.
        engine: name of the physics engine; see simulation.engine.
        progress: called now and then with the share done, 0 to 1.

    Raises:
        InvalidInput: an option or an engine is not available, or the motion was planned for another robot.
    """
    require_type("motion", motion, Motion, "what plan(...) or Motion.load(...) returns")
    how = {"actuators": actuators, "sole": sole, "stabilizer": stabilizer}
    for name, value in how.items():
        if value not in AVAILABLE[name]:
            known = ", ".join(str(x) for x in AVAILABLE[name])
            raise InvalidInput(f"{name} = {value!r} is not available; available: {known}")
    disturbances = Disturbances.read(perturb or {}, motion)
    robot = load_robot(motion.robot_name) if robot is None else robot
    require_type("robot", robot, Robot, "load_robot(...)")
    motion.require_robot(robot)
    if len(motion.obstacles) > 1 or motion.obstacles[0, 6] != 0.0:
        raise InvalidInput("the simulation takes one obstacle, square to the path; the motion has others")
    build, real = engine_named(engine), disturbances.obstacle(motion.obstacle)
    scene = Scene(robot, (real,) if obstacle else (), actuators, sole, disturbances)
    begin = time.perf_counter()
    with build(scene) as world:
        recording = Recording(motion, world)
        controller = Stabilizer(robot, motion, rubber=sole == "compliant") if stabilizer else None
        observers = [recording, *([Progress(progress)] if progress else [])]
        fall = carry_out(world, motion, commands_of(controller, motion, world), observers)
    factor = float(motion.time[recording.count - 1] - motion.time[0]) / (time.perf_counter() - begin)
    rectangle = Obstacle(height=real[2], width=real[1]).profile(real[0], margins=False)
    rest = {**how, "perturb": dict(perturb or {}), "engine": engine, "realtime_factor": factor}
    return measured(robot, motion, recording, fall, rectangle, rest)
