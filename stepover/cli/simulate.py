"""The command simulate: run a motion in the physics simulation, optionally with disturbances and a video."""

from __future__ import annotations

import contextlib
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stepover.cli.commands import NOT_CROSSED, Command, complain, progress, say
from stepover.cli.options import as_json, motion_file, new_file, pairs, physics, robot_file
from stepover.errors import InvalidInput
from stepover.extras import needs

if TYPE_CHECKING:
    from stepover.model.robot import Robot
    from stepover.simulation.measurements import Run


class _Disturbed(Command):
    """A command whose help ends with the list of disturbances."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list, with units and ranges."""
        from stepover.simulation.disturbances import explained

        with formatter.section("Disturbances, for --perturb"):
            formatter.write_dl(explained())


@click.command(cls=_Disturbed)
@motion_file
@physics()
@robot_file
@click.option("--stabilizer/--no-stabilizer", default=False, show_default=True, help="Balance with sensor feedback.")
@click.option(
    "--perturb",
    multiple=True,
    metavar="NAME=VALUE",
    callback=pairs,
    help="A disturbance from the list below; may be repeated.",
)
@new_file("--video", "Write a video from the side", ".mp4")
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

    If the robot falls or touches the obstacle, the exit code is 4. A plot of the last second before the failure is
    then written beside the video, or beside the motion if there is no video.

    Example: python -m stepover simulate motion.npz --video motion.mp4
    """
    from stepover.motion.motion import Motion
    from stepover.report import summary
    from stepover.robots.loading import load_robot
    from stepover.simulation.run import simulate as run_simulation

    if video is not None:
        with needs("a video"):  # before the run
            from stepover.report.render.film import record

    disturbances = {name: _number(name, text) for name, text in perturb.items()} or None
    planned = Motion.load(motion)
    model = load_robot(robot or planned.robot_name)
    run = run_simulation(
        planned, actuators=actuators, sole=sole, stabilizer=stabilizer, perturb=disturbances, robot=model, engine=engine
    )
    if video is not None:
        with progress("writing the video") as advance:
            record(run, video, robot=model, progress=advance)
    say(summary.as_line(run.to_json()) if as_json else summary.run_summary(run))
    if video is not None and not as_json:
        say(f"\nvideo written to {video}")
    if not run.crossed:
        complain(f"{run.explanation}; {plot_failure(run, video or Path(motion), model)}", NOT_CROSSED)


def _number(name: str, text: str) -> float:
    """The finite number in name=value."""
    with contextlib.suppress(ValueError):
        if math.isfinite(float(text)):
            return float(text)
    raise InvalidInput(f"{name} = {text!r} must be a finite number")


def plot_failure(run: Run, beside: Path, robot: Robot) -> str:
    """Plot the last second before the failure, beside a file or in build/. Say where it is, or why there is none."""
    try:
        with needs("a plot of the last second before the failure"):
            from stepover.report import figures
    except InvalidInput as error:
        return str(error)
    folder = beside.parent if os.access(beside.parent, os.W_OK) else Path("build")
    path = folder / f"{beside.stem}_failure.png"
    try:
        folder.mkdir(exist_ok=True)
        figures.save(figures.failure(robot, run), path)
    except (InvalidInput, OSError) as error:
        return f"there is no plot of the last second before it: {error}"
    return f"a plot of the last second before it is in {path}"
