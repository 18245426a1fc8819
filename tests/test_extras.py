"""A Python without any extra: it plans and simulates in MuJoCo, and says which extra brings what it lacks."""

import json
import os
import re
import subprocess
import sys

import numpy as np
import pytest

import stepover
from stepover.cli import main
from stepover.extras import EXTRAS, needs
from stepover.locations import data_folder

ROOT = data_folder().parent
NEWER = sys.version_info[:2] > (3, 11)
THIS = f", which has no wheel for Python {sys.version_info.major}.{sys.version_info.minor}" if NEWER else ""
NO_PYBULLET = (
    f"simulate needs PyBullet{THIS}: pip install 'stepover[pybullet]'{' under Python 3.11' if NEWER else ''}, "
    "or take --engine mujoco"
)
BLOCKED = """
import sys
class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in LIBRARIES:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, Blocked())
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("core")


def python(folder, code, *arguments):
    code = f"LIBRARIES = {sorted(EXTRAS)}{BLOCKED}{code}"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip


def run(folder, *arguments):
    return python(folder, "import runpy; runpy.run_module('stepover', run_name='__main__', alter_sys=True)", *arguments)


@pytest.fixture(scope="module")
def planned(folder):
    options = ["--height", "0.05", "--width", "0.05", "--output", "m.npz", "--csv", "m.csv", "--json"]
    done = run(folder, "plan", *options)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["robot"] == "hrp2"
    return folder / "m.npz"


def test_plan(planned, folder):
    assert len(np.load(planned)["time"]) + 1 == len((folder / "m.csv").read_text().splitlines())


def test_the_library_plans(planned, folder):
    code = """
import stepover
motion = stepover.plan(stepover.load_robot("hrp2"), stepover.Obstacle(0.05, 0.05))
assert motion.hash() == stepover.Motion.load("m.npz").hash()
try:
    stepover.simulate(motion)
except stepover.InvalidInput as error:
    print(error)
"""
    done = python(folder, code)
    assert (done.stdout, done.stderr) == (f"{NO_PYBULLET}\n", "")


def test_mujoco_simulates(planned, folder):
    done = run(folder, "simulate", "m.npz", "--engine", "mujoco", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads(done.stdout)
    assert (found["crossed"], found["engine"]) == (True, "mujoco")


def test_help(folder):
    for arguments in (["--help"], *([name, "--help"] for name in main.commands)):
        done = run(folder, *arguments)
        assert (done.returncode, done.stderr) == (0, ""), arguments
        assert done.stdout.startswith("Usage: ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("simulate m.npz", NO_PYBULLET),
        (
            "simulate m.npz --engine mujoco --video m.mp4",
            "a video needs imageio_ffmpeg: pip install 'stepover[report]'",
        ),
        ("view m.npz --output m.html", "view needs meshcat: pip install 'stepover[report]'"),
        ("sweep --heights 0.1 --widths 0.05 --output t.csv", "sweep needs joblib: pip install 'stepover[studies]'"),
        ("study m.npz --output t.csv", "study needs joblib: pip install 'stepover[studies]'"),
        ("reproduce --only tour", "reproduce needs papermill: pip install 'stepover[notebooks]'"),
    ],
)
def test_what_is_missing_is_named(planned, folder, arguments, message):
    done = run(folder, *arguments.split())
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"error: {message}\n")


class TestNeeds:
    def missing(self, module):
        with needs("flying"):
            raise ModuleNotFoundError(f"No module named {module!r}", name=module)

    def test_the_extra_is_named(self):
        with pytest.raises(stepover.InvalidInput, match=r"^flying needs matplotlib: pip install 'stepover\[report\]'$"):
            self.missing("matplotlib.figure")

    def test_a_python_without_wheels(self, monkeypatch):
        monkeypatch.setattr(sys, "version_info", (3, 13, 0))
        words = "PyBullet, which has no wheel for Python 3.13: pip install 'stepover[pybullet]' under Python 3.11"
        with pytest.raises(stepover.InvalidInput, match=re.escape(words)):
            self.missing("pybullet")
        with pytest.raises(stepover.InvalidInput, match=r"joblib: pip install 'stepover\[studies\]'$"):
            self.missing("joblib")

    def test_other_modules_are_not_ours_to_explain(self):
        with pytest.raises(ModuleNotFoundError, match="numpy"):
            self.missing("numpy")
