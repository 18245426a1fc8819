"""The floor: corners of a swinging sole stay above it, and come down along a braking curve.

Height: z >= h min(t / 0.16 s, 1)^2 for the time t to the nearer end of the swing. Speed: a sole that brakes evenly
keeps z'^2 / v^2 <= z / 10 mm, so 10 mm above the floor it is no faster than v.
"""

from __future__ import annotations

import numpy as np

from stepover.planning.optimal.channels import SIDES, of_sole
from stepover.planning.optimal.constraints.group import Group, Local
from stepover.planning.optimal.instants import Instants
from stepover.planning.optimal.scene import Scene

LENGTH = 0.02
"""Violation [m] that counts as 1."""
NEAR_END = 0.16
"""How far from its ends a swing keeps the full height [s]."""
LOW = 0.01
"""Height at which the speed is told [m]."""
BRAKING = 0.15
"""How long before touch-down a sole brakes [s]."""


def sole_heights(seen: Instants) -> Group:
    """Heights of the four corners of both soles while they swing."""
    foot = seen.scene.robot.foot
    values, places = np.full((len(seen.now), 8), -1.0), np.empty((8, 2))
    for k, side in enumerate(SIDES):
        wanted, sole = _wanted(seen.scene, side), seen.now[:, of_sole(side)]
        y = sorted(-side * value for value in foot.contact_y)
        places[4 * k : 4 * k + 4] = [(x, across) for x in (-foot.heel, foot.toe) for across in y]
        swings = np.flatnonzero(wanted >= 0.0)
        for column in range(4 * k, 4 * k + 4):
            height = _corner(sole[swings], *places[column])[0]
            values[swings, column] = (wanted[swings] - height) / LENGTH

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        found = np.zeros((len(rows), seen.now.shape[1]))
        for k, side in enumerate(SIDES):
            some, first = np.flatnonzero(columns // 4 == k), of_sole(side).start
            sole = seen.now[rows[some]][:, of_sole(side)]
            by_pitch, by_roll = _corner(sole, *places[columns[some]].T)[1:]
            found[some, first + 2], found[some, first + 4], found[some, first + 5] = 1.0, by_pitch, by_roll
        return Local(channels=-found / LENGTH)

    return Group("sole above the floor", values, _names(4), LENGTH, "m", gradient)


def landing_speed(seen: Instants) -> Group:
    """Vertical speed of both soles against the braking curve, before they touch down."""
    fastest, dt = seen.scene.parameters.landing_speed, seen.scene.dt
    values = np.full((len(seen.now), 2), -1.0)
    columns_of_z = [of_sole(side).start + 2 for side in SIDES]
    height, before, after = (seen.steps[k][:, columns_of_z] for k in (1, 0, 2))
    speed = (after - before) / (2.0 * dt)
    for k, side in enumerate(SIDES):
        brakes = np.flatnonzero(_until_landing(seen.scene, side) <= BRAKING)
        curve = np.minimum(speed[brakes, k], 0.0) ** 2 / fastest**2 - height[brakes, k] / LOW
        values[brakes, k] = curve * LOW / LENGTH

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        first = np.array(columns_of_z)[columns]
        falls = np.minimum(speed[rows, columns], 0.0)
        here = np.zeros((len(rows), seen.now.shape[1]))
        quick = here.copy()
        each = np.arange(len(rows))
        here[each, first] = -1.0 / LENGTH
        quick[each, first] = 2.0 * falls / fastest**2 * LOW / LENGTH
        return Local(channels=here, channel_speeds=quick)

    return Group("landing speed", values, _names(1), LENGTH, "m of height", gradient)


def _names(each: int) -> list[str]:
    """Left and right sole, some times each."""
    return ["left sole"] * each + ["right sole"] * each


def _swings(scene: Scene, side: int) -> list[tuple[float, float]]:
    """Lift-off and touch-down of all swings of a foot [s]."""
    time = scene.base.time
    return [(time[s.lift_off], time[s.touch_down]) for s in scene.base.sequence.steps if s.side == side]


def _wanted(scene: Scene, side: int) -> np.ndarray:
    """Least height (n,) of a sole while it swings [m], -1 where it stands."""
    found = np.full(len(scene.samples), -1.0)
    for begin, end in _swings(scene, side):
        spare = np.minimum(scene.time - begin, end - scene.time)
        swings = spare > 1e-9
        found[swings] = scene.parameters.sole_lift * np.clip(spare[swings] / NEAR_END, 0.0, 1.0) ** 2
    return found


def _until_landing(scene: Scene, side: int) -> np.ndarray:
    """Time (n,) until a swinging foot touches down [s], infinite where it stands."""
    found = np.full(len(scene.samples), np.inf)
    for begin, end in _swings(scene, side):
        swings = (scene.time > begin + 1e-9) & (scene.time < end - 1e-9)
        found[swings] = end - scene.time[swings]
    return found


def _corner(sole: np.ndarray, x: np.ndarray | float, y: np.ndarray | float) -> tuple[np.ndarray, ...]:
    """Height (n,) of a sole's point (x, y), for sole channels (n, 6), and its derivatives by pitch and roll."""
    pitch, roll = sole[:, 4], sole[:, 5]
    height = sole[:, 2] - np.sin(pitch) * x + np.cos(pitch) * np.sin(roll) * y
    by_pitch = -np.cos(pitch) * x - np.sin(pitch) * np.sin(roll) * y
    return height, by_pitch, np.cos(pitch) * np.cos(roll) * y
