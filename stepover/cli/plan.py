"""The command plan: an obstacle's size in, a motion out."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from stepover.cli.commands import Command, progress, say
from stepover.cli.options import as_json, choice, margins, new_file, planner_choices
from stepover.errors import InvalidInput
from stepover.planning.planner import PLANNERS, find_planner

if TYPE_CHECKING:
    from stepover.model.obstacle import Obstacle
    from stepover.model.robot import Robot
    from stepover.motion.motion import Motion
    from stepover.planning.optimal.search import Progress, Report

OWN = {"paper": ("arms", "speed_limits", "extras"), "quasi-static": ("epsilon",), "optimal": ("time",)}
"""Options that only one planner has."""


def _time(context: click.Context, parameter: click.Parameter, value: str | None) -> float | str | None:
    """A number where it is one; the planner says what else it takes."""
    try:
        return value if value is None else float(value)
    except ValueError:
        return value


@click.command(cls=Command)
@click.option("--robot", default="hrp2", show_default=True, help="A name under data/, or a path to a robot.toml.")
@click.option("--height", type=float, required=True, help="Height of the bare obstacle [m].")
@click.option("--width", type=float, required=True, help="Width of the bare obstacle, along the path [m].")
@margins
@click.option("--distance", type=float, help="From the ankles to its front face [m]; default: set by nominal steps.")
@choice(
    "--planner",
    tuple(PLANNERS),
    "The paper's Algorithm 1, an optimiser that keeps all limits, or the baseline.",
)
@planner_choices
@click.option(
    "--extras/--no-extras", default=True, show_default=True,
    help="Whether the paper's planner may use the methods added beyond the paper.",
)  # fmt: skip
@click.option(
    "--epsilon", type=float, default=0.001, show_default=True,
    help="Quasi-static planner: largest distance between the ZMP and the CoM's projection [m].",
)  # fmt: skip
@click.option(
    "--time", callback=_time, metavar="SECONDS|best",
    help="Optimiser: length of each single support over the obstacle [s], or the shortest that keeps all limits; "
    "default: as the robot walks.",
)  # fmt: skip
@new_file("--output", "File for the motion", ".npz", required=True)
@new_file("--csv", "Also write a table with one row for each sample", ".csv")
@as_json
@click.pass_context
def plan(
    context: click.Context,
    robot: str,
    height: float,
    width: float,
    margin_height: float,
    margin_width: float,
    distance: float | None,
    planner: str,
    output: Path,
    csv: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Plan a motion over an obstacle and write it to a file.

    Example: python -m stepover plan --height 0.15 --width 0.05 --output motion.npz
    """
    own = {name: options[name] for name in OWN.get(planner, ())}
    for name in options.keys() - own.keys():
        if context.get_parameter_source(name) == ParameterSource.COMMANDLINE:
            owner = next(other for other, names in OWN.items() if name in names)
            raise InvalidInput(f"--{name.replace('_', '-')} is an option of the planner {owner!r}, not of {planner!r}")
    from stepover.model.obstacle import Obstacle
    from stepover.report import summary
    from stepover.robots.loading import load_robot

    model, obstacle = load_robot(robot), Obstacle(height, width, margin_height, margin_width, distance)
    motion, result = _planned(planner, model, obstacle, own)
    motion.save(output)
    if csv is not None:
        motion.save_csv(csv)
    say(summary.as_line(result) if as_json else f"{summary.plan_summary(result)}\n\nwritten to {output}")


@contextlib.contextmanager
def iterations() -> Iterator[Report]:
    """A bar on stderr, if that is a terminal: the obstacle at hand, iterations, and what is violated most."""
    from tqdm import tqdm

    with tqdm(disable=None, leave=False, bar_format="{desc} [{elapsed}]") as bar:

        def show(now: Progress) -> None:
            size = f"{100 * now.height:.4g} cm high, {100 * now.width:.4g} cm wide, {now.duration:g} s"
            worst = f"worst violation {max(now.violation, 0.0):.4f} ({now.constraint})"
            bar.set_description_str(f"{size}: iteration {now.iterations}, {worst}")

        yield show


def _planned(name: str, robot: Robot, obstacle: Obstacle, own: dict[str, Any]) -> tuple[Motion, dict[str, Any]]:
    """The motion from the named planner, and the values to print. Some planners add values of their own."""
    from stepover.report import summary

    if name == "paper":
        from stepover.planning.algorithm_1.planner import plan_in_detail

        with progress("cannot be crossed; searching for the nearest obstacle that can") as advance:
            planned = plan_in_detail(robot, obstacle, **own, progress=advance)
        return planned.motion, summary.plan_to_json(robot, obstacle, planned)
    if name == "quasi-static":
        from stepover.planning.quasi_static.planner import quasi_static_in_detail

        slow = quasi_static_in_detail(robot, obstacle, **own)
        return slow.motion, summary.quasi_static_to_json(robot, obstacle, slow)
    if name == "optimal":
        from stepover.planning.optimal.planner import optimal_in_detail

        with iterations() as advance:
            best = optimal_in_detail(robot, obstacle, **own, progress=advance)
        return best.motion, summary.motion_to_json(robot, obstacle, best.motion) | best.to_json()
    motion = find_planner(name)(robot, obstacle)
    return motion, summary.motion_to_json(robot, obstacle, motion)
