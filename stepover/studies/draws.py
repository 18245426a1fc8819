"""Disturbances drawn at random, under the names that simulate knows them by: a draw follows from seed and number."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from stepover.motion.motion import Motion
from stepover.studies.study import rounded


@dataclass(frozen=True)
class Ranges:
    """Lowest and highest value of each disturbance; every one is drawn uniformly, on its own.

    Attributes:
        friction: between everything.
        slope: the floor rises ahead, and to the left [deg].
        chest_mass: more mass at the chest, as a share of the robot's.
        chest_com_x: centre of mass of the chest further ahead [m].
        obstacle_x: obstacle further ahead [m].
        push: size of one push at the waist [N]; its direction is any in the plane, and it begins at any time of the
            motion that leaves room for it.
        push_duration: how long it lasts, always [s].
        late: what the robot senses is older by this, on top of the one period of 5 ms that it always is: 5 to 10 ms
            in all [s].
        ground: floor under each foothold higher [m].
    """

    friction: tuple[float, float] = (0.4, 1.0)
    slope: tuple[float, float] = (-1.0, 1.0)
    chest_mass: tuple[float, float] = (-0.05, 0.05)
    chest_com_x: tuple[float, float] = (-0.010, 0.010)
    obstacle_x: tuple[float, float] = (-0.020, 0.020)
    push: tuple[float, float] = (0.0, 80.0)
    push_duration: float = 0.1
    late: tuple[float, float] = (0.0, 0.005)
    ground: tuple[float, float] = (-0.005, 0.005)


RANGES = Ranges()
"""Of every study."""


@dataclass(frozen=True)
class Draw:
    """One draw of all disturbances, under the names that simulate knows them by.

    Attributes:
        seed, draw: what it depends on.
        friction: between everything.
        slope_ahead, slope_left: how the floor rises [deg].
        chest_mass: as a share of the robot's mass.
        chest_com_x, obstacle_x: further ahead [m].
        push_x, push_y: push at the waist [N].
        push_time, push_duration: when it begins, and how long it lasts [s].
        latency: beside the one period [s].
        ground: heights of the floor under the footholds, one after the other, with a space between [m].
    """

    seed: int
    draw: int
    friction: float
    slope_ahead: float
    slope_left: float
    chest_mass: float
    chest_com_x: float
    obstacle_x: float
    push_x: float
    push_y: float
    push_time: float
    push_duration: float
    latency: float
    ground: str

    @property
    def heights(self) -> list[float]:
        """Heights of the floor under the footholds [m]."""
        return [float(height) for height in self.ground.split()]

    @property
    def perturb(self) -> dict[str, float]:
        """For simulate, and for simulate's --perturb."""
        named = {field.name: getattr(self, field.name) for field in dataclasses.fields(Draw)[2:-1]}
        return named | {f"ground_{number}": height for number, height in enumerate(self.heights, 1)}


def draw(motion: Motion, seed: int, number: int, ranges: Ranges = RANGES) -> Draw:
    """One draw out of the ranges, to six decimals, so that the table says exactly what was simulated.

    Args:
        motion: how long it lasts, and how many footholds it has.
        seed: of the study, not negative.
        number: of the draw, from 0.
        ranges: what is drawn from.
    """
    random = np.random.default_rng([seed, number])

    def one(ends: tuple[float, float]) -> float:
        return rounded(random.uniform(*ends), 6)

    push, direction = random.uniform(*ranges.push), random.uniform(0.0, 2.0 * np.pi)
    return Draw(
        seed, number, one(ranges.friction), one(ranges.slope), one(ranges.slope), one(ranges.chest_mass),
        one(ranges.chest_com_x), one(ranges.obstacle_x),
        rounded(push * np.cos(direction), 6), rounded(push * np.sin(direction), 6),
        one((motion.time[0], motion.time[-1] - ranges.push_duration)), ranges.push_duration, one(ranges.late),
        " ".join(str(one(ranges.ground)) for _ in range(len(motion.footsteps))),
    )  # fmt: skip
