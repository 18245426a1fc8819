"""report/draws.py, robustness.py, success_rates.py and the study command: drawn as said, never lost, never twice."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from conftest import HRP2
from faked_simulation import faked, slow
from scipy import stats

from stepover.cli import main
from stepover.errors import Infeasible, InvalidInput
from stepover.motion.motion import Motion
from stepover.report import figures
from stepover.report.figures.robustness import most_influential
from stepover.report.tables.robustness import (
    agreement_table,
    failures_table,
    influence_table,
    nearness_table,
    rates_table,
)
from stepover.simulation.disturbances import Disturbances
from stepover.studies import fingerprint, robustness
from stepover.studies import study as studies
from stepover.studies.agreement import NEARLY, NO, YES
from stepover.studies.draws import RANGES, draw
from stepover.studies.robustness import Outcome, again, points, read_table, require_current, study
from stepover.studies.study import run_study
from stepover.studies.success_rates import (
    MEASURES,
    Rate,
    binned,
    equipped,
    influences,
    nearness,
    rate,
    study_to_json,
)

SCRIPT = Path(__file__).parent / "faked_simulation.py"


@pytest.fixture
def quick(monkeypatch):
    """No physics; gives the calls of simulate."""
    calls = []

    def counted(motion, **how):
        calls.append(how)
        return faked(motion, **how)

    monkeypatch.setattr(robustness, "simulate", counted)
    return calls


@pytest.fixture(scope="module")
def short(motion):
    """The first 0.3 s of the motion, without a step: quick in the real physics."""
    kept = {f.name: getattr(motion, f.name)[:60] for f in dataclasses.fields(motion)
            if np.shape(getattr(motion, f.name))[:1] == motion.time.shape}  # fmt: skip
    return dataclasses.replace(motion, **kept, footsteps=motion.footsteps.select(slice(0)))


@pytest.fixture(scope="module")
def rows(motion, tmp_path_factory):
    """A study of 60 draws without physics."""
    folder = tmp_path_factory.mktemp("study")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(robustness, "simulate", faked)
        return read_table(study(motion, 60, table=folder / "table.csv", build=folder, workers=1))


class TestDraws:
    def test_each_is_uniform_in_its_range(self, motion):
        drawn = [draw(motion, 1, k) for k in range(1500)]
        push = np.array([(one.push_x, one.push_y) for one in drawn])
        samples = {
            "friction": RANGES.friction, "slope_ahead": RANGES.slope, "slope_left": RANGES.slope,
            "chest_mass": RANGES.chest_mass, "chest_com_x": RANGES.chest_com_x, "obstacle_x": RANGES.obstacle_x,
            "latency": RANGES.late, "push_time": (motion.time[0], motion.time[-1] - 0.1),
        }  # fmt: skip
        tested = [(ends, np.array([getattr(one, name) for one in drawn])) for name, ends in samples.items()]
        tested += [(RANGES.push, np.hypot(*push.T)), ((-np.pi, np.pi), np.arctan2(push[:, 1], push[:, 0]))]
        tested += [(RANGES.ground, heights) for heights in np.array([one.heights for one in drawn]).T]
        assert len(tested) == 10 + len(motion.footsteps)
        for (low, high), values in tested:
            assert low - 1e-6 <= values.min() < low + 0.01 * (high - low)
            assert high + 1e-6 >= values.max() > high - 0.01 * (high - low)
            assert stats.kstest(values, "uniform", (low, high - low)).pvalue > 1e-3

    def test_they_are_independent(self, motion):
        drawn = [draw(motion, 2, k) for k in range(1500)]
        named = np.array([[*one.perturb.values()] for one in drawn])
        varied = named[:, np.ptp(named, axis=0) > 0.0]
        correlations = np.corrcoef(varied.T)[np.triu_indices(varied.shape[1], 1)]
        assert np.abs(correlations).max() < 0.11

    def test_the_ranges_are_those_of_the_study(self):
        assert dataclasses.asdict(RANGES) == {
            "friction": (0.4, 1.0), "slope": (-1.0, 1.0), "chest_mass": (-0.05, 0.05), "chest_com_x": (-0.01, 0.01),
            "obstacle_x": (-0.02, 0.02), "push": (0.0, 80.0), "push_duration": 0.1, "late": (0.0, 0.005),
            "ground": (-0.005, 0.005),
        }  # fmt: skip

    def test_a_draw_follows_from_seed_and_number_alone(self, motion, short):
        assert draw(motion, 3, 4) == draw(motion, 3, 4)
        assert len({draw(motion, seed, k).friction for seed in (3, 4) for k in (3, 4)}) == 4
        assert points(motion, 5, 7)[:4] == points(motion, 2, 7)
        assert draw(short, 3, 4).heights == []
        assert draw(short, 3, 4).obstacle_x == draw(motion, 3, 4).obstacle_x

    def test_simulate_knows_what_is_drawn(self, motion):
        one = draw(motion, 0, 0)
        read = Disturbances.read(one.perturb, motion)
        for name in ("friction", "slope_left", "chest_com_x", "push_y", "push_time", "push_duration", "latency"):
            assert getattr(read, name) == getattr(one, name)
        np.testing.assert_array_equal(read.floor(motion), one.heights)


class TestRates:
    @pytest.mark.parametrize(
        ("good", "of", "low", "high"),
        [(0, 10, 0.0, 0.27753), (5, 10, 0.23659, 0.76341), (10, 10, 0.72247, 1.0), (190, 200, 0.91042, 0.97262)],
    )
    def test_wilson(self, good, of, low, high):
        z, share = stats.norm.ppf(0.975), good / of
        centre, half = share + z**2 / (2 * of), z * np.sqrt(share * (1 - share) / of + z**2 / (4 * of**2))
        np.testing.assert_allclose(Rate(good, of).interval, [low, high], atol=1e-5)
        np.testing.assert_allclose(
            Rate(good, of).interval, np.array([centre - half, centre + half]) / (1 + z**2 / of), atol=1e-12
        )

    def test_with_and_without(self, rows):
        for stabilizer, limit in ((False, 30.0), (True, 70.0)):
            some = equipped(rows, stabilizer)
            assert rate(some) == Rate(sum(MEASURES["push [N]"](row) <= limit for row in some), 60)

    def test_bins_hold_every_draw_once(self, rows):
        some = equipped(rows, True)
        found = binned(some, "push [N]", np.linspace(0.0, 80.0, 9))
        assert sum(each.of for _, each in found) == 60
        assert all(10.0 * k <= value <= 10.0 * (k + 1) for k, (value, _) in enumerate(found))
        assert [each.share for _, each in found] == [1.0] * 7 + [0.0]

    def test_what_matters_comes_first(self, rows):
        for stabilizer in (False, True):
            first, *rest = influences(equipped(rows, stabilizer))
            assert first.measure == "push [N]"
            assert first.distance == 1.0
            assert first.p < 1e-6 < 0.01 < min(one.p for one in rest if not one.measure.startswith("push"))
            assert first.failed > first.succeeded
        assert most_influential(rows)[0] == "push [N]"
        assert influences([row for row in rows if row.success]) == []

    def test_steps_are_between_footholds(self, rows):
        row = dataclasses.replace(rows[0], ground="0.001 0.004 -0.002 -0.001")
        assert MEASURES["highest step up [mm]"](row) == pytest.approx(3.0)
        assert MEASURES["deepest step down [mm]"](row) == pytest.approx(6.0)
        assert MEASURES["highest step up [mm]"](dataclasses.replace(row, ground="")) == 0.0

    def test_tables(self, rows):
        without, with_it = rates_table(rows).rows
        failures = [row for row in equipped(rows, False) if not row.success]
        touched = sum(row.obstacle_x < 0.0 for row in failures)
        assert without[4:6] == (str(touched), str(len(failures) - touched))
        assert int(with_it[1].split()[0]) > int(without[1].split()[0])
        assert influence_table(rows, True).rows[0][0] == "push [N]"
        assert nearness_table(rows, True).rows[0][:2] == ("obstacle further ahead [mm]", "+1.00")
        assert len(failures_table(rows).rows) == sum(not row.success for row in rows)
        assert [row[-1] for row in agreement_table([(rows[0], YES), (rows[1], NO)]).rows] == [YES, NO]

    def test_tables_where_all_ends_alike(self, rows):
        good = [row for row in rows if row.success]
        assert failures_table(good).rows == (("none", "-", "-", "-"),)
        assert influence_table(good, True).rows[0][0] == "every draw ended alike"
        assert nearness_table(good[:1], True).rows[0][0] == "too few draws crossed"

    def test_what_takes_room_comes_first(self, rows):
        (name, rho, p), *rest = nearness(equipped(rows, True))
        assert (name, rho) == ("obstacle further ahead [mm]", pytest.approx(1.0))
        assert p < 1e-6 < min(one[2] for one in rest)

    def test_the_picture(self, rows, tmp_path):
        for some in (rows, rows[:2]):
            figures.save(figures.robustness(some), tmp_path / "picture.png")
            assert (tmp_path / "picture.png").stat().st_size > 10_000


class TestStudy:
    def test_rows(self, rows, motion):
        assert [(row.draw, row.stabilizer) for row in rows] == [(k, s) for k in range(60) for s in (False, True)]
        assert {(row.robot, row.motion, row.seed, row.actuators, row.sole) for row in rows} == {
            ("hrp2", motion.hash(), 0, "limited", "compliant")
        }
        for row in rows:
            touched = row.reason.startswith("hit")
            assert row.failure_time == (None if row.success else 2.0 if touched else 3.0)
            assert row.clearance == pytest.approx(-0.001 if touched else 0.02 + 0.1 * row.obstacle_x, abs=1e-6)
        require_current(rows, motion)

    def test_interrupted_and_continued_it_is_the_same(self, motion, quick, tmp_path, monkeypatch):
        whole, parts = tmp_path / "whole", tmp_path / "parts"
        study(motion, 4, table=tmp_path / "t.csv", build=whole, workers=1)
        uninterrupted = (tmp_path / "t.csv").read_bytes()
        (tmp_path / "t.csv").unlink()
        simulate = robustness.simulate

        def stopped(motion, **how):
            if len(quick) == 8 + 3:
                raise KeyboardInterrupt
            return simulate(motion, **how)

        monkeypatch.setattr(robustness, "simulate", stopped)
        with pytest.raises(KeyboardInterrupt):
            study(motion, 4, table=tmp_path / "t.csv", build=parts, workers=1)
        assert not (tmp_path / "t.csv").exists()
        (part,) = parts.iterdir()
        assert len(part.read_bytes().splitlines()) == 3
        part.write_bytes(part.read_bytes()[:-20])  # and killed while it wrote the third
        monkeypatch.setattr(robustness, "simulate", simulate)
        study(motion, 4, table=tmp_path / "t.csv", build=parts, workers=1)
        assert len(quick) == 8 + 3 + 6
        assert (tmp_path / "t.csv").read_bytes() == uninterrupted
        assert not part.exists()

    def test_a_longer_study_contains_the_shorter_one(self, motion, quick, tmp_path):
        path = tmp_path / "t.csv"
        study(motion, 2, table=path, build=tmp_path, workers=1)
        shorter = path.read_text()
        study(motion, 4, table=path, build=tmp_path, workers=1)
        assert path.read_text().startswith(shorter)
        assert len(path.read_text().splitlines()) == 1 + 8

    def test_an_interrupted_study_may_become_longer(self, motion, quick, tmp_path, monkeypatch):
        monkeypatch.setattr(studies, "write_rows", lambda *_: sys.exit("interrupted"))
        with pytest.raises(SystemExit):
            study(motion, 2, table=tmp_path / "t.csv", build=tmp_path, workers=1)
        monkeypatch.undo()
        monkeypatch.setattr(robustness, "simulate", lambda motion, **how: quick.append(how) or faked(motion, **how))
        study(motion, 4, table=tmp_path / "t.csv", build=tmp_path, workers=1)
        assert len(quick) == 8

    def test_what_it_depends_on_is_in_the_name_of_the_part_file(self, motion, short, quick, tmp_path, monkeypatch):
        names, run_study = [], studies.run_study
        monkeypatch.setattr(studies, "run_study", lambda points, work, part, **how: (
            names.append(part.name), run_study(points, work, part, **how))[1])  # fmt: skip

        def parts():
            return len(set(names))

        def run(carried=motion, **changed):
            study(carried, 1, table=tmp_path / "t.csv", build=tmp_path, workers=1, **changed)

        run()
        run()
        assert parts() == 1
        for count, changed in enumerate(
            [{"seed": 1}, {"sole": "rigid"}, {"actuators": "ideal"}, {"engine": "mujoco"}, {"carried": short}], 2
        ):
            run(**changed)
            assert parts() == count
        monkeypatch.setattr(robustness, "RANGES", dataclasses.replace(RANGES, push=(0.0, 90.0)))
        run()
        code = fingerprint.sources(robustness.__name__)
        monkeypatch.setattr(fingerprint, "sources", lambda module: code[1:])
        run()
        assert parts() == 8
        assert len(names) == 9

    def test_stale_tables_are_refused(self, rows, motion, short):
        with pytest.raises(InvalidInput, match="another motion"):
            require_current(rows, short)
        with pytest.raises(InvalidInput, match="another motion"):
            require_current([], motion)
        other = [*rows[:-1], dataclasses.replace(rows[-1], friction=0.39)]
        with pytest.raises(InvalidInput, match=r"draw 59 .* other ranges"):
            require_current(other, motion)

    def test_a_row_made_anew_agrees_or_not(self, rows, motion, quick):
        assert again(rows[5:2:-1], motion, 1) == [(row, YES) for row in rows[5:2:-1]]
        assert rows[5].success
        near, far = rows[5].clearance + 0.001, rows[5].clearance + 0.01
        for change, verdict in (
            ({"version": "0"}, YES), ({"state": "0"}, NEARLY), ({"clearance": near}, NEARLY), ({"clearance": far}, NO),
            ({"success": False}, NO), ({"motion": "0"}, NO),
        ):  # fmt: skip
            assert again([dataclasses.replace(rows[5], **change)], motion, 1)[0][1] == verdict, change

    def test_another_robot(self, motion):
        with pytest.raises(InvalidInput, match="unknown robot"):
            study(dataclasses.replace(motion, robot="hrp3"))
        with pytest.raises(InvalidInput, match="joints"):
            study(dataclasses.replace(motion, joint_names=motion.joint_names[::-1]))

    def test_jobs_do_not_change_the_physics(self, short, tmp_path):
        tables = [study(short, 2, table=tmp_path / f"{jobs}.csv", build=tmp_path, workers=jobs) for jobs in (1, 2)]
        assert tables[0].read_bytes() == tables[1].read_bytes()
        states = [row.state for row in read_table(tables[0])]
        assert len(set(states)) == 4, "each draw is another one, and the stabilizer does something"


def killed(command, *, after, by=signal.SIGKILL, mark=""):
    """Run a command, end it once a condition holds, and give exit code, stdout and stderr.

    SIGKILL goes to the command alone, SIGINT to its processes too, as from a terminal; all have the mark in their
    environment.
    """
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=SCRIPT.parent, start_new_session=True,
        env={**os.environ, "MARK": mark},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # which a shell's background ignores
    )  # fmt: skip
    deadline = time.monotonic() + 60.0
    while not after() and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    (process.send_signal if by == signal.SIGKILL else lambda by: os.killpg(process.pid, by))(by)
    output, errors = process.communicate(timeout=60)
    return process.returncode, output, errors


def lines_in(folder):
    """Finished rows in the part files of a folder."""
    return sum(len(part.read_bytes().splitlines()) for part in folder.glob("*.part"))


class TestKilled:
    @pytest.fixture
    def command(self, motion, tmp_path):
        motion.save(tmp_path / "m.npz")

        def make(folder):
            (tmp_path / folder).mkdir()
            table = tmp_path / folder / "t.csv"
            return table, [sys.executable, SCRIPT, "study", tmp_path / "m.npz", "--runs", "8", "--jobs", "1",
                           "--output", table]  # fmt: skip

        return make

    def test_killed_twice_the_table_is_the_same(self, command):
        whole, run = command("whole")
        subprocess.run(run, check=True, capture_output=True)
        table, run = command("killed")
        for count in (3, 8):
            assert killed(run, after=lambda count=count: lines_in(table.parent) >= count)[0] == -signal.SIGKILL
            assert not table.exists()
        subprocess.run(run, check=True, capture_output=True)
        assert table.read_bytes() == whole.read_bytes()
        simulated = table.with_name("simulated").read_text().splitlines()
        assert 16 <= len(simulated) <= 18, "only what was just being kept when it was killed may be done twice"
        assert list(table.parent.glob("*.part")) == []

    def test_interrupted_by_hand(self, command):
        table, run = command("interrupted")
        code, output, errors = killed(run, after=lambda: lines_in(table.parent) >= 3, by=signal.SIGINT)
        assert (code, output) == (130, "")
        assert len(errors.splitlines()) == 1
        assert "run the same command to continue" in errors

    @pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGINT])
    def test_processes_end_with_their_parent(self, tmp_path, by):
        run, running = [sys.executable, SCRIPT, "--slow", tmp_path / "squares.part"], []

        def after():
            running.extend(marked(str(tmp_path)) if lines_in(tmp_path) >= 3 else [])
            return running

        code, _, errors = killed(run, after=after, by=by, mark=str(tmp_path))
        assert code == -by
        assert len(running) >= 3, "itself and its workers"
        if by == signal.SIGINT:
            assert errors.count("Traceback") == 1, "of the interrupted process alone"
        kept = lines_in(tmp_path)
        assert 3 <= kept < 12
        assert lines_in(tmp_path) == kept
        rows = run_study(range(12), slow, tmp_path / "squares.part", workers=1)
        assert [row["square"] for row in rows] == [float(k**2) for k in range(12)]
        assert lines_in(tmp_path) == 12
        deadline = time.monotonic() + 10.0
        while (left := marked(str(tmp_path))) and time.monotonic() < deadline:
            time.sleep(0.1)
        assert left == []


def marked(mark):
    """Numbers of the processes with a mark in their environment."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if f"MARK={mark}".encode() in (process / "environ").read_bytes().split(b"\0"):
                found.append(int(process.name))
    return found


class TestCommand:
    @pytest.fixture(autouse=True)
    def elsewhere(self, tmp_path, monkeypatch, motion):
        monkeypatch.chdir(tmp_path)
        motion.save("m.npz")

    def call(self, *arguments):
        return CliRunner().invoke(main, [str(argument) for argument in arguments], prog_name="python -m stepover")

    def test_table_picture_and_json(self, quick):
        run = ["study", "m.npz", "--runs", 3, "--jobs", 1, "--output", "t.csv", "--picture", "t.png", "--json",
               "--engine", "mujoco"]  # fmt: skip
        result = self.call(*run)
        assert result.exit_code == 0, result.output
        printed = json.loads(result.stdout)
        assert printed == json.loads(json.dumps(study_to_json(read_table(Path("t.csv")))))
        assert set(printed) == {
            "robot", "motion", "actuators", "sole", "engine", "seed", "runs", "without_stabilizer", "with_stabilizer"
        }  # fmt: skip
        assert printed["runs"] == printed["with_stabilizer"]["runs"] == 3
        assert Path("t.png").stat().st_size > 10_000
        assert {(how["sole"], how["engine"]) for how in quick} == {("compliant", "mujoco")}

    def test_summary_and_an_obstacle_to_plan_for(self, quick):
        result = self.call("study", "--height", 0.15, "--width", 0.05, "--runs", 2, "--jobs", 1, "--output", "t.csv")
        assert result.exit_code == 0, result.output
        assert "with stabilizer     crossed" in result.stdout
        assert result.stdout.endswith("written to t.csv\n")
        require_current(read_table(Path("t.csv")), Motion.load("m.npz"))

    def test_a_robot_of_ones_own(self, quick):
        robot = str(HRP2 / "robot.toml")
        result = self.call("study", "m.npz", "--robot", robot, "--runs", 1, "--jobs", 1, "--output", "t.csv")
        assert result.exit_code == 0, result.output
        assert {row.robot for row in read_table(Path("t.csv"))} == {robot}
        assert {how["robot"].urdf_path.parent for how in quick} == {HRP2}

    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            (["m.npz", "--robot", "jvrc1", "--output", "t.csv"], ["joints", "jvrc1"]),
            (["m.npz", "--robot", "nowhere.toml", "--output", "t.csv"], ["nowhere.toml"]),
            (["m.npz", "--runs", "0", "--output", "t.csv"], ["--runs", "0"]),
            (["m.npz", "--runs", "many", "--output", "t.csv"], ["--runs", "many"]),
            (["m.npz", "--seed", "-1", "--output", "t.csv"], ["--seed", "-1"]),
            (["m.npz", "--jobs", "0", "--output", "t.csv"], ["--jobs", "0"]),
            (["m.npz", "--sole", "soft", "--output", "t.csv"], ["--sole", "soft"]),
            (["n.npz", "--output", "t.csv"], ["n.npz", "no such file"]),
            (["--output", "t.csv"], ["give a motion", "--height"]),
            (["--height", "0.1", "--output", "t.csv"], ["give a motion", "--width"]),
            (["m.npz", "--height", "0.1", "--width", "0.1", "--output", "t.csv"], ["not both"]),
            (["--height", "nan", "--width", "0.1", "--output", "t.csv"], ["height"]),
            (["m.npz"], ["--output"]),
            (["m.npz", "--output", "nowhere/t.csv"], ["nowhere", "does not exist"]),
            (["m.npz", "--output", "."], ["folder"]),
            (["m.npz", "--output", "t.csv", "--picture", "t.jpg"], ["t.jpg", ".png"]),
            (["m.npz", "--output", "t.csv", "--picture", "nowhere/t.png"], ["nowhere", "does not exist"]),
        ],
    )
    def test_bad_input(self, arguments, words, quick):
        result = self.call("study", *arguments)
        assert (result.exit_code, result.stdout) == (2, "")
        assert len(result.stderr.splitlines()) == 1
        for word in words:
            assert word in result.stderr
        assert quick == []
        assert os.listdir() == ["m.npz"]

    def test_an_obstacle_that_cannot_be_crossed(self, monkeypatch):
        def refuse(*_):
            raise Infeasible("too high")

        monkeypatch.setattr("stepover.planning.algorithm_1.planner.plan", refuse)
        result = self.call("study", "--height", "0.6", "--width", "0.1", "--output", "t.csv")
        assert result.exit_code == 3
        assert os.listdir() == ["m.npz"]

    def test_an_unfinished_motion_file(self):
        Path("m.npz").write_bytes(Path("m.npz").read_bytes()[:1000])
        result = self.call("study", "m.npz", "--output", "t.csv")
        assert result.exit_code == 2
        assert len(result.stderr.splitlines()) == 1


def test_the_stored_table_is_whole_and_of_todays_motion(motion):
    stored = read_table()
    require_current(stored, motion)
    made_of = [(row.draw, row.stabilizer, row.seed, row.actuators, row.sole) for row in stored]
    assert made_of == [(k, s, 0, "limited", "compliant") for k in range(200) for s in (False, True)]


def test_the_table_names_every_disturbance(rows):
    named = {field.name for field in dataclasses.fields(Outcome)}
    assert named >= {*rows[0].perturb} - {f"ground_{k}" for k in range(1, 8)} | {"ground"}
