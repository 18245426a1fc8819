"""The claims: rules, records, and that claims.toml, claims.json, the pages and the notebooks agree."""

import dataclasses
import json
import math
import re
import subprocess
import sys
import time

import nbformat
import numpy as np
import pytest
from test_reproduce import write

from stepover.analysis import simplifications, speed
from stepover.errors import InvalidInput
from stepover.locations import checkout
from stepover.model.obstacle import Obstacle
from stepover.planning.algorithm_1.planner import plan, plan_in_detail
from stepover.reproduction import verdicts as module
from stepover.reproduction.captions import read_captions
from stepover.reproduction.claims import DIFFERS, VERDICTS, Claim, read_claims
from stepover.reproduction.marked import marks
from stepover.reproduction.pages import MARK, TELLING, claims_page, figures_page, readme_with, tally
from stepover.reproduction.recorder import Recorder, shown
from stepover.reproduction.run import NotebookFailed, reproduce
from stepover.reproduction.verdicts import gather, read_entries

START, END = marks(MARK)

TOP = checkout()
CLAIMS = read_claims()
NOTEBOOKS = {path.stem: nbformat.read(path, as_version=4) for path in (TOP / "notebooks").glob("*.ipynb")}
each = pytest.mark.parametrize("name", CLAIMS)


def claim(compare, paper=1.0, **more):
    return Claim("x", "I", "says so", paper, "printed", compare, "good", **more)


def as_toml(**claims):
    """claims.toml of some claims, each a table of what differs from a plain one."""
    plain = {
        "section": "I",
        "statement": "says so",
        "paper": 1.0,
        "judged_by": "ours",
        "compare": "within",
        "notebook": "good",
    }
    rows = {name: plain | row for name, row in claims.items()}
    return "\n".join(
        f"[{n}]\n" + "\n".join(f"{k} = {json.dumps(v)}" for k, v in row.items()) for n, row in rows.items()
    )


class TestRules:
    @pytest.mark.parametrize(
        ("compare", "paper", "tolerance", "good", "bad"),
        [
            ("within", 1.0, 0.1, (0.9, 1.0, 1.1), (0.899, 1.101, -1.0)),
            ("within", -1.0, 0.1, (-0.9, -1.1), (1.0, -0.89)),
            ("ratio", 40.0, 0.1, (36.0, 44.0), (35.99, 44.01, -40.0)),
            ("ratio", -40.0, 0.1, (-36.0, -44.0), (40.0, -35.0)),
            ("at most", 0.1, 0.0, (0.1, -5.0), (0.1001,)),
            ("at most", 0.47, 0.005, (0.475,), (0.4751,)),
            ("at least", 30.0, 0.0, (30.0, 31.0), (29.99,)),
            ("at least", 30.0, 1.0, (29.0,), (28.99,)),
            ("below", 1.0, 0.0, (0.99, -2.0), (1.0, 1.01)),
            ("above", 0.0, 0.0, (1e-9, 3), (0.0, -1.0)),
            ("above", 0.0, 1.0, (1.01,), (1.0,)),
            ("between", [15.0, 20.0], 0.0, (15.0, 19.9), (14.9, 20.0)),
            ("text", "crosses", 0.0, ("crosses",), ("falls", "Crosses", 1.0)),
        ],
    )
    def test_by_examples(self, compare, paper, tolerance, good, bad):
        one = claim(compare, paper, tolerance=tolerance)
        assert [one.holds(x) for x in good] == [True] * len(good)
        assert [one.holds(x) for x in bad] == [False] * len(bad)

    @pytest.mark.parametrize("compare", ["within", "ratio", "at most", "at least", "below", "above", "between"])
    @pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, None, "1.0", True])
    def test_what_is_no_number_never_holds(self, compare, value):
        assert not claim(compare, [0.0, 2.0] if compare == "between" else 1.0).holds(value)

    def test_of_a_list_each_value_counts(self):
        one = claim("within", [40.0, 20.0], tolerance=2.0)
        assert one.holds([39.0, 21.0])
        assert not one.holds([20.0, 40.0])
        assert not one.holds([39.0, math.nan])
        assert claim("at most").holds([0.5, 1.0])
        assert not claim("at most").holds([0.5, 1.5])
        with pytest.raises(InvalidInput, match="1 values are measured, 2 are compared"):
            one.holds(39.0)
        with pytest.raises(InvalidInput, match="0 values"):
            claim("at most").holds([])

    def test_a_bound_stands_for_a_word(self):
        assert claim("above", "higher", bound=0.0).holds(0.1)
        with pytest.raises(InvalidInput, match="compares with numbers, not with 'higher'"):
            claim("above", "higher")

    @pytest.mark.parametrize(
        ("more", "words"),
        [
            ({"compare": "near"}, "compare = 'near' must be one of"),
            ({"tolerance": -0.1}, "tolerance"),
            ({"tolerance": math.nan}, "tolerance"),
            ({"statement": ""}, "statement"),
            ({"compare": "between", "bound": [2.0, 1.0]}, "lower one first"),
            ({"compare": "text"}, "compares with texts"),
            ({"judged_by": "nobody"}, "judged_by = 'nobody' must be one of printed, ours, construction"),
            ({"colour": "red"}, "unknown key 'colour'"),
        ],
    )
    def test_a_claim_that_makes_no_sense(self, tmp_path, more, words):
        path = tmp_path / "claims.toml"
        path.write_text(as_toml(x=more).replace("NaN", "nan"))
        with pytest.raises(InvalidInput, match=words):
            read_claims(path)

    def test_a_claim_that_lacks_something(self, tmp_path):
        path = tmp_path / "claims.toml"
        path.write_text(as_toml(x={}).replace('notebook = "good"', ""))
        with pytest.raises(InvalidInput, match="claim 'x' lacks the key 'notebook'"):
            read_claims(path)
        path.write_text("x = 1")
        with pytest.raises(InvalidInput, match="x must be a table"):
            read_claims(path)
        with pytest.raises(InvalidInput, match="cannot be read"):
            read_claims(tmp_path / "none.toml")

    def test_tally_counts_findings_alone(self):
        one, two, three = VERDICTS
        said = [("printed", one), ("ours", one), ("ours", two), ("printed", three), ("ours", one)]
        rows = [{"judged_by": by, "verdict": verdict} for by, verdict in said]
        words = (
            "Of 5 findings 3 hold (1 by a bound that the paper prints, 2 by one of ours), 1 differ (0 and 1), and 1 "
        )
        words += "cannot be tested here. Not counted: "
        assert tally(rows) == f"{words}0 that are true by construction."
        setting = {"judged_by": "construction", "verdict": one}
        assert tally([*rows, setting]) == f"{words}1 that is true by construction.", "it raises no count"

    def test_how_values_are_shown(self):
        values = [0.04, 1200.0, 30.03, 1.3e5, 7, "leg 2", None, [0.78, 7]]
        assert [shown(x) for x in values] == ["0.04", "1200", "30", "1.3e+05", "7", "leg 2", "no number", "0.78, 7"]
        assert shown(4.0, "s") == "4 s"


@pytest.fixture
def known(tmp_path):
    """A claims.toml with two claims of the notebook good."""
    path = tmp_path / "data" / "claims.toml"
    path.parent.mkdir()
    path.write_text(as_toml(one={"tolerance": 0.1}, two={"compare": "above", "varies": True}))
    return path


class TestRecorder:
    def test_a_record(self, known, tmp_path):
        judged = Recorder("good", tmp_path, known, height=0.15)
        judged.record("one", np.float64(1.012345678), sample=np.int64(3))
        judged.record("two", [0.123456], "since it is small")
        first, second = json.loads((tmp_path / "good.claims.json").read_text())
        assert (first["measured"], first["verdict"], first["reason"]) == (1.012, "holds", "")
        assert first["parameters"] == {"height": 0.15, "sample": 3}
        assert {"stepover", "python", "numpy"} <= set(first["versions"])
        assert (second["measured"], second["verdict"]) == ([0.12], "differs")
        assert judged.table().rows[1][1:] == ("1", "0.12", "differs", "ours", "since it is small")

    def test_a_claim_holds_if_it_holds_in_every_engine(self, known, tmp_path):
        judged = Recorder("good", tmp_path, known)
        judged.record("one", {"pybullet": 1.0, "mujoco": 1.05})
        judged.record("two", {"pybullet": 1.2, "mujoco": 0.9}, "it is close")
        first, second = judged.records.values()
        assert (first["measured"], first["verdict"], first["reason"]) == (1.0, "holds", "")
        assert first["engines"]["mujoco"] == {"measured": 1.05, "verdict": "holds"}
        assert (second["measured"], second["verdict"]) == (1.2, "differs")
        assert second["reason"] == "it is close; the engines disagree: holds in PyBullet, differs in MuJoCo"
        assert [row[2] for row in judged.table().rows] == [
            "1 (PyBullet), 1.05 (MuJoCo)",
            "1.2 (PyBullet), 0.9 (MuJoCo)",
        ]

    def test_no_number_is_null_and_differs(self, known, tmp_path):
        Recorder("good", tmp_path, known).record("one", math.nan)
        assert [row["measured"] for row in json.loads((tmp_path / "good.claims.json").read_text())] == [None]

    def test_what_is_refused(self, known, tmp_path):
        judged = Recorder("good", tmp_path, known)
        with pytest.raises(InvalidInput, match="'three' is no claim of this notebook"):
            judged.record("three", 1.0)
        with pytest.raises(InvalidInput, match="'one' is no claim of this notebook"):
            Recorder("other", tmp_path, known).record("one", 1.0)
        with pytest.raises(InvalidInput, match="needs a reason"):
            judged.record("one", None, verdict="cannot be tested here")
        with pytest.raises(InvalidInput, match="must be one of holds"):
            judged.record("one", 1.0, verdict="maybe")
        judged.record("one", None, "no such robot", verdict="cannot be tested here")

    def test_again_is_the_same_to_the_byte_and_the_last_one_counts(self, known, tmp_path):
        for value in (2.0, 1.0):
            judged = Recorder("good", tmp_path, known)
            judged.record("one", value)
        judged.record("one", 1.0)
        text = (tmp_path / "good.claims.json").read_text()
        assert [row["measured"] for row in json.loads(text)] == [1.0]
        Recorder("good", tmp_path, known).record("one", 1.0)
        assert (tmp_path / "good.claims.json").read_text() == text
        assert not list(tmp_path.glob("*.part"))


@pytest.fixture
def top(tmp_path, known):
    """A checkout with two notebooks, their claims and old results."""
    known.write_text(as_toml(one={}, two={"notebook": "other"}))
    (tmp_path / "figures").mkdir()
    (tmp_path / "README.md").write_text(f"before\n{START}\nold\n{END}\nafter\n")
    begin = "from pathlib import Path\n\nfrom stepover.reproduction.recorder import Recorder\n"
    for name, which in (("good", "one"), ("other", "two")):
        recorder = f'judged = Recorder("{name}", output, Path({str(known)!r}), height=height)'
        write(tmp_path, name, begin + recorder, f'judged.record("{which}", height / 0.15, "why")')
    return tmp_path


RESULTS = "figures/claims.json", "docs/claims.md", "docs/figures.md", "README.md"


def results(top):
    return [(top / name).read_bytes() if (top / name).exists() else None for name in RESULTS]


class TestReproduce:
    def test_records_become_claims_and_a_table(self, top):
        assert reproduce(top) == [top / name for name in RESULTS]
        rows = read_entries(top / "figures" / "claims.json")
        assert [(row["id"], row["measured"], row["verdict"]) for row in rows] == [
            ("one", 1.0, "holds"),
            ("two", 1.0, "holds"),
        ]
        text = (top / "README.md").read_text()
        assert text.startswith(f"before\n{START}\n{tally(rows)}\n\n| claim | paper |")
        assert text.endswith(f"\n{END}\nafter\n")
        assert "I; [notebook](../notebooks/good.ipynb) |" in (top / "docs" / "claims.md").read_text()
        first = results(top)
        reproduce(top)
        assert results(top) == first, "a second run gives the same to the byte"

        reproduce(top, "good", {"height": "0.3"})
        assert results(top) == first, "own parameters change nothing"
        own = json.loads((top / "build" / "figures" / "good.claims.json").read_text())
        assert [(row["measured"], row["verdict"]) for row in own] == [(2.0, "differs")]

        path = top / "notebooks" / "good.ipynb"
        path.write_text(path.read_text().replace("height / 0.15", "height / 0.3"))
        other = top / "notebooks" / "other.ipynb"
        other.write_text(other.read_text().replace("height / 0.15", "height / 0.3"))
        reproduce(top, "good")
        rows = read_entries(top / "figures" / "claims.json")
        assert [(row["measured"], row["verdict"]) for row in rows] == [(0.5, "differs"), (1.0, "holds")]

    @pytest.mark.parametrize("end", ["raise ValueError('late')", "import os\n\nos._exit(1)"])
    def test_a_failing_or_dying_notebook_leaves_the_old_claims(self, top, end):
        (top / "figures" / "claims.json").write_text("[]")
        old = results(top)
        write(top, "zlast", end)
        with pytest.raises(NotebookFailed):
            reproduce(top)
        assert results(top) == old

    def test_a_killed_run_leaves_the_old_claims_and_the_next_one_is_right(self, top):
        (top / "figures" / "claims.json").write_text("[]")
        old, begun = results(top), top / "begun"
        wait = f"import time\nfrom pathlib import Path\n\nPath({str(begun)!r}).touch()\ntime.sleep(60)"
        write(top, "zlast", wait)
        run = "import sys, pathlib; from stepover.reproduction import run as r; r.reproduce(pathlib.Path(sys.argv[1]))"
        with subprocess.Popen([sys.executable, "-c", run, str(top)], stderr=subprocess.DEVNULL) as process:
            while not begun.exists() and process.poll() is None:
                time.sleep(0.05)
            assert process.poll() is None
            process.kill()
        assert results(top) == old
        write(top, "zlast", "quick")
        reproduce(top)
        assert [row["id"] for row in read_entries(top / "figures" / "claims.json")] == ["one", "two"]


class TestGather:
    @pytest.fixture
    def records(self, top):
        """What both notebooks of top record."""
        found = {}
        for notebook, name in (("good", "one"), ("other", "two")):
            Recorder(notebook, top, top / "data" / "claims.toml").record(name, 1.0)
            found[notebook] = module.take_records(top)
        assert not list(top.glob("*.claims.json"))
        return found

    def refused(self, top, found, words, whole=True):
        (top / "figures" / "claims.json").write_text("[]")
        old = results(top)
        with pytest.raises(InvalidInput, match=words):
            gather(top, found, whole)
        assert results(top) == old

    def test_a_claim_without_a_record(self, top, records):
        self.refused(top, records | {"other": []}, r"without a record: two \(other\)")
        self.refused(top, {"good": []}, r"without a record: one \(good\)", whole=False)
        assert gather(top, {"good": records["good"]}, whole=False), "the others are not asked for then"

    def test_a_record_without_a_claim(self, top, records):
        self.refused(top, {"good": records["good"] + records["other"]}, "good records 'two'")
        stranger = [records["good"][0] | {"id": "three"}]
        self.refused(top, records | {"good": stranger}, "good records 'three'")

    def test_what_differs_needs_a_reason(self, top, records):
        records["good"][0]["verdict"] = DIFFERS
        self.refused(top, records, "differ without a reason: one")
        records["good"][0]["reason"] = "so it is"
        gather(top, records, True)
        assert "**differs**: so it is" in (top / "docs" / "claims.md").read_text()

    def test_what_depends_on_the_machine_stays_while_it_says_the_same(self, top, records):
        varies = {"compare": "above", "paper": 0.0, "varies": True}
        two = {"notebook": "other"}
        (top / "data" / "claims.toml").write_text(as_toml(one=varies, two=two | varies))
        gather(top, records, True)
        before = results(top)
        for claim in (row for rows in records.values() for row in rows):
            claim["measured"] = 2.0
        gather(top, records, True)
        assert results(top) == before
        records["good"][0]["versions"] = {"numpy": "9"}
        records["other"][0] |= {"verdict": DIFFERS, "reason": "slower"}
        gather(top, records, True)
        stored = read_entries(top / "figures" / "claims.json")
        assert [(row["measured"], row["verdict"]) for row in stored] == [(2.0, "holds"), (2.0, DIFFERS)]
        (top / "data" / "claims.toml").write_text(as_toml(one={}, two=two))
        records["good"][0]["measured"] = 3.0
        gather(top, records, True)
        assert read_entries(top / "figures" / "claims.json")[0]["measured"] == 3.0, "every other number is stored anew"

    def test_what_is_stored_and_no_longer_claimed_goes_away(self, top, records):
        gather(top, records, True)
        (top / "data" / "claims.toml").write_text(as_toml(one={}))
        gather(top, {"good": records["good"]}, False)
        assert [row["id"] for row in read_entries(top / "figures" / "claims.json")] == ["one"]

    def test_damaged_files_are_named(self, top, records):
        for text in ("[{}]", "{", "[1]"):
            (top / "figures" / "claims.json").write_text(text)
            with pytest.raises(InvalidInput, match=r"claims\.json is no list of claims"):
                gather(top, {"good": records["good"]}, False)
        for text in ("no markers", f"{END} {START}", f"{START} {START} {END}"):
            (top / "README.md").write_text(text)
            with pytest.raises(InvalidInput, match="must hold"):
                gather(top, records, True)
        (top / "README.md").unlink()
        with pytest.raises(InvalidInput, match=r"README\.md cannot be read"):
            gather(top, records, True)

    @pytest.mark.parametrize(
        ("figure", "captions", "words"),
        [
            ("a.png", "", "figure 'a' has no caption"),
            ("a.png", '[a]\nnotebook = "good"\ncaption = "A."\n[b]\n', "figure 'b' has a caption but no file"),
            ("a.gif", "[a]\nnotebook = 'good'", "needs 'notebook' and 'caption'"),
            ("a.png", "[a", "not valid TOML"),
        ],
    )
    def test_figures_and_captions_must_agree(self, top, records, figure, captions, words):
        (top / "figures" / figure).touch()
        (top / "data" / "figures.toml").write_text(captions)
        self.refused(top, records, words)

    def test_a_figure_is_shown_with_caption_notebook_and_claims(self, top, records):
        (top / "figures" / "a.png").touch()
        (top / "data" / "figures.toml").write_text('[a]\nnotebook = "good"\ncaption = "What to see."\n')
        (top / "data" / "claims.toml").write_text(as_toml(one={"figure": "a"}, two={"notebook": "other"}))
        gather(top, records, True)
        page = (top / "docs" / "figures.md").read_text()
        for words in ("## a\n", "![a](../figures/a.png)", "What to see.", "(../notebooks/good.ipynb)",
                      "Claims: [one](claims.md#one)."):  # fmt: skip
            assert words in page

    def test_a_checkout_without_claims(self, tmp_path):
        assert gather(tmp_path, {"good": []}, True) == []


class TestThePapersClaims:
    @each
    def test_is_recorded_once_by_its_notebook(self, name):
        cells = [cell.source for cell in NOTEBOOKS[CLAIMS[name].notebook].cells if cell.cell_type == "code"]
        tables = "".join(path.read_text() for path in (TOP / "stepover" / "report" / "tables").glob("*.py"))
        assert sum(cell.count(f'judged.record("{name}"') for cell in cells) + tables.count(f'("{name}",') == 1

    @each
    def test_has_a_figure_where_it_names_one(self, name):
        figure = CLAIMS[name].figure
        assert not figure or (TOP / "figures" / f"{figure}.png").is_file()

    @pytest.mark.parametrize("one", read_captions(TOP), ids=lambda one: one.file)
    def test_a_figure_is_drawn_by_the_notebook_that_its_caption_names(self, one):
        name = re.compile(rf'"{one.file.split(".")[0]}(\.\w+)?"')
        assert one.caption
        drawn_by = {
            stem for stem, book in NOTEBOOKS.items()
            if any(name.search(cell.source) for cell in book.cells if cell.cell_type == "code")
        }  # fmt: skip
        assert drawn_by == {one.notebook}

    def test_toml_json_and_pages_agree(self):
        rows = read_entries(TOP / "figures" / "claims.json")
        assert [row["id"] for row in rows] == list(CLAIMS)
        for row in rows:
            one = CLAIMS[row["id"]]
            assert row == module.entry(one, row), row["id"]
            assert row["verdict"] in VERDICTS
            assert row["reason"] or row["verdict"] == "holds", row["id"]
            if row["verdict"] != "cannot be tested here":
                values = [each["measured"] for each in row.get("engines", {}).values()] or [row["measured"]]
                assert (row["verdict"] == "holds") == all(one.holds(value) for value in values), row["id"]
        assert (TOP / "README.md").read_text() == readme_with(TOP / "README.md", rows)
        assert (TOP / "docs" / "claims.md").read_text() == claims_page(rows)
        assert (TOP / "docs" / "figures.md").read_text() == figures_page(read_captions(TOP), rows)

    def test_readme_shows_five_claims_with_both_verdicts(self):
        shown_in_readme = [row for row in read_entries(TOP / "figures" / "claims.json") if row["id"] in TELLING]
        assert len(shown_in_readme) == len(TELLING) == 5
        assert {row["verdict"] for row in shown_in_readme} == {"holds", "differs"}

    def test_all_are_there(self):
        assert len(CLAIMS) == 46


class TestWhatIsMeasured:
    """A changed parameter changes what is measured."""

    def test_of_the_motion(self, robot, motion):
        higher = plan(robot, Obstacle(0.20, 0.05))
        for measured in (
            lambda m: np.ptp(simplifications.waist_above_com(m)),
            lambda m: simplifications.momentum(robot, m).yaw,
            lambda m: simplifications.momentum(robot, m).share[0],
            lambda m: m.key_configuration[0],
        ):
            assert measured(motion) != pytest.approx(measured(higher), rel=1e-3)

    def test_timing(self, motion):
        assert simplifications.timing(motion) == pytest.approx([0.78, 0.02, 1.5, 0.04, 7])
        assert simplifications.special_steps(motion) == pytest.approx(4 * 1.5 + 3 * 0.04)

    def test_momentum_is_a_point_masses_where_all_of_the_robot_moves_as_one(self, robot, motion):
        """No link turns and all go one way: about the CoM nothing is left, and the ZMP is the cart's."""
        q = np.tile(robot.half_sitting(), (200, 1))
        q[:, 0] += 0.05 * np.sin(np.arange(200) * 0.005 * 5.0)
        q[:, 1] += 0.02 * np.sin(np.arange(200) * 0.005 * 3.0)
        com = robot.body.com(robot.body.placements(q))

        class Still:
            dt = 0.005

        Still.q, Still.com = q, com
        found = simplifications.momentum(robot, Still)
        assert max(*found.share, *found.zmp, found.yaw_share) < 1e-9
        turning = simplifications.momentum(robot, motion)
        assert (turning.share > 0.05).all()
        assert 0.0 < turning.yaw_share < turning.share.max()

    def test_leg_and_masses(self, robot):
        assert simplifications.leg_length(robot) == pytest.approx(0.705, abs=0.001)
        assert 0.5 < simplifications.upper_body_share(robot) < 1.0

    def test_forward_speed(self, motion):
        least, mean, when = simplifications.forward_speed(motion)
        assert 0.05 < least < mean < 0.3
        landings = motion.footsteps.time
        assert landings[0] <= when <= landings[3], "from the step before to the end of phase 3"

    def test_a_robot_that_stops_is_slow(self, motion):
        stopped = motion.com.copy()
        stopped[motion.samples(1)] = stopped[motion.samples(1).start]
        least, mean, _ = simplifications.forward_speed(dataclasses.replace(motion, com=stopped))
        assert least < 0.1 * mean

    def test_planning_times(self, robot, obstacle, motion):
        first, tick, in_sweeps, in_samples = speed.planning_times(robot, obstacle, motion, 1.0, 1)
        assert min(first, tick, in_sweeps, in_samples) > 0.0
        assert first + tick * len(motion.time) == pytest.approx(1.0)

    def test_an_online_tick_costs_more_than_its_share_of_a_batch(self, robot, obstacle):
        planned = plan_in_detail(robot, obstacle)
        tick, in_samples = speed.online_tick(robot, planned, 3)
        assert 0.0 < tick < 0.1
        assert in_samples > 5.0
