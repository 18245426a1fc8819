"""The house's rules: who may import whom, one door for each library, and what the outside relies on."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path

import pytest
from packaging.requirements import Requirement

import stepover
from stepover.extras import EXTRAS, LAST_PYTHON
from stepover.locations import data_folder

ROOT = data_folder().parent
PACKAGE = ROOT / "stepover"
FILES = sorted(path for path in PACKAGE.rglob("*.py") if "data" not in path.relative_to(PACKAGE).parts[:1])
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())

# The rooms, from the ground up: nobody imports from above.
FLOORS = (
    ("stepover.errors",),
    ("stepover.extras", "stepover.locations", "stepover.output"),
    ("stepover.model",),
    ("stepover.robots",),
    ("stepover.motion",),
    (
        "stepover.planning.checks",
        "stepover.planning.measures",
        "stepover.planning.nearest",
        "stepover.planning.leg_check",
        "stepover.planning",
    ),
    ("stepover.control",),
    ("stepover.simulation",),
    ("stepover.analysis",),
    ("stepover.studies",),
    ("stepover.report",),
    ("stepover.reproduction",),
    ("stepover.cli", "stepover.__main__"),
)
# The one door to each library: a file, or a folder with everything in it.
DOORS = {
    "pinocchio": ("stepover.model",),
    "piqp": ("stepover.planning.optimal.qp",),
    "pybullet": ("stepover.simulation.pybullet",),
    "pybullet_data": ("stepover.simulation.pybullet",),
    "pybullet_utils": ("stepover.simulation.pybullet",),
    "mujoco": ("stepover.simulation.mujoco",),
    "meshcat": ("stepover.report.viewer",),
    "matplotlib.pyplot": ("stepover.report.figures",),
    "imageio_ffmpeg": ("stepover.report.render.film",),
    "PIL": ("stepover.report.render.gif",),
    "papermill": ("stepover.reproduction.run",),
    "joblib": ("stepover.studies.parallel",),
    "distributed": ("stepover.studies.parallel",),
}


def module_name(path: Path) -> str:
    """stepover.model.body for its file."""
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(path: Path):
    """Every module that a file imports, in functions too, but not for type checking alone."""
    tree = ast.parse(path.read_text())
    for node in ast.walk(tree):
        for child in ast.iter_child_nodes(node):
            child.for_types = getattr(node, "for_types", False) or (
                isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)
            )
    for node in ast.walk(tree):
        if getattr(node, "for_types", False):
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")) == "import_module":
            yield from (arg.value for arg in node.args if isinstance(arg, ast.Constant))


def inside(module: str, place: str) -> bool:
    """Whether a module is a place or lies in it."""
    return module == place or module.startswith(f"{place}.")


def floor(module: str) -> int | None:
    """Number of the floor of a module; None for the package itself, which only points to them."""
    return next((k for k, rooms in enumerate(FLOORS) if any(inside(module, room) for room in rooms)), None)


def edges():
    """What each module imports of the package, for type checking too: {module: {module, ...}}."""
    known = {module_name(path) for path in FILES}
    found = {}
    for path in FILES:
        named = set()
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom):
                full = {f"{node.module}.{alias.name}" for alias in node.names}
                named |= {name if name in known else node.module for name in full}
        found[module_name(path)] = {name for name in named if name in known and "." in name}
    return found


IDS = [module_name(path) for path in FILES]


def test_every_module_has_its_floor():
    assert [name for name in IDS if floor(name) is None and name != "stepover"] == []


@pytest.mark.parametrize("path", FILES, ids=IDS)
def test_imports_run_one_way(path):
    own = floor(module_name(path))
    if own is None:
        return
    above = {name for name in imports(path) if inside(name, "stepover") and (floor(name) or 0) > own}
    assert not above


def test_no_circle_of_imports():
    left = edges() | {"stepover": set()}
    while free := [name for name, needed in left.items() if not needed & set(left) - {name}]:
        for name in free:
            del left[name]
    assert sorted(left) == []


def test_no_folder_is_a_flat_room():
    rooms = Counter(path.parent for path in FILES if path.name != "__init__.py")
    assert {room.name: count for room, count in rooms.items() if count > 15} == {}


def test_no_room_holds_more_than_a_quarter():
    lines = Counter()
    for path in FILES:
        lines[path.relative_to(PACKAGE).parts[0]] += len(path.read_text().splitlines())
    assert max(lines.values()) <= lines.total() / 4


@pytest.mark.parametrize("path", FILES, ids=IDS)
def test_one_door_to_each_library(path):
    for name in imports(path):
        for library, doors in DOORS.items():
            if inside(name, library):
                assert any(inside(module_name(path), door) for door in doors), f"{library} has its door at {doors}"


def test_the_doors_are_used():
    used = {name for path in FILES for name in imports(path)}
    assert "pinocchio" in used
    assert any(inside(name, "matplotlib") for name in used)
    assert any(inside(name, "pybullet") for name in used)


@pytest.mark.parametrize("path", [p for p, name in zip(FILES, IDS, strict=True) if name.startswith(
    ("stepover.model", "stepover.planning.algorithm_1"))], ids=lambda path: module_name(path))  # fmt: skip
def test_no_printing_plotting_or_clock_in_model_and_units(path):
    timed = module_name(path) == "stepover.planning.algorithm_1.planner"  # says how long planning took
    for name in set(imports(path)) - ({"time"} if timed else set()):
        assert name.split(".")[0] not in ("time", "datetime", "matplotlib", "logging", "tqdm", "random"), name
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Call):
            assert getattr(node.func, "id", "") not in ("print", "input", "open"), f"{path}:{node.lineno}"
            assert not re.search(r"\brandom\b", ast.unparse(node.func)), f"{path}:{node.lineno}"


def test_importing_stepover_loads_neither_pinocchio_nor_pybullet():
    code = (
        "import sys, stepover; stepover.Obstacle(0.15, 0.05);"
        "print(sorted({'pinocchio', 'pybullet', 'matplotlib', 'meshcat', 'papermill'} & set(sys.modules)))"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


@pytest.mark.parametrize("name", ["Obstacle", "load_robot", "optimal_plan", "plan", "quasi_static_plan", "simulate",
                                  "Motion", "StepOverError", "InvalidInput", "Infeasible", "CorruptMotion"]
)  # fmt: skip
def test_the_promised_names_are_there(name):
    assert name in stepover.__all__
    assert getattr(stepover, name) is not None


def test_all_names_are_there_and_no_others():
    for name in stepover.__all__:
        assert getattr(stepover, name).__module__.startswith("stepover.")
    with pytest.raises(AttributeError, match="no attribute 'walk'"):
        _ = stepover.walk


def test_names_that_are_not_loaded_yet_are_listed():
    code = "import stepover; print(set(stepover.__all__) <= set(dir(stepover)))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "True\n"


def test_errors_derive_from_one():
    for error in (stepover.InvalidInput, stepover.Infeasible, stepover.CorruptMotion):
        assert issubclass(error, stepover.StepOverError)
    assert issubclass(stepover.InvalidInput, ValueError)
    assert not issubclass(stepover.Infeasible, ValueError)


def test_infeasible_says_what_can_be_crossed_instead():
    plain = stepover.Infeasible("the knee over-stretches")
    assert str(plain) == "the knee over-stretches"
    error = stepover.Infeasible("the knee over-stretches", stepover.Obstacle(0.2, 0.05))
    assert str(error).startswith("the knee over-stretches; the nearest obstacle")
    assert "0.200 m high" in str(error)


def test_versions_agree():
    cited = re.findall(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)
    assert [stepover.__version__] == [PYPROJECT["project"]["version"]] == cited


def test_every_subpackage_is_in_the_wheel():
    folders = {path.parent for path in FILES}
    assert all((folder / "__init__.py").is_file() for folder in folders)
    packages = {".".join(folder.relative_to(PACKAGE.parent).parts) for folder in folders}
    listed = PYPROJECT["tool"]["setuptools"]["packages"]
    assert set(listed) == packages | {"stepover.data"}
    assert len(listed) == len(set(listed))
    assert PYPROJECT["tool"]["setuptools"]["package-dir"] == {"stepover.data": "data"}
    patterns = PYPROJECT["tool"]["setuptools"]["package-data"]
    assert patterns["stepover.data"] == ["**/*"]


def test_other_files_of_the_package_are_in_the_wheel():
    patterns = PYPROJECT["tool"]["setuptools"]["package-data"]
    for path in PACKAGE.rglob("*"):
        if path.is_dir() or path.suffix in (".py", ".pyc") or "__pycache__" in path.parts:
            continue
        package = ".".join(path.parent.relative_to(PACKAGE.parent).parts)
        assert any(path.match(pattern) for pattern in patterns.get(package, [])), f"{path} is in no package-data"


def test_every_dependency_is_pinned_at_a_version_that_will_do():
    lines = [line for line in (ROOT / "environment.txt").read_text().splitlines() if line and line[0] != "#"]
    assert all(re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.]+", line) for line in lines)
    pins = {name.lower().replace("_", "-"): version for name, version in (line.split("==") for line in lines)}
    assert len(pins) == len(lines)
    project = PYPROJECT["project"]
    groups = [project["dependencies"], *project["optional-dependencies"].values()]
    every = (Requirement(text) for group in groups for text in group)
    for requirement in (one for one in every if one.name != "stepover"):
        assert requirement.name in pins, requirement
        assert requirement.specifier.contains(pins[requirement.name]), requirement


DISTRIBUTIONS = {
    "mujoco": "mujoco-core",
    "IPython": "ipython",
    "pinocchio": "pin",
    "PIL": "pillow",
    "pybullet_data": "pybullet",
    "pybullet_utils": "pybullet",
}


def distribution(module: str) -> str:
    """What installs a module."""
    return DISTRIBUTIONS.get(module, module.replace("_", "-"))


def required(group: list[str]) -> set[str]:
    """Names of the requirements of a group."""
    return {Requirement(text).name for text in group}


def test_imported_libraries_are_dependencies():
    imported = {name.split(".")[0] for path in FILES for name in imports(path)}
    foreign = imported - set(sys.stdlib_module_names) - {"stepover"}
    core = required(PYPROJECT["project"]["dependencies"])
    assert {distribution(name) for name in foreign - set(EXTRAS)} == core
    assert core == {"numpy", "scipy", "pin", "coal", "piqp", "mujoco-core", "click", "tqdm"}


def test_each_optional_library_is_in_its_extra():
    extras = PYPROJECT["project"]["optional-dependencies"]
    for module, extra in EXTRAS.items():
        assert distribution(module) in required(extras[extra]), module
    assert extras["pybullet"] == ["pybullet>=3.2.7; python_version < '3.12'"]
    assert LAST_PYTHON == {"pybullet": (3, 11)}


def test_inner_modules_take_only_the_version_from_the_package_itself():
    """A lazily loaded name would hide an import from the fingerprint of a study."""
    for path in (path for path in FILES if not inside(module_name(path), "stepover.cli")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module == "stepover":
                assert [alias.name for alias in node.names] == ["__version__"], path
