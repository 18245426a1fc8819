"""The command simulate: a motion in the physics, with disturbances if asked for, and filmed."""

from __future__ import annotations

import contextlib
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepover.cli.commands import NOT_CROSSED, Command, complain, progress, say
from stepover.cli.options import as_json, choice, motion_file, new_file, pairs, physics, robot_file
from stepover.errors import InvalidInput
from stepover.extras import needs

if TYPE_CHECKING:
    from stepover.model.robot import Robot
    from stepover.simulation.measurements import Run


class _Disturbed(Command):
    """A command whose help ends with all disturbances."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write them as a list, with units and ranges."""
        from stepover.simulation.disturbances import explained

        with formatter.section("Disturbances, for --perturb"):
            formatter.write_dl(explained())


@click.command(cls=_Disturbed)
@motion_file
@physics()
@choice("--engine", ("pybullet", "mujoco"), "The physics engine.")
@robot_file
@click.option("--stabilizer/--no-stabilizer", default=False, show_default=True, help="Feedback from the sensors.")
@click.option("--perturb", multiple=True, metavar="NAME=VALUE", callback=pairs, help="A disturbance, as listed below.")
@new_file("--video", "Film it from the side", ".mp4")
@as_json
def simulate(
    motion: str,
    actuators: str,
    sole: str,
    engine: str,
    robot: str | None,
    stabilizer: bool,
    perturb: dict[str, str],
    video: Path | None,
    as_json: bool,
) -> None:
    """Carry out a planned motion in the physics simulation.

    Ends with exit code 4 where the robot falls or touches the obstacle; a plot of the second before it then goes
    beside the video, or beside the motion.

    Example: python -m stepover simulate motion.npz --video motion.mp4
    """
    from stepover.motion.motion import Motion
    from stepover.report import summary
    from stepover.robots.loading import load_robot
    from stepover.simulation.run import simulate as run_simulation

    if video is not None:
        from stepover.simulation.pybullet.video import record  # before the run: what it lacks is said at once

    disturbances = {name: _number(name, text) for name, text in perturb.items()} or None
    planned = Motion.load(motion)
    model = load_robot(robot or planned.robot_name)
    run = run_simulation(
        planned, actuators=actuators, sole=sole, stabilizer=stabilizer, perturb=disturbances, robot=model, engine=engine
    )
    if video is not None:
        with progress("filming") as advance:
            record(run, video, robot=model, progress=advance)
    say(summary.as_line(run.to_json()) if as_json else summary.run_summary(run))
    if video is not None and not as_json:
        say(f"\nfilmed in {video}")
    if not run.crossed:
        complain(f"{run.explanation}; {plot_failure(run, video or Path(motion), model)}", NOT_CROSSED)


def _number(name: str, text: str) -> float:
    """A finite number out of name=value."""
    with contextlib.suppress(ValueError):
        if math.isfinite(float(text)):
            return float(text)
    raise InvalidInput(f"{name} = {text!r} must be a finite number")


def plot_failure(run: Run, beside: Path, robot: Robot) -> str:
    """Plot the second before the failure beside a file, or in build/; say where, or why there is none."""
    try:
        with needs("a plot of the second before it"):
            from stepover.report import figures
    except InvalidInput as error:
        return str(error)
    folder = beside.parent if os.access(beside.parent, os.W_OK) else Path("build")
    path = folder / f"{beside.stem}_failure.png"
    try:
        folder.mkdir(exist_ok=True)
        figures.save(figures.failure(robot, run), path)
    except (InvalidInput, OSError) as error:
        return f"the second before it is not drawn: {error}"
    return f"the second before it is drawn in {path}"
