"""Disturbances: deviations from the plan, each with its unit, sign and range."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from stepover.errors import InvalidInput
from stepover.model.gravity import GRAVITY
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.motion.motion import Motion

GROUND_RANGE = (-0.05, 0.05)
"""Range of the floor's height under a foothold [m]."""


def _of(what: str, unit: str, low: float, high: float, default: float | None = 0.0) -> Any:
    """A disturbance with its description, unit and range."""
    return field(default=default, metadata={"what": what, "unit": unit, "low": low, "high": high})


@dataclass(frozen=True)
class Disturbances:
    """All disturbances of a simulation. The default of each is "as planned". Each field's metadata has unit and range.

    Attributes:
        footholds: floor heights under single footholds, as (number from 1, height [m]). They are named ground_1,
            ground_2 ... in the order of the motion's footsteps.
    """

    friction: float | None = _of("friction of all contacts; replaces the robot's value", "1", 0.01, 2.0, None)
    ground_leg_1: float = _of("floor height under the foothold of leg 1", "m", *GROUND_RANGE)
    ground_leg_2: float = _of("floor height under the foothold of leg 2", "m", *GROUND_RANGE)
    slope_ahead: float = _of("slope of the floor, up ahead; the obstacle stands on it", "deg", -10.0, 10.0)
    slope_left: float = _of("slope of the floor, up to the left", "deg", -10.0, 10.0)
    chest_mass: float = _of("added mass at the chest's centre, as a share of the robot's mass", "1", -0.15, 0.5)
    chest_com_x: float = _of("forward shift of the chest's centre of mass", "m", -0.1, 0.1)
    obstacle_x: float = _of("forward shift of the obstacle", "m", -0.5, 0.5)
    obstacle_height: float = _of("added height of the obstacle", "m", -0.3, 0.3)
    push_x: float = _of("forward push at the waist", "N", -2000.0, 2000.0)
    push_y: float = _of("push at the waist to the left", "N", -2000.0, 2000.0)
    push_time: float = _of("start time of the push", "s", 0.0, 1000.0)
    push_duration: float = _of("duration of the push", "s", 0.001, 10.0, 0.1)
    latency: float = _of("extra sensor delay, added to one period", "s", 0.0, 0.1)
    noise_joints: float = _of("standard deviation of the sensed joint angles", "rad", 0.0, 0.1)
    noise_attitude: float = _of("standard deviation of the sensed attitude", "deg", 0.0, 10.0)
    noise_rate: float = _of("standard deviation of the sensed angular velocity", "rad/s", 0.0, 1.0)
    noise_force: float = _of("standard deviation of the sensed forces", "N", 0.0, 100.0)
    noise_moment: float = _of("standard deviation of the sensed moments", "N m", 0.0, 20.0)
    seed: float = _of("seed of the noise, a whole number", "1", 0.0, 2.0**32 - 1.0)
    footholds: tuple[tuple[int, float], ...] = ()

    @staticmethod
    def read(values: Mapping[str, float], motion: Motion) -> Disturbances:
        """Read disturbances from their names and values.

        Raises:
            InvalidInput: an unknown name, a value outside its range, or a foothold that the motion does not have.
        """
        known = {f.name: f.metadata for f in fields(Disturbances) if f.metadata}
        named, footholds = {}, []
        for name, value in values.items():
            match = re.fullmatch(r"ground_([1-9]\d*)", name)
            if match and int(match[1]) <= len(motion.footsteps):
                footholds.append((int(match[1]), _checked(name, value, "m", *GROUND_RANGE)))
            elif name in known:
                about = known[name]
                named[name] = _checked(name, value, about["unit"], about["low"], about["high"])
            else:
                last = f"ground_1 to ground_{len(motion.footsteps)}"
                raise InvalidInput(
                    f"disturbance {name!r} is not available; available: {', '.join(known)}, "
                    f"{last} (one for each foothold)"
                )
        if named.get("seed", 0.0) != int(named.get("seed", 0.0)):
            raise InvalidInput(f"seed = {named['seed']:g} must be a whole number")
        return Disturbances(**named, footholds=tuple(sorted(footholds)))

    @property
    def gravity(self) -> np.ndarray:
        """Gravity (3,) in the frame of the floor, whose z axis is its normal [m/s^2].

        For a slope, the floor stays level and gravity is turned. So the obstacle, the plan and all measurements stay
        in one frame.
        """
        down = np.array([-np.tan(np.radians(self.slope_ahead)), -np.tan(np.radians(self.slope_left)), -1.0])
        return GRAVITY * down / np.linalg.norm(down)

    def obstacle(self, row: np.ndarray) -> np.ndarray:
        """Disturbed position and height of an obstacle (6,) of a motion.

        Raises:
            InvalidInput: the height would not be positive.
        """
        if row[2] + self.obstacle_height <= 0.0:
            raise InvalidInput(f"obstacle_height = {self.obstacle_height:g} m: the obstacle is {row[2]:g} m high")
        changed = row.copy()
        changed[0] += self.obstacle_x
        changed[2] += self.obstacle_height
        return changed

    def floor(self, motion: Motion) -> np.ndarray:
        """Floor height (K,) under every foothold of a motion [m]. Numbered heights are added."""
        heights = np.zeros(len(motion.footsteps))
        for kind, height in ((LEG_1, self.ground_leg_1), (LEG_2, self.ground_leg_2)):
            heights[motion.footsteps.kind == kind] += height
        for number, height in self.footholds:
            heights[number - 1] += height
        return heights

    def push(self, time: float) -> np.ndarray:
        """Force (3,) on the waist at a time [N]."""
        acts = self.push_time - 1e-9 <= time < self.push_time + self.push_duration - 1e-9
        return np.array([self.push_x, self.push_y, 0.0]) if acts else np.zeros(3)

    @property
    def pushes(self) -> bool:
        """Whether there is a push."""
        return bool(self.push_x or self.push_y)

    @property
    def loads(self) -> bool:
        """Whether the chest's mass or centre of mass is disturbed."""
        return bool(self.chest_mass or self.chest_com_x)


NONE = Disturbances()
"""No disturbance: everything is as planned."""


def explained() -> list[tuple[str, str]]:
    """All disturbances by name, with unit, meaning and range, for --help."""
    known = [(f.name, f.metadata) for f in fields(Disturbances) if f.metadata]
    rows = [(name, f"[{m['unit']}] {m['what']}; {m['low']:g} to {m['high']:g}") for name, m in known]
    low, high = GROUND_RANGE
    return [*rows, ("ground_1, ...", f"[m] floor height under the first foothold, and so on; {low:g} to {high:g}")]


def _checked(name: str, value: float, unit: str, low: float, high: float) -> float:
    """The value, if it is within its range."""
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    if not number or not low <= value <= high:
        unit = "" if unit == "1" else f" {unit}"
        raise InvalidInput(f"{name} = {value!r} must be a number from {low:g} to {high:g}{unit}")
    return float(value)
