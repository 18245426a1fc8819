"""Mutated inputs: seeded, and what may come of them: a result, or one line of an error of ours."""

from __future__ import annotations

import io
import resource
import shutil
import signal
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from stepover import Motion, Obstacle, StepOverError, load_robot, plan
from stepover.locations import data_folder
from stepover.planning.algorithm_1.planner import plan_in_detail

SECONDS, WAITING, MEGABYTES = 10, 120, 500
"""What one input may take at most: of the processor, of the clock, and of memory."""
HRP2 = data_folder() / "hrp2"
NUMBERS = (
    "nan",
    "inf",
    "-inf",
    "0",
    "-1",
    "1e308",
    "1e-308",
    "0,5",
    "1_0",
    "9" * 5000,
    "",
    "x",
    "true",
    "[]",
    "0x1p3",
    "-0.0",
)
TEXTS = (
    "",
    "\x00",
    "ä",
    "&",
    "<",
    ">",
    '"',
    "../../etc/passwd",
    "package://os/x",
    "/dev/zero",
    "{}",
    "[[",
    "=" * 50,
    "\ufeff",
)


class Broken(AssertionError):
    """An input that brings a traceback, takes too long or too much, or leaves files."""


@contextmanager
def limited(seconds: int = SECONDS, megabytes: int = MEGABYTES) -> Iterator[None]:
    """Fail where what is inside computes for longer, hangs, or takes more memory on top of what there is."""

    def late(*_: object) -> None:
        raise Broken(f"no answer within {seconds} s")

    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    old = [signal.signal(which, late) for which in (signal.SIGPROF, signal.SIGALRM)]
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.alarm(WAITING)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.alarm(0)
        signal.signal(signal.SIGPROF, old[0])
        signal.signal(signal.SIGALRM, old[1])
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024.0
    if grown > megabytes:
        raise Broken(f"{grown:.0f} MB more")


def tried(attempt: Callable[[], object], folder: Path) -> str:
    """What comes of an attempt: "accepted", or the line of its error.

    Raises:
        Broken: another error than ours, a message of several lines, the limits, or files that are left in the folder.
    """
    files = sorted(folder.rglob("*"))
    try:
        with limited(), warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            attempt()
            said = "accepted"
    except StepOverError as error:
        said = str(error)
    except Broken:
        raise
    except BaseException as error:
        raise Broken(f"{type(error).__name__}: {error}") from error
    if "\n" in said or not said.strip() or len(said) > 2000:
        raise Broken(f"not one line: {said[:300]!r}")
    if sorted(folder.rglob("*")) != files:
        raise Broken("files are left behind")
    return said


def mutated_text(text: str, random: np.random.Generator) -> str:
    """A text with one to three changes: of a number, a word, a line or a character."""
    for _ in range(random.integers(1, 4)):
        kind = random.integers(6)
        if kind <= 1:
            text = _with_number(text, random)
        elif kind == 2:
            lines = text.split("\n")
            k, other = random.integers(len(lines), size=2)
            lines[k] = ("", lines[other], lines[k] + "\n" + lines[k])[random.integers(3)]
            text = "\n".join(lines)
        elif kind == 3:
            k = int(random.integers(len(text) + 1))
            text = text[:k] + str(random.choice(TEXTS)) + text[k + int(random.integers(0, 4)) :]
        elif kind == 4:
            k = int(random.integers(len(text)))
            text = text[:k] if random.random() < 0.3 else text[:k] + text[k + int(random.integers(1, 200)) :]
        else:
            words = [word for word in text.replace("=", " ").replace('"', " ").split() if word.isidentifier()]
            if len(words) > 1:
                old, new = random.choice(words, 2)
                text = text.replace(str(old), str(new), 1)
    return text


def _with_number(text: str, random: np.random.Generator) -> str:
    """One of a text's numbers changed: to nonsense, by a factor, or its sign."""
    spots = [(k, word) for k, word in _words(text) if word.lstrip("-").replace(".", "", 1).isdigit()]
    if not spots:
        return text
    k, word = spots[random.integers(len(spots))]
    way = random.integers(3)
    factor = float(random.choice([0.001, 0.1, 0.5, 2.0, 10.0, 1000.0]))
    new = (str(random.choice(NUMBERS)), repr(float(word) * factor), "-" + word)[way]
    return text[:k] + new + text[k + len(word) :]


def _words(text: str) -> Iterator[tuple[int, str]]:
    """Words of a text, split at white space and quotation marks, with their places."""
    start = 0
    for k, letter in enumerate(text + " "):
        if letter in ' \n\t"=,[]':
            if k > start:
                yield start, text[start:k]
            start = k + 1


def mutated_motion(whole: bytes, random: np.random.Generator) -> bytes:
    """A motion file with a changed member, or changed bytes."""
    if random.random() < 0.4:
        data = bytearray(whole)
        for k in random.integers(len(data), size=random.integers(1, 20)):
            data[k] = random.integers(256)
        return bytes(data[: random.integers(len(data))] if random.random() < 0.3 else data)
    with np.load(io.BytesIO(whole)) as archive:
        arrays = dict(archive)
    key = str(random.choice(sorted(arrays)))
    arrays[key] = _mutated_array(arrays[key], random)
    if random.random() < 0.1:
        del arrays[key]
    if random.random() < 0.1:
        arrays["another"] = np.zeros(10)
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()


def _mutated_array(array: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """An array of another type, shape or value."""
    kind = random.integers(6)
    if kind == 0 and array.dtype.kind != "U":
        return array.astype(str(random.choice(["U8", "S8", "float16", "int64", "bool", "complex128", "longdouble"])))
    if kind == 1:
        return np.array(random.choice([np.nan, np.inf, 1e300, -1.0, 0.0, 3.0])) if array.ndim == 0 else array[:0]
    if kind == 2:
        return array[None] if random.random() < 0.5 else array.ravel()
    if kind == 3 and array.ndim:
        return array[: random.integers(len(array) + 1)]
    if array.dtype.kind in "iuf" and array.size:
        flat = array.astype(float).ravel()
        value = random.choice([np.nan, np.inf, 1e300, -1.0, 0.0, 5.0, 1e-300])
        flat[random.integers(flat.size, size=random.integers(1, 4))] = value
        return flat.reshape(array.shape)
    return np.array(str(random.choice(TEXTS)))


class Fuzz:
    """Inputs of one kind by their seeds, in a folder of their own."""

    def __init__(self, folder: Path, motion: Motion) -> None:
        """Put HRP-2's files there."""
        self._folder = folder
        for path in HRP2.iterdir():
            shutil.copy(path, folder)
        motion.save(folder / "whole.npz")
        self._whole = (folder / "whole.npz").read_bytes()

    def urdf(self, seed: int) -> str:
        """A mutated URDF, loaded and planned with."""
        text = mutated_text((HRP2 / "hrp2.urdf").read_text(), np.random.default_rng(seed))
        (self._folder / "hrp2.urdf").write_text(text, errors="surrogatepass")
        (self._folder / "robot.toml").write_text((HRP2 / "robot.toml").read_text())
        return tried(self._plan, self._folder)

    def robot_toml(self, seed: int) -> str:
        """A mutated robot.toml, loaded and planned with."""
        text = mutated_text((HRP2 / "robot.toml").read_text(), np.random.default_rng(seed))
        shutil.copy(HRP2 / "hrp2.urdf", self._folder)
        (self._folder / "robot.toml").write_text(text)
        return tried(self._plan, self._folder)

    def _plan(self) -> None:
        """What is done with each robot: a small obstacle, and its refusal with all that belongs to it."""
        plan(load_robot(self._folder / "robot.toml"), Obstacle(0.05, 0.05))

    def motion(self, seed: int) -> str:
        """A mutated motion file, loaded."""
        path = self._folder / "mutated.npz"
        path.write_bytes(mutated_motion(self._whole, np.random.default_rng(seed)))
        return tried(lambda: Motion.load(path), self._folder)

    def obstacle(self, seed: int) -> str:
        """An odd obstacle."""
        random = np.random.default_rng(seed)
        odd = [
            0.0,
            -0.1,
            np.nan,
            np.inf,
            1e306,
            1e15,
            1e-9,
            570.0,
            605.0,
            3000.0,
            True,
            "0.1",
            None,
            1j,
            np.float16(0.1),
        ]
        plain = {"height": 0.05, "width": 0.05, "margin_height": 0.03, "margin_width": 0.03, "distance": None}
        for name in random.choice(sorted(plain), random.integers(1, 3), replace=False):
            plain[str(name)] = odd[random.integers(len(odd))]
        robot = load_robot("hrp2")
        return tried(lambda: plan_in_detail(robot, Obstacle(**plain), look_for_nearest=False), self._folder)
