"""The command plan: an obstacle's size in, a motion out."""

from __future__ import annotations

from pathlib import Path

import click

from stepover.cli.commands import progress
from stepover.cli.options import as_json, margins, new_file, planner_choices


@click.command()
@click.option("--robot", default="hrp2", show_default=True, help="A name under data/, or a path to a robot.toml.")
@click.option("--height", type=float, required=True, help="Height of the bare obstacle [m].")
@click.option("--width", type=float, required=True, help="Width of the bare obstacle, along the way [m].")
@margins
@click.option("--distance", type=float, help="From between the ankles to its front face [m]; default: nominal steps.")
@planner_choices
@new_file("--output", "Where the motion goes", ".npz", required=True)
@new_file("--csv", "Also as a table, one sample a row", ".csv")
@as_json
def plan(
    robot: str,
    height: float,
    width: float,
    margin_height: float,
    margin_width: float,
    distance: float | None,
    arms: str,
    speed_limits: str,
    output: Path,
    csv: Path | None,
    as_json: bool,
) -> None:
    """Plan how to step over an obstacle, and write the motion to a file.

    Example: python -m stepover plan --height 0.15 --width 0.05 --output motion.npz
    """
    from stepover.model.obstacle import Obstacle
    from stepover.planning.algorithm_1.planner import plan_in_detail
    from stepover.report import summary
    from stepover.robots.loading import load_robot

    model, obstacle = load_robot(robot), Obstacle(height, width, margin_height, margin_width, distance)
    with progress("not this one; looking for the nearest that can be stepped over") as advance:
        planned = plan_in_detail(model, obstacle, arms=arms, speed_limits=speed_limits, progress=advance)
    result = summary.plan_to_json(model, obstacle, planned)
    planned.motion.save(output)
    if csv is not None:
        planned.motion.save_csv(csv)
    click.echo(summary.as_line(result) if as_json else f"{summary.plan_summary(result)}\n\nwritten to {output}")
