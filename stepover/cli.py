"""The command line: plan, simulate, view, study, sweep, reproduce. What each prints, and with which exit code it ends.

Exit codes: 0 done; 2 bad input; 3 an obstacle that cannot be crossed; 4 the simulated robot fell or touched the
obstacle; 130 interrupted. An error is one line on stderr. With --json, stdout is exactly one JSON object.
"""

from __future__ import annotations

import contextlib
import math
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stepover import __version__
from stepover.errors import Infeasible, InvalidInput, StepOverError

if TYPE_CHECKING:
    from stepover.model.robot import Robot
    from stepover.simulation.measurements import Run

DONE, BAD_INPUT, INFEASIBLE, NOT_CROSSED, INTERRUPTED = 0, 2, 3, 4, 130
GOES_ON = "interrupted; what is finished is kept beside {}: the same command goes on"


class _Commands(click.Group):
    """A group of commands whose errors are one line on stderr, with our exit codes."""

    def main(self, *args: Any, **options: Any) -> Any:
        """Run a command and leave with its exit code."""
        options["standalone_mode"] = False
        try:
            sys.exit(super().main(*args, **options) or DONE)
        except click.exceptions.NoArgsIsHelpError as error:
            click.echo(error.format_message(), err=True)
            sys.exit(BAD_INPUT)
        except click.Abort:
            _complain("interrupted", INTERRUPTED)
        except click.ClickException as error:
            context = getattr(error, "ctx", None)
            hint = f"; see '{context.command_path} --help'" if context else ""
            _complain(error.format_message().rstrip(".") + hint, BAD_INPUT)
        except StepOverError as error:
            _complain(str(error), exit_code(error))


def exit_code(error: StepOverError) -> int:
    """Exit code of an error: its own where it carries one, 3 for what cannot be crossed, else 2."""
    return getattr(error, "exit_code", INFEASIBLE if isinstance(error, Infeasible) else BAD_INPUT)


def _complain(message: str, code: int) -> None:
    """Print one line on stderr and leave."""
    click.echo(f"error: {' '.join(message.split())}", err=True)
    sys.exit(code)


def _new_file(context: click.Context, parameter: click.Parameter, value: str | None) -> Path | None:
    """Refuse, before the work begins, a file that could not be written after it."""
    if value is None:
        return None
    path, option = Path(value), f"--{parameter.name}"
    if path.is_dir():
        raise InvalidInput(f"{option} {path} is a folder; name a file in it")
    if not path.parent.is_dir():
        raise InvalidInput(f"{option} {path}: the folder {path.parent} does not exist; make it first")
    if not os.access(path.parent, os.W_OK):
        raise InvalidInput(f"{option} {path}: the folder {path.parent} cannot be written to")
    return path


def _new_film(context: click.Context, parameter: click.Parameter, value: str | None) -> Path | None:
    """As _new_file, for an mp4."""
    if value is not None and Path(value).suffix != ".mp4":
        raise InvalidInput(f"--{parameter.name} {value}: a film's name must end in .mp4")
    return _new_file(context, parameter, value)


def _new_page(context: click.Context, parameter: click.Parameter, value: str | None) -> Path | None:
    """As _new_file, for a page that a browser takes for one."""
    if value is not None and Path(value).suffix != ".html":
        raise InvalidInput(f"--{parameter.name} {value}: a page's name must end in .html")
    return _new_file(context, parameter, value)


def _new_picture(context: click.Context, parameter: click.Parameter, value: str | None) -> Path | None:
    """As _new_file, for a PNG."""
    if value is not None and Path(value).suffix != ".png":
        raise InvalidInput(f"--{parameter.name} {value}: a picture's name must end in .png")
    return _new_file(context, parameter, value)


def _anywhere(context: click.Context, parameter: click.Parameter, value: str) -> str:
    """A robot's name, or the path of its robot.toml as it holds in any folder."""
    return str(Path(value).resolve()) if Path(value).suffix == ".toml" else value


def _pairs(context: click.Context, parameter: click.Parameter, values: tuple[str, ...]) -> dict[str, str]:
    """Split name=value pairs, and refuse what is none or comes twice."""
    pairs: dict[str, str] = {}
    for value in values:
        name, equals, text = value.partition("=")
        if not (name and equals and text):
            raise InvalidInput(f"{value!r} is not name=value")
        if name in pairs:
            raise InvalidInput(f"{name} is given twice: {pairs[name]} and {text}")
        pairs[name] = text
    return pairs


@click.group(
    name="stepover", cls=_Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110}
)
@click.version_option(__version__, prog_name="stepover")
def main() -> None:
    """Humanoid robots that walk dynamically over large obstacles, after Stasse et al., T-RO 2009.

    Lengths are in metres, times in seconds. Exit codes: 0 done, 2 bad input, 3 the obstacle cannot be crossed,
    4 the simulated robot fell or touched the obstacle.
    """


@main.command()
@click.option("--robot", default="hrp2", show_default=True, help="A name under data/, or a path to a robot.toml.")
@click.option("--height", type=float, required=True, help="Height of the bare obstacle [m].")
@click.option("--width", type=float, required=True, help="Width of the bare obstacle, along the way [m].")
@click.option("--margin-height", type=float, default=0.03, show_default=True, help="Safety margin above it [m].")
@click.option("--margin-width", type=float, default=0.03, show_default=True, help="Margin before and behind it [m].")
@click.option("--distance", type=float, help="From between the ankles to its front face [m]; default: nominal steps.")
@click.option(
    "--arms", type=click.Choice(["auto", "on", "off"]), default="auto", show_default=True,
    help="Swing the arms back: where the plan needs it, always, never.",
)  # fmt: skip
@click.option(
    "--speed-limits", type=click.Choice(["ignore", "respect"]), default="ignore", show_default=True,
    help="Joint speed limits; the paper ignores them.",
)  # fmt: skip
@click.option("--output", required=True, metavar="FILE", callback=_new_file, help="Where the motion goes (npz).")
@click.option("--csv", metavar="FILE", callback=_new_file, help="Also as a table, one sample a row.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object (SI units) instead of the summary.")
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
    from stepover.model.robot import load_robot
    from stepover.planner import plan_in_detail
    from stepover.report import summary

    model, obstacle = load_robot(robot), Obstacle(height, width, margin_height, margin_width, distance)
    planned = plan_in_detail(model, obstacle, arms=arms, speed_limits=speed_limits)
    result = summary.plan_to_json(model, obstacle, planned)
    planned.motion.save(output)
    if csv is not None:
        planned.motion.save_csv(csv)
    click.echo(summary.as_line(result) if as_json else f"{summary.plan_summary(result)}\n\nwritten to {output}")


class _Disturbed(click.Command):
    """A command whose help ends with all disturbances."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write them as a list, with units and ranges."""
        from stepover.simulation.disturbances import explained

        with formatter.section("Disturbances, for --perturb"):
            formatter.write_dl(explained())


@main.command(cls=_Disturbed)
@click.argument("motion", metavar="MOTION.npz")
@click.option(
    "--actuators", type=click.Choice(["ideal", "limited"]), default="ideal", show_default=True,
    help="Position-controlled motors without limits, as in the paper, or servos with limits of torque and speed.",
)  # fmt: skip
@click.option(
    "--sole", type=click.Choice(["rigid", "compliant"]), default="rigid", show_default=True,
    help="Rigid soles, or rubber between ankle and sole.",
)  # fmt: skip
@click.option("--robot", metavar="TOML", help="Path to its robot.toml, where the motion's robot is none under data/.")
@click.option("--stabilizer/--no-stabilizer", default=False, show_default=True, help="Feedback from the sensors.")
@click.option("--perturb", multiple=True, metavar="NAME=VALUE", callback=_pairs, help="A disturbance, as listed below.")
@click.option("--video", metavar="FILE", callback=_new_film, help="Film it from the side (mp4).")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object (SI units) instead of the summary.")
def simulate(
    motion: str,
    actuators: str,
    sole: str,
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
    from stepover.model.robot import load_robot
    from stepover.motion import Motion
    from stepover.report import summary
    from stepover.simulation.run import simulate as run_simulation

    disturbances = {name: _number(name, text) for name, text in perturb.items()} or None
    planned = Motion.load(motion)
    model = load_robot(robot or planned.robot)
    run = run_simulation(
        planned, actuators=actuators, sole=sole, stabilizer=stabilizer, perturb=disturbances, robot=model
    )
    if video is not None:
        from stepover.simulation.video import record

        with _progress("filming") as progress:
            record(run, video, robot=model, progress=progress)
    click.echo(summary.as_line(run.to_json()) if as_json else summary.run_summary(run))
    if video is not None and not as_json:
        click.echo(f"\nfilmed in {video}")
    if not run.crossed:
        _complain(f"{run.explanation}; {_plot_failure(run, video or Path(motion), model)}", NOT_CROSSED)


@contextlib.contextmanager
def _progress(what: str) -> Iterator[Callable[[float], None]]:
    """A progress bar on stderr, where that is a terminal, to be called with the share done."""
    from tqdm import tqdm

    form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"
    with tqdm(total=1.0, desc=what, disable=None, leave=False, bar_format=form) as bar:

        def show(share: float) -> None:
            bar.n = share
            bar.refresh()

        yield show


def _number(name: str, text: str) -> float:
    """A finite number out of name=value."""
    with contextlib.suppress(ValueError):
        if math.isfinite(float(text)):
            return float(text)
    raise InvalidInput(f"{name} = {text!r} must be a finite number")


def _plot_failure(run: Run, beside: Path, robot: Robot) -> str:
    """Plot the second before the failure beside a file, or in build/; say where."""
    from stepover.report import figures

    folder = beside.parent
    if not os.access(folder, os.W_OK):
        folder = Path("build")
        folder.mkdir(exist_ok=True)
    path = folder / f"{beside.stem}_failure.png"
    figures.save(figures.failure(robot, run), path)
    return f"the second before it is drawn in {path}"


@main.command()
@click.argument("motion", metavar="MOTION.npz")
@click.option("--output", required=True, metavar="FILE", callback=_new_page, help="Where the page goes (html).")
@click.option("--time", type=float, help="Moment shown before it is played [s]; default: the first.")
@click.option("--robot", metavar="TOML", help="Path to its robot.toml, where the motion's robot is none under data/.")
def view(motion: str, output: Path, time: float | None, robot: str | None) -> None:
    """Write a page that shows a planned motion in 3-D, to be opened in any browser, offline.

    It holds the robot, the obstacle with its margins, the footsteps and the ways of ZMP and CoM, to be turned with the
    mouse, played, paused and scrubbed.

    Example: python -m stepover view motion.npz --output motion.html
    """
    from stepover.model.robot import load_robot
    from stepover.motion import Motion
    from stepover.report.viewer import save_page

    planned = Motion.load(motion)
    save_page(load_robot(robot or planned.robot), planned, output, time)
    click.echo(f"written to {output}; open it in a browser")


@main.command()
@click.argument("motion", metavar="[MOTION.npz]", required=False)
@click.option("--height", type=float, help="Instead of a motion: height of the bare obstacle to plan for [m].")
@click.option("--width", type=float, help="Its width, along the way [m].")
@click.option(
    "--runs", type=click.IntRange(1), default=200, show_default=True,
    help="Draws; each is simulated twice, without and with the stabilizer.",
)  # fmt: skip
@click.option(
    "--seed", type=click.IntRange(0), default=0, show_default=True,
    help="Of the draws. Draw k depends on the seed and on k alone.",
)  # fmt: skip
@click.option(
    "--actuators", type=click.Choice(["ideal", "limited"]), default="limited", show_default=True,
    help="As for simulate.",
)  # fmt: skip
@click.option(
    "--sole", type=click.Choice(["rigid", "compliant"]), default="compliant", show_default=True,
    help="As for simulate.",
)  # fmt: skip
@click.option("--jobs", type=click.IntRange(1), help="Simulations at a time; default: one a core.")
@click.option("--output", required=True, metavar="FILE", callback=_new_file, help="Where the table goes (csv).")
@click.option("--picture", metavar="FILE", callback=_new_picture, help="Also draw success over disturbance (png).")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object (SI units) instead of the summary.")
def study(
    motion: str | None,
    height: float | None,
    width: float | None,
    runs: int,
    seed: int,
    actuators: str,
    sole: str,
    jobs: int | None,
    output: Path,
    picture: Path | None,
    as_json: bool,
) -> None:
    """Carry out a motion under many disturbances drawn at random, with and without the stabilizer.

    Each draw is uniform: friction 0.4 to 1; the floor up to 5 mm higher or lower under each foothold, and sloped by up
    to 1 degree ahead and to the side; 5 % more or less mass on the chest, whose CoM is up to 10 mm off; the obstacle up
    to 20 mm nearer or farther; one push of up to 80 N for 0.1 s at any time in any direction; readings 5 to 10 ms old.

    Finished simulations are kept beside the output in a .part file. Where the study was interrupted or killed, or
    --runs has grown, the same command goes on from there. The table does not depend on interruptions or --jobs.
    Its columns are named as the disturbances of simulate --perturb, to look at one draw alone.

    Example: python -m stepover study motion.npz --runs 50 --output table.csv --picture table.png
    """
    _one_thread_a_process()
    from stepover.motion import Motion
    from stepover.report import robustness, success_rates, summary

    if motion is not None and (height is not None or width is not None):
        raise InvalidInput("give either a motion or --height and --width, not both")
    if motion is not None:
        planned = Motion.load(motion)
    elif height is not None and width is not None:
        from stepover import Obstacle, load_robot, plan

        planned = plan(load_robot("hrp2"), Obstacle(height, width))
    else:
        raise InvalidInput("give a motion, such as motion.npz, or --height and --width")
    try:
        robustness.study(
            planned, runs, seed, actuators=actuators, sole=sole, table=output, build=output.parent, workers=jobs
        )
    except KeyboardInterrupt:
        _complain(GOES_ON.format(output), INTERRUPTED)
    rows = robustness.read_table(output)
    if picture is not None:
        from stepover.report import figures

        figures.save(figures.robustness(rows), picture)
    if as_json:
        click.echo(summary.as_line(success_rates.study_to_json(rows)))
    else:
        click.echo(f"{summary.aligned(success_rates.study_summary(rows))}\n\nwritten to {output}")


def _one_thread_a_process() -> None:
    """Before numpy is loaded: one thread a process, so that sums come out the same with any number of jobs."""
    for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(threads, "1")


@main.command()
@click.argument("obstacles", metavar="[OBSTACLES.csv]", required=False)
@click.option("--heights", metavar="FIRST:LAST:STEP", help="Instead of a list: heights of a grid [m].")
@click.option("--widths", metavar="FIRST:LAST:STEP", help="Its widths, along the way [m].")
@click.option("--robot", default="hrp2", show_default=True, callback=_anywhere, help="As for plan.")
@click.option("--margin-height", type=float, default=0.03, show_default=True, help="As for plan [m].")
@click.option("--margin-width", type=float, default=0.03, show_default=True, help="As for plan [m].")
@click.option(
    "--arms", type=click.Choice(["auto", "on", "off"]), default="auto", show_default=True, help="As for plan."
)
@click.option(
    "--speed-limits", type=click.Choice(["ignore", "respect"]), default="ignore", show_default=True,
    help="As for plan.",
)  # fmt: skip
@click.option("--simulate", "physics", is_flag=True, help="Also carry out what is planned, with ideal motors.")
@click.option("--jobs", type=click.IntRange(1), help="Obstacles at a time; default: one a core.")
@click.option("--dask", metavar="ADDRESS", help="Let a Dask cluster do it; its scheduler's address.")
@click.option("--output", required=True, metavar="FILE", callback=_new_file, help="Where the table goes (csv).")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object (SI units) instead of the summary.")
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

    Finished obstacles are kept beside the output in a .part file. Where the sweep was interrupted or killed, or the
    grid has grown, the same command goes on from there. The table depends neither on that nor on who did the work.

    With --dask the workers of that cluster need this very stepover. Such a cluster on one machine: 'dask scheduler',
    then 'dask worker tcp://127.0.0.1:8786 --nworkers -1 --nthreads 1'.

    Example: python -m stepover sweep --heights 0.05:0.25:0.05 --widths 0.03:0.15:0.03 --output sweep.csv
    """
    _one_thread_a_process()
    if obstacles is not None and (heights is not None or widths is not None):
        raise InvalidInput("give either a list of obstacles or --heights and --widths, not both")
    if jobs is not None and dask is not None:
        raise InvalidInput("give either --jobs or --dask: the cluster has its own number of workers")
    from stepover.report import obstacle_list, summary
    from stepover.report import sweep as sweeping

    if obstacles is not None:
        sizes = obstacle_list.read_list(Path(obstacles))
    elif heights is not None and widths is not None:
        sizes = obstacle_list.grid(obstacle_list.axis(heights, "--heights"), obstacle_list.axis(widths, "--widths"))
    else:
        raise InvalidInput("give a list of obstacles, such as obstacles.csv, or --heights and --widths")
    try:
        rows = sweeping.sweep([sweeping.Point(*size, **how) for size in sizes], output, dask or jobs)
    except KeyboardInterrupt:
        _complain(GOES_ON.format(output), INTERRUPTED)
    result = sweeping.summary(rows)
    if as_json:
        click.echo(summary.as_line(result))
    else:
        click.echo(f"{summary.aligned(sweeping.summary_lines(result))}\n\nwritten to {output}")


@main.command()
@click.option("--only", metavar="NOTEBOOK", help="Run this notebook alone, such as stepover_15cm.")
@click.option(
    "-p", "--parameter", "parameters", multiple=True, metavar="NAME=VALUE", callback=_pairs,
    help="Change a parameter of the notebooks; may be repeated. Results go to build/ then.",
)  # fmt: skip
def reproduce(only: str | None, parameters: dict[str, str]) -> None:
    """Run every notebook; write every figure and claim to figures/ and the claims to README's table.

    Executed copies go to build/notebooks/. With -p figures and records go to build/figures/, so that an experiment
    never overwrites the reference.

    Example: python -m stepover reproduce --only stepover_15cm -p height=0.1
    """
    from stepover.report.reproduce import checkout
    from stepover.report.reproduce import reproduce as run_notebooks

    for path in run_notebooks(checkout(), only, parameters):
        click.echo(path)
