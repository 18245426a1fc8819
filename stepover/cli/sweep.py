"""The command sweep: many obstacles, one table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from stepover.cli.commands import Command, goes_on, one_thread_a_process, say
from stepover.cli.options import as_json, choice, engine, margins, new_file, planner_choices
from stepover.errors import InvalidInput
from stepover.planning.planner import PLANNERS


def _anywhere(context: click.Context, parameter: click.Parameter, value: str) -> str:
    """A robot's name, or the absolute path of its robot.toml."""
    return str(Path(value).resolve()) if Path(value).suffix == ".toml" else value


@click.command(cls=Command)
@click.argument("obstacles", metavar="[OBSTACLES.csv]", required=False)
@click.option(
    "--heights",
    metavar="FIRST:LAST:STEP",
    help="Without a list: heights of a grid [m], or single values such as 0.1,0.15.",
)
@click.option(
    "--widths", metavar="FIRST:LAST:STEP", help="Widths of the grid, along the path [m], or single values such as 0.05."
)
@click.option(
    "--robot",
    default="hrp2",
    show_default=True,
    callback=_anywhere,
    help="A name under data/, or a path to a robot.toml.",
)
@margins
@choice("--planner", tuple(PLANNERS), "Which planner; --arms and --speed-limits are the paper's.")
@planner_choices
@click.option("--simulate", "physics", is_flag=True, help="Also simulate each planned motion, with ideal motors.")
@engine
@click.option("--jobs", type=click.IntRange(1), help="Obstacles at a time; default: one for each core.")
@click.option("--dask", metavar="ADDRESS", help="Use a Dask cluster; the address of its scheduler.")
@new_file("--output", "File for the table", ".csv", required=True)
@as_json
def sweep(
    obstacles: str | None,
    heights: str | None,
    widths: str | None,
    jobs: int | None,
    dask: str | None,
    output: Path,
    as_json: bool,
    **how: Any,
) -> None:
    """Plan for many obstacles and write a table, one row for each.

    Give a grid, which includes both ends, or a list whose first line names the columns height and width [m]. A row
    states whether there is a plan, and if not, why; the key configuration, clearance, ZMP margin, joint speed and hash
    of the motion; and whether the simulated robot crossed. An obstacle that cannot be crossed is a row too, not an
    error.

    Until the table is complete, finished obstacles are kept beside it in a .part file. After an interruption, run the
    same command again to continue, with a larger grid if you like. The table does not depend on interruptions, --jobs
    or --dask.

    With --dask, every worker needs the same version of stepover. To start a cluster on one machine: 'dask scheduler',
    then 'dask worker tcp://127.0.0.1:8786 --nworkers -1 --nthreads 1'.

    Example: python -m stepover sweep --heights 0.05:0.25:0.05 --widths 0.03:0.15:0.03 --output sweep.csv
    """
    one_thread_a_process()
    if obstacles is not None and (heights is not None or widths is not None):
        raise InvalidInput("give either a list of obstacles or --heights and --widths, not both")
    if jobs is not None and dask is not None:
        raise InvalidInput("give either --jobs or --dask: the cluster has its own number of workers")
    from stepover.report import summary
    from stepover.studies import obstacle_list
    from stepover.studies import sweep as sweeping

    if obstacles is not None:
        sizes = obstacle_list.read_list(Path(obstacles))
    elif heights is not None and widths is not None:
        sizes = obstacle_list.grid(obstacle_list.axis(heights, "--heights"), obstacle_list.axis(widths, "--widths"))
    else:
        raise InvalidInput("give a list of obstacles, such as obstacles.csv, or --heights and --widths")
    with goes_on(output):
        rows = sweeping.sweep([sweeping.Point(*size, **how) for size in sizes], output, dask or jobs)
    result = sweeping.summary(rows)
    if as_json:
        say(summary.as_line(result))
    else:
        say(f"{summary.aligned(sweeping.summary_lines(result))}\n\nwritten to {output}")
