"""sweep.py and the sweep command: any obstacles, the same table whoever does the work, and none done twice."""

import json
import os
import signal
import subprocess
import sys
import time
import types
from pathlib import Path

import pytest
from click.testing import CliRunner

from stepover import __version__
from stepover.cli import main
from stepover.errors import InvalidInput
from stepover.studies import sweep
from stepover.studies.fingerprint import fingerprint
from stepover.studies.sweep import Crossing, Point, cross, summary, summary_lines

GRID = ["--heights", "0.05:0.1:0.05", "--widths", "0.05,0.3"]
JSON_KEYS = {
    "robot", "margin_height", "margin_width", "arms", "speed_limits", "engine", "obstacles", "planned", "refused",
    "simulated", "crossed", "highest_planned", "widest_planned", "planned_clearance_min", "zmp_margin_min",
    "simulated_clearance_min",
}  # fmt: skip


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Each test runs in a folder of its own."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="module")
def cluster():
    """Two workers of a Dask scheduler on a free port."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, scheduler_port=0, dashboard_address=":0"
    ) as found:
        yield found.scheduler_address


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """The table of GRID, made in one go by one process."""
    folder = tmp_path_factory.mktemp("whole")
    result = call("sweep", *GRID, "--jobs", 1, "--output", folder / "t.csv")
    assert result.exit_code == 0, result.output
    return folder / "t.csv"


def call(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments], prog_name="python -m stepover")


class TestRows:
    def test_what_is_planned(self):
        row = Crossing(**cross(Point(0.05, 0.05, physics=False, margin_height=0.02, margin_width=0.025)))
        assert (row.robot, row.version, row.margin_height, row.margin_width) == ("hrp2", __version__, 0.02, 0.025)
        assert (row.planned, row.crossed, row.reason) == (True, None, "")
        assert 0.02 <= row.planned_clearance < 0.03, "the margins are those that were asked for"
        assert row.x_hds == pytest.approx(row.x_ads / 2.0, abs=1e-4)
        assert len(row.motion) == 64

    def test_what_is_refused(self):
        row = Crossing(**cross(Point(0.05, 0.3)))
        assert not row.planned
        assert row.x_ads is row.motion is row.crossed is None
        assert "no key configuration" in row.reason

    def test_how_it_is_planned(self):
        swung = Crossing(**cross(Point(0.05, 0.05, physics=False, arms="on")))
        slow = Crossing(**cross(Point(0.05, 0.05, physics=False, speed_limits="respect")))
        assert (swung.arms, slow.speed_limits) == ("on", "respect")
        assert swung.arm_swing_deg > 0.0
        assert slow.joint_speed_ratio <= 1.0
        assert slow.motion != swung.motion

    def test_the_physics(self, monkeypatch):
        run = types.SimpleNamespace(crossed=False, clearance_min=-0.0012345, explanation="fell")
        monkeypatch.setattr("stepover.simulation.run.simulate", lambda motion, robot, engine: {"mujoco": run}[engine])
        row = Crossing(**cross(Point(0.05, 0.05, engine="mujoco")))
        assert row.engine == "mujoco"
        assert (row.planned, row.crossed, row.simulated_clearance, row.reason) == (True, False, -0.00123, "fell")

    def test_a_robot_by_its_path(self, spoilt):
        path = spoilt({("name",): "twin"})
        row = Crossing(**cross(Point(0.05, 0.05, robot=str(path), physics=False)))
        assert (row.robot, row.planned) == ("twin", True)
        before = fingerprint(cross, str(path))
        path.with_name("other.csv").write_text("of no influence")
        assert fingerprint(cross, str(path)) == before
        path.write_text(path.read_text() + "\n# changed\n")
        assert fingerprint(cross, str(path)) != before


def test_another_planner(monkeypatch, motion):
    """The row has the motion's measures, and nothing of Algorithm 1."""
    monkeypatch.setattr(sweep, "find_planner", lambda name: lambda robot, obstacle: (name == "optimal") and motion)
    row = Crossing(**cross(Point(0.15, 0.05, physics=False, planner="optimal")))
    assert (row.planner, row.planned, row.motion, row.x_ads) == ("optimal", True, motion.hash(), None)
    assert row.planned_clearance > 0.03


class TestSummary:
    KNOWN = {"robot": "hrp2", "version": "0", "margin_height": 0.03, "margin_width": 0.03}  # noqa: RUF012

    def test_numbers(self):
        good = {"planned": True, "planned_clearance": 0.033, "zmp_margin": 0.02, "engine": "mujoco", **self.KNOWN}
        rows = [
            Crossing(height=0.1, width=0.2, crossed=True, simulated_clearance=0.031, **good),
            Crossing(height=0.2, width=0.1, crossed=False, simulated_clearance=-0.001, **good),
            Crossing(height=0.9, width=0.1, planned=False, **self.KNOWN),
        ]
        found = summary(rows)
        assert (found["obstacles"], found["planned"], found["refused"], found["crossed"]) == (3, 2, 1, 1)
        assert (found["highest_planned"], found["widest_planned"]) == (0.2, 0.2)
        assert (found["planned_clearance_min"], found["simulated_clearance_min"]) == (0.033, -0.001)
        assert dict(summary_lines(found))["crossed in the physics"] == "1 of 2, engine mujoco"

    def test_where_nothing_was_planned(self):
        found = summary([Crossing(height=0.9, width=0.1, planned=False, **self.KNOWN)])
        assert found["crossed"] is found["highest_planned"] is found["planned_clearance_min"] is None
        assert dict(summary_lines(found))["planned"] == "0 of 1 obstacles"


class TestCommand:
    def test_a_grid(self, table):
        rows = sweep.read_rows(Crossing, table)
        assert [(row.height, row.width) for row in rows] == [(0.05, 0.05), (0.05, 0.3), (0.1, 0.05), (0.1, 0.3)]
        assert [row.planned for row in rows] == [True, False, True, False]

    def test_a_list_as_json(self, table):
        lines = table.read_text().splitlines(keepends=True)
        Path("l.csv").write_text("height,width\n0.1,0.05\n0.05,0.3\n")
        result = call("sweep", "l.csv", "--jobs", 1, "--output", "t.csv", "--json")
        assert result.exit_code == 0, result.output
        assert Path("t.csv").read_text() == lines[0] + lines[3] + lines[2]
        printed = json.loads(result.stdout)
        assert set(printed) == JSON_KEYS
        assert (printed["obstacles"], printed["planned"], printed["crossed"]) == (2, 1, None)

    def test_a_summary(self, table):
        result = call("sweep", *GRID, "--jobs", 1, "--output", "t.csv")
        assert result.exit_code == 0, result.output
        assert "planned 2 of 4 obstacles" in " ".join(result.stdout.split())
        assert result.stdout.endswith("written to t.csv\n")
        assert Path("t.csv").read_bytes() == table.read_bytes()
        assert os.listdir() == ["t.csv"]

    @pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
    def test_whoever_does_it_the_table_is_the_same(self, table, cluster):
        for name, where in (("jobs", ("--jobs", 2)), ("dask", ("--dask", cluster))):
            result = call("sweep", *GRID, *where, "--output", f"{name}.csv")
            assert result.exit_code == 0, result.output
            assert Path(f"{name}.csv").read_bytes() == table.read_bytes()

    def test_simulate_and_options_reach_the_planner(self, monkeypatch):
        seen = []
        monkeypatch.setattr(sweep, "make_table", lambda name, points, *_: seen.extend(points))
        monkeypatch.setattr(sweep, "read_rows", lambda *_: [Crossing(height=1.0, width=1.0, planned=False,
                                                                     **TestSummary.KNOWN)])  # fmt: skip
        options = ["--margin-height", 0.01, "--margin-width", 0.02, "--arms", "off", "--speed-limits", "respect"]
        result = call("sweep", "--heights", 0.1, "--widths", 0.2, "--simulate", *options, "--output", "t.csv")
        assert result.exit_code == 0, result.output
        assert seen == [Point(0.1, 0.2, "hrp2", True, 0.01, 0.02, "off", "respect")]

    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            ([], ["--output"]),
            (["--output", "t.csv"], ["obstacles.csv", "--heights"]),
            (["--heights", "0.1", "--output", "t.csv"], ["--widths"]),
            (["l.csv", "--heights", "0.1", "--output", "t.csv"], ["not both"]),
            (["l.csv", "--output", "t.csv"], ["l.csv", "No such file"]),
            (["--heights", "0.2:0.1:0.1", "--widths", "0.1", "--output", "t.csv"], ["--heights", "must rise"]),
            (["--heights", "0:0.1:0.1", "--widths", "0.1", "--output", "t.csv"], ["height = 0.0"]),
            ([*GRID, "--margin-width", "nan", "--output", "t.csv"], ["margin_width"]),
            ([*GRID, "--robot", "hrp3", "--output", "t.csv"], ["hrp3", "hrp2"]),
            ([*GRID, "--robot", "no.toml", "--output", "t.csv"], ["no.toml", "No such file"]),
            ([*GRID, "--arms", "maybe", "--output", "t.csv"], ["--arms"]),
            ([*GRID, "--jobs", "0", "--output", "t.csv"], ["--jobs"]),
            ([*GRID, "--jobs", "1", "--dask", "tcp://127.0.0.1:1", "--output", "t.csv"], ["--jobs or --dask"]),
            ([*GRID, "--dask", "nonsense://here", "--output", "t.csv"], ["nonsense://here", "dask scheduler"]),
            ([*GRID, "--output", "nowhere/t.csv"], ["nowhere", "does not exist"]),
        ],
    )
    def test_bad_input(self, arguments, words):
        result = call("sweep", *arguments)
        assert (result.exit_code, result.stdout) == (2, ""), result.output
        assert len(result.stderr.splitlines()) == 1
        for word in words:
            assert word in result.stderr
        assert [name for name in os.listdir() if not name.endswith(".part")] == []

    def test_all_obstacles_are_looked_at_before_the_work(self, monkeypatch):
        monkeypatch.setattr(sweep, "make_table", lambda *_: pytest.fail("it planned"))
        with pytest.raises(InvalidInput, match="height = -1"):
            sweep.sweep([Point(0.1, 0.1), Point(-1.0, 0.1)], Path("t.csv"))


@pytest.mark.parametrize("where", ["jobs", "dask"])
def test_interrupted_it_goes_on(where, cluster, tmp_path, monkeypatch):
    options = ["--dask", cluster] if where == "dask" else ["--jobs", "2"]
    command = [sys.executable, "-m", "stepover", "sweep", "--widths", "0.05", "--output", "t.csv", "--heights"]
    process = subprocess.Popen(
        [*command, "0.05:0.15:0.0001", *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # which a shell's background ignores
    )  # fmt: skip
    try:
        deadline = time.monotonic() + 60.0
        while finished(tmp_path) < 2 and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=60)
    finally:
        process.kill()
    assert (process.returncode, output) == (130, "")
    assert len(errors.splitlines()) == 1, errors
    assert "run the same command to continue" in errors
    kept = finished(tmp_path)
    assert 2 <= kept < 1001
    assert not Path("t.csv").exists()
    (part,) = tmp_path.glob("*.part")
    some = [json.loads(line)[1]["height"] for line in part.read_text().splitlines()][:2]
    heights = ",".join(map(str, some))
    monkeypatch.setattr("stepover.studies.sweep.plan_in_detail", lambda *_, **__: pytest.fail("it planned again"))
    assert call("sweep", "--widths", "0.05", "--output", "t.csv", "--jobs", 1, "--heights", heights).exit_code == 0
    assert not part.exists()
    assert [row.height for row in sweep.read_rows(Crossing, Path("t.csv"))] == some


def finished(folder):
    """Finished rows in the part files of a folder."""
    return sum(len(part.read_bytes().splitlines()) for part in folder.glob("*.part"))
