"""Random disturbances, with the names that simulate uses. A draw depends only on the seed and its number."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from stepover.motion.motion import Motion
from stepover.studies.study import rounded


@dataclass(frozen=True)
class Ranges:
    """Lowest and highest value of each disturbance. Each is drawn uniformly and independently.

    Attributes:
        friction: friction of all contacts.
        slope: slope of the floor, up ahead, and the same up to the left [deg].
        chest_mass: added mass at the chest, as a share of the robot's mass.
        chest_com_x: forward shift of the chest's centre of mass [m].
        obstacle_x: forward shift of the obstacle [m].
        push: size of one push at the waist [N]. Its horizontal direction is random. It begins at a random time, early
            enough to end within the motion.
        push_duration: duration of the push, always the same [s].
        late: extra sensor delay, added to the period of 5 ms that every reading takes. The total is 5 to 10 ms [s].
        ground: floor height under each foothold [m].
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
"""Ranges of every study."""


@dataclass(frozen=True)
class Draw:
    """One draw of all disturbances, with the names that simulate uses.

    Attributes:
        seed, draw: seed and number of the draw.
        friction: friction of all contacts.
        slope_ahead, slope_left: slope of the floor [deg].
        chest_mass: added mass at the chest, as a share of the robot's mass.
        chest_com_x, obstacle_x: forward shifts [m].
        push_x, push_y: push at the waist [N].
        push_time, push_duration: start and duration of the push [s].
        latency: sensor delay, in addition to one period [s].
        ground: floor heights under the footholds [m], as one text with spaces between them.
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
        """The disturbances as simulate and its option --perturb take them."""
        named = {field.name: getattr(self, field.name) for field in dataclasses.fields(Draw)[2:-1]}
        return named | {f"ground_{number}": height for number, height in enumerate(self.heights, 1)}


def draw(motion: Motion, seed: int, number: int, ranges: Ranges = RANGES) -> Draw:
    """One draw from the ranges. Values have six decimals, so that the table states exactly the simulated values.

    Args:
        motion: gives the duration and the number of footholds.
        seed: seed of the study, not negative.
        number: number of the draw, from 0.
        ranges: ranges of the values.
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
