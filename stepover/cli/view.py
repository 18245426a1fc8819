"""The command view: a motion as a page in 3-D."""

from __future__ import annotations

from pathlib import Path

import click

from stepover.cli.commands import Command, say
from stepover.cli.options import motion_file, new_file, robot_file


@click.command(cls=Command)
@motion_file
@new_file("--output", "Where the page goes", ".html", required=True)
@click.option("--time", type=float, help="Moment shown before it is played [s]; default: the first.")
@robot_file
def view(motion: str, output: Path, time: float | None, robot: str | None) -> None:
    """Write a page that shows a planned motion in 3-D, to be opened in any browser, offline.

    It holds the robot, the obstacle with its margins, the footsteps and the ways of ZMP and CoM, to be turned with the
    mouse, played, paused and scrubbed.

    Example: python -m stepover view motion.npz --output motion.html
    """
    from stepover.motion.motion import Motion
    from stepover.report.viewer import save_page
    from stepover.robots.loading import load_robot

    planned = Motion.load(motion)
    save_page(load_robot(robot or planned.robot_name), planned, output, time)
    say(f"written to {output}; open it in a browser")
