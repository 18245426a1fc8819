"""The documents: README's code runs, numbers are those of the project, links lead somewhere, names exist."""

import importlib
import inspect
import json
import re

import nbformat
import pytest

import stepover
from stepover import Obstacle, load_robot
from stepover.cli import commands
from stepover.locations import checkout
from stepover.reproduction.claims import read_claims
from stepover.reproduction.marked import marks
from stepover.reproduction.pages import MARK
from stepover.reproduction.run import parameters_of
from stepover.studies.trials import UNDISTURBED, read_table

START, END = marks(MARK)

TOP = checkout()
README = (TOP / "README.md").read_text()
DOCUMENTS = [
    *sorted(TOP.glob("*.md")), *sorted((TOP / "docs").glob("*.md")), *sorted((TOP / "data").glob("*/README.md"))
]  # fmt: skip
NUMBER = r"\d+(?:\.\d+)?"
CLAIMS = {row["id"]: row for row in json.loads((TOP / "figures" / "claims.json").read_text())}
PAPER = {name: claim.paper for name, claim in read_claims().items()}
NOT_MEASURED = (
    r"25\(4\), 2009", r"Python 3\.11", r"Figs?\. \d+", r"\(\d+\)", r"Algorithm 1", r"leg [12]\b", r"L1 to L7", r"\b3-D",
    r"HRP-2", r"JVRC-1", r"BSD-2",
)  # fmt: skip
"""Numbers that name something."""


def measured(name, which=None):
    """What a claim's notebook measured."""
    value = CLAIMS[name]["measured"]
    return value if which is None else value[which]


def asked(notebook, name):
    """A parameter of a notebook."""
    return parameters_of(TOP / "notebooks" / f"{notebook}.ipynb")[name]


def source_of(notebook):
    """All code of a notebook."""
    cells = nbformat.read(TOP / "notebooks" / f"{notebook}.ipynb", as_version=4).cells
    return "\n".join(cell.source for cell in cells if cell.cell_type == "code")


def tables(text):
    """Cells of all rows of markdown's tables, but for heads and rules."""
    rows = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| ")]
    return [row for row in rows if not set(row[0]) <= set("- ") and row[0] not in ("symbol", "figure")]


def prose(text):
    """A page without code, headings, addresses and README's block: where a number could go stale unseen."""
    text = re.sub(f"{START}.*{END}", "", text, flags=re.DOTALL)
    text = re.sub(r"```.*?```|^#.*?$", "", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"\]\([^)]*\)", "]", re.sub(r"`[^`]*`", "", text))
    text = re.sub(r"\[[\w-]+\]", "", text)  # names of notebooks, figures and claims
    return re.sub(r"\s+", " ", text)


MARGIN = 100.0 * Obstacle(0.15, 0.05).margin_height
HIGH = 100.0 * asked("pybullet_25cm", "height")
WITH_UBMG = float(re.search(r"nothing beyond the paper, ([\d.]+) cm", CLAIMS["without-ubmg"]["reason"])[1])
CODES = (commands.DONE, commands.BAD_INPUT, commands.INFEASIBLE, commands.NOT_CROSSED)
SERVOS = [row for row in read_table() if row.name == UNDISTURBED and row.stabilizer]
FASTEST = max((row for row in SERVOS if row.speed_limits == "ignore"), key=lambda row: row.speed_ratio)
SLOW = [row for row in SERVOS if row.speed_limits == "respect"]
TRIED = [100.0 * height for height in asked("adaptation", "heights")]
STATED = {
    "README.md": {
        "crosses {} cm, more than a third of its leg length": [HIGH],
        "the red veil is the safety margin of {} cm": [MARGIN],
        "and ZMP every {} ms": [1e3 * load_robot("hrp2").walk.sample_time],
        "the paper's methods alone reach {} cm with our robot": [WITH_UBMG],
        "swings both feet later instead: {} cm keeps the margin too": [HIGH],
        "takes {} s at our ZMP tolerance of {} mm": [
            measured("quasi-static-time"),
            1e3 * asked("quasi_static_vs_dynamic", "epsilon"),
        ],
        "Our servos cross {} cm; the real ones stopped at {}": [min(measured("limit-20")), 15.0],
        "plan the paper's {} cm case": [100.0 * asked("stepover_15cm", "height")],
        "do at {} cm": [100.0 * asked("stepover_25cm", "height")],
        "Does {} cm cross in the physics": [HIGH],
        "Why did it take {} s before": [PAPER["quasi-static-time"]],
        "JVRC-1 ({} kg, legs of {} m": "jvrc1",
        "crosses {} cm, {} % of its leg length, without": "jvrc1",
    },
    "docs/command_line.md": {
        "The exit code is {} for success, {} for bad input, {} for an obstacle that cannot be crossed, and {}": CODES,
        "An interruption gives {}": [commands.INTERRUPTED],
        "With code {} the message": [commands.INFEASIBLE],
        "With code {} you get a plot": [commands.NOT_CROSSED],
        "At {} cm on rubber, a knee reaches more than twice": [100.0 * FASTEST.height],
        "fails from {} cm up": [100.0 * min(row.height for row in SLOW)],
    },
    "docs/figures.md": {
        "HRP-2 crosses {} cm in the physics": [HIGH],
        "with the required margin of {} cm": [MARGIN],
        "one picture every {} s": [0.64],
        "at {} cm the rear leg enters": [HIGH],
        "the crossing of {} cm.": [HIGH],
        "At {} cm the ZMP reaches": [HIGH],
        "keeps {} cm at {} cm too": [MARGIN, HIGH],
        "each unit at {}, {} and {} cm": TRIED,
        "torques and speeds at {} to {} cm": [15.0, max(measured("limit-20"))],
        "{} s to shift the CoM, or {} ms": [measured("double-support", 1), 1e3 * measured("double-support", 0)],
        "The paper's {} s and {} s depend": [PAPER["quasi-static-time"], PAPER["double-support"][1]],
    },
}
"""Each sentence with a number, by its page; {} stands for the number, and the list says what it must round to."""
SENTENCES = [(page, sentence) for page, sentences in STATED.items() for sentence in sentences]


def pattern(sentence):
    return re.escape(sentence).replace(r"\{\}", f"({NUMBER})").replace(r"\ ", " ")


def numbers_in(page, sentence):
    found = re.findall(pattern(sentence), prose((TOP / page).read_text()))
    assert len(found) == 1, f"{sentence!r} stands {len(found)} times in {page}"
    return [found[0]] if isinstance(found[0], str) else list(found[0])


@pytest.mark.parametrize(("page", "sentence"), SENTENCES)
def test_numbers_of_the_pages(page, sentence):
    values = STATED[page][sentence]
    if values == "jvrc1":
        pytest.importorskip("jvrc_description")
        robot, height = load_robot("jvrc1"), 0.18  # tests/test_own_robot.py steps over it
        length = robot.leg(1).length
        values = [robot.body.mass, length] if "kg" in sentence else [100.0 * height, 100.0 * height / length]
    for text, value in zip(numbers_in(page, sentence), values, strict=True):
        digits = len(text.partition(".")[2])
        assert text == f"{value:.{digits}f}"


@pytest.mark.parametrize("page", STATED)
def test_no_other_number_stands_in(page):
    text = prose((TOP / page).read_text())
    for known in (*map(pattern, STATED[page]), *NOT_MEASURED):
        text = re.sub(known, "", text)
    assert [text[max(0, m.start() - 30) : m.end() + 20] for m in re.finditer(rf"(?<!\w){NUMBER}", text)] == []


def test_words_that_are_numbers():
    """More than a third; halves on rigid soles; a tenth; tenfold; more than twice its speed limit; none crosses."""
    assert CLAIMS["speed-up"]["verdict"] == "holds"
    assert 2.0 < FASTEST.speed_ratio < 3.0
    assert (FASTEST.sole, FASTEST.speed_joint) == ("compliant", load_robot("hrp2").legs.knee[1])
    assert not any(row.crossed for row in SLOW)
    assert measured("leg-ratio-25") > 100.0 / 3.0
    assert measured("margin-25") >= 10.0 * MARGIN
    assert measured("impact-ratio") > 0.9  # the landing force is not halved on rubber, but on rigid soles
    assert 0.45 < float(re.search(rf"rigid soles ({NUMBER})", CLAIMS["impact-ratio"]["reason"])[1]) < 0.55
    assert "np.arange(start, end + 0.64, 0.64)" in source_of("pybullet_15cm")


def test_readme_in_its_first_minute():
    heads = re.findall(r"^## (.*)$", README, re.MULTILINE)
    assert README.index("crossing_25cm.gif") < README.index("## ")
    assert heads[:3] == ["Two commands", "Ten lines of Python", "The claims"]
    assert len(README.split()) <= 1200


def test_readmes_lines_of_python_run_as_they_stand(tmp_path, monkeypatch, capsys):
    (block,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len([line for line in block.splitlines() if line.strip()]) <= 10
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "README.md", "exec"), {"__name__": "readme"})
    assert capsys.readouterr().out.startswith("crossed: True; ")
    assert stepover.Motion.load(tmp_path / "motion.npz").time[-1] > 5.0


def test_commands_of_the_pages_exist():
    said = set(re.findall(r"^python -m stepover (\w+)", (TOP / "docs" / "command_line.md").read_text(), re.MULTILINE))
    assert said == {"plan", "simulate", "study", "view", "sweep", "reproduce"}
    assert said <= set(stepover.cli.main.commands)
    targets = set(re.findall(r"^([a-z]+):", (TOP / "Makefile").read_text(), re.MULTILINE))
    assert set(re.findall(r"\bmake ([a-z]+)", README)) - {"and"} <= targets


def links(text):
    """Targets of all links in a markdown text."""
    return re.findall(r"\]\(([^)\s]+)\)", re.sub(r"```.*?```", "", text, flags=re.DOTALL))


def check_links(text, folder, place=None):
    """Every relative link and anchor of a text in a folder holds in a checkout, as GitHub resolves them."""
    for target in links(text):
        if target.startswith(("https://", "http://")):
            continue
        path, _, part = target.partition("#")
        found = (folder / path).resolve() if path else place
        assert found.is_relative_to(TOP), target
        assert found.exists(), target
        if part:
            assert part in {anchor(head) for head in re.findall(r"^#+ (.*)$", found.read_text(), re.MULTILINE)}, target


def anchor(head):
    """GitHub's address of a head."""
    return re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-")


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(TOP)))
def test_links_lead_somewhere(document):
    check_links(document.read_text(), document.parent, document)


@pytest.mark.parametrize("notebook", sorted((TOP / "notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_links_of_notebooks_lead_somewhere(notebook):
    cells = nbformat.read(notebook, as_version=4).cells
    check_links("\n".join(cell.source for cell in cells if cell.cell_type == "markdown"), notebook.parent, notebook)


@pytest.mark.parametrize("target", ["no_such.md", "README.md#no-such-heading", "docs/claims.md#no-such-claim", "../.."])
def test_a_broken_link_is_found(target):
    with pytest.raises(AssertionError):
        check_links(f"[a link]({target})", TOP, TOP / "README.md")


def test_every_figure_and_notebook_is_listed():
    shown = set(re.findall(r"^!\[\w+\]\(\.\./figures/(.*?)\)", (TOP / "docs" / "figures.md").read_text(), re.MULTILINE))
    assert shown == {path.name for path in (TOP / "figures").iterdir() if path.suffix in (".png", ".gif")}
    listed = set(re.findall(r"^\| \[\w+\]\(notebooks/(\w+)\.ipynb\)", README.split(END)[1], re.MULTILINE))
    assert listed == {path.stem for path in (TOP / "notebooks").glob("*.ipynb")}


def lookup(name):
    """What a dotted name under stepover stands for: module, function, class, or something of a class's instances."""
    parts = f"stepover.{name}".split(".")
    for k in range(len(parts), 0, -1):
        try:
            found, rest = importlib.import_module(".".join(parts[:k])), parts[k:]
        except ModuleNotFoundError:
            continue
        break
    for part in rest:
        if part in getattr(found, "__annotations__", {}):
            return part
        if not hasattr(found, part):
            assert re.search(rf"self\.{part}\b.* = ", inspect.getsource(found)), name
            return part
        found = getattr(found, part)
    return found


SYMBOLS = tables((TOP / "docs" / "symbols.md").read_text())
NAMES = sorted({name for row in SYMBOLS for name in re.findall(r"`([\w.]+)`", row[-1])})


@pytest.mark.parametrize("name", NAMES)
def test_names_of_the_symbols_exist(name):
    assert lookup(name) is not None


@pytest.mark.parametrize("name", ["units.feasibility.KeyConfiguration.y_ads", "model.body.Body.masses", "units.walk"])
def test_a_name_that_does_not_exist_is_found_out(name):
    with pytest.raises((AssertionError, AttributeError, ModuleNotFoundError)):
        lookup(name)


def test_the_symbols_that_matter_are_there():
    cells = " ".join(row[0] for row in SYMBOLS)
    for symbol in ("o_h", "o_w", "s_h", "s_w", "X_{ads}", "X_{hds}", "Z_{hds}", r"\delta_{DS}", "p}^{ref_1}", "N_L",
                   "p}^{ref_2}", "p}^{MB}", "$Q$", "$R$", "$T$", "z_c", "F_W", "W_2(t)", "UB(t)"):  # fmt: skip
        assert symbol in cells, symbol
