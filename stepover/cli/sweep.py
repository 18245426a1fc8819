"""The command sweep: many obstacles, one table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from stepover.cli.commands import Command, goes_on, one_thread_a_process, say
from stepover.cli.options import as_json, margins, new_file, planner_choices
from stepover.errors import InvalidInput


def _anywhere(context: click.Context, parameter: click.Parameter, value: str) -> str:
    """A robot's name, or the path of its robot.toml as it holds in any folder."""
    return str(Path(value).resolve()) if Path(value).suffix == ".toml" else value


@click.command(cls=Command)
@click.argument("obstacles", metavar="[OBSTACLES.csv]", required=False)
@click.option(
    "--heights", metavar="FIRST:LAST:STEP", help="Instead of a list: heights of a grid [m]; or a few, as 0.1,0.15."
)
@click.option("--widths", metavar="FIRST:LAST:STEP", help="Its widths, along the way [m]; or one, as 0.05.")
@click.option("--robot", default="hrp2", show_default=True, callback=_anywhere, help="As for plan.")
@margins
@planner_choices
@click.option("--simulate", "physics", is_flag=True, help="Also carry out what is planned, with ideal motors.")
@click.option("--jobs", type=click.IntRange(1), help="Obstacles at a time; default: one a core.")
@click.option("--dask", metavar="ADDRESS", help="Let a Dask cluster do it; its scheduler's address.")
@new_file("--output", "Where the table goes", ".csv", required=True)
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
    """Plan many obstacles, and carry them out if asked to: one row of a table each.

    They are a grid, both ends included, or a list, whose first line names the columns height and width [m]. A row says
    whether there is a plan and if not why, its key configuration, clearance, ZMP margin, joint speed, the hash of its
    motion, and whether the simulated robot crossed. Obstacles that cannot be crossed are rows as well, not errors.

    Until the table is written, finished obstacles are kept beside it in a .part file. After an interruption the same
    command goes on from there, also with a larger grid. The table depends neither on that nor on who did the work.

    With --dask the workers of that cluster need this very stepover. Such a cluster on one machine: 'dask scheduler',
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
