"""The command study: one motion under many random disturbances."""

from __future__ import annotations

from pathlib import Path

import click

from stepover.cli.commands import Command, goes_on, one_thread_a_process, say
from stepover.cli.options import as_json, new_file, physics, robot_file
from stepover.errors import InvalidInput


@click.command(cls=Command)
@click.argument("motion", metavar="[MOTION.npz]", required=False)
@click.option("--height", type=float, help="Without a motion: height of the bare obstacle to plan for [m].")
@click.option("--width", type=float, help="Its width, along the path [m].")
@click.option(
    "--runs", type=click.IntRange(1), default=200, show_default=True,
    help="Number of draws. Each is simulated twice, without and with the stabilizer.",
)  # fmt: skip
@click.option(
    "--seed", type=click.IntRange(0), default=0, show_default=True,
    help="Random seed. Draw k depends only on the seed and on k.",
)  # fmt: skip
@physics(actuators="limited", sole="compliant")
@robot_file
@click.option("--jobs", type=click.IntRange(1), help="Simulations at a time; default: one for each core.")
@new_file("--output", "File for the table", ".csv", required=True)
@new_file("--picture", "Also plot the success rate over each disturbance", ".png")
@as_json
def study(
    motion: str | None,
    height: float | None,
    width: float | None,
    runs: int,
    seed: int,
    actuators: str,
    sole: str,
    engine: str,
    robot: str | None,
    jobs: int | None,
    output: Path,
    picture: Path | None,
    as_json: bool,
) -> None:
    """Simulate a motion under many random disturbances.

    Each value is drawn uniformly: friction 0.4 to 1; floor up to 5 mm higher or lower under each foothold, with a slope
    of up to 1 degree ahead and to the side; mass at the chest 5 % more or less, chest CoM up to 10 mm off; obstacle up
    to 20 mm nearer or farther; one push of up to 80 N for 0.1 s at any time in any direction; readings 5 to 10 ms old.

    Until the table is complete, finished simulations are kept beside it in a .part file. After an interruption, run the
    same command again to continue, with more --runs if you like. The table does not depend on interruptions or --jobs.
    Its columns have the same names as the disturbances of simulate --perturb, so that you can repeat a single draw.

    Example: python -m stepover study motion.npz --runs 50 --output table.csv --picture table.png
    """
    one_thread_a_process()
    from stepover.motion.motion import Motion
    from stepover.report import summary
    from stepover.studies import robustness, success_rates

    if picture is not None:
        from stepover.report import figures  # before the work: a missing library is reported at once

    if motion is not None and (height is not None or width is not None):
        raise InvalidInput("give either a motion or --height and --width, not both")
    if motion is not None:
        planned = Motion.load(motion)
    elif height is not None and width is not None:
        from stepover import Obstacle, load_robot, plan

        planned = plan(load_robot(robot or "hrp2"), Obstacle(height, width))
    else:
        raise InvalidInput("give a motion, such as motion.npz, or --height and --width")
    with goes_on(output):
        robustness.study(
            planned, runs, seed, actuators=actuators, sole=sole, engine=engine, robot=robot, table=output,
            build=output.parent, workers=jobs,
        )  # fmt: skip
    rows = robustness.read_table(output)
    if picture is not None:
        figures.save(figures.robustness(rows), picture)
    if as_json:
        say(summary.as_line(success_rates.study_to_json(rows)))
    else:
        say(f"{summary.aligned(success_rates.study_summary(rows))}\n\nwritten to {output}")
