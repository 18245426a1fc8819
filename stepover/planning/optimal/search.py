"""From low obstacles to the one that is asked for, and from few samples to all: the order in which problems are solved.

First the obstacle itself is tried from the base motion. Where that fails, or where it is far from what the base motion
clears, a chain of obstacles leads to it, each from the solution of the one before. A solution is then looked at every
5 ms. Samples that break a constraint are added, and the problem is solved again.

Where an obstacle cannot be crossed, the chain says how far it led. From there bisection looks for the nearest obstacle
that can be. If not even the chain's first one can be, half its height is tried, and so on.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from stepover.model.obstacle import Obstacle
from stepover.model.parameters.optimal import Optimal
from stepover.model.robot import Robot
from stepover.planning.optimal.base import Base, base_motion
from stepover.planning.optimal.channels import Channels
from stepover.planning.optimal.problem import Evaluation, every_sample, problem_of
from stepover.planning.optimal.sqp import minimise
from stepover.planning.optimal.variables import Variables, variables_of

NEAR = 2e-2
"""Largest scaled violation of an obstacle on the way to the one that is asked for."""
BETWEEN = 1e-2
"""Largest scaled violation between the samples that are looked at: well within the reserves."""
DIRECT = 6
"""Largest number of links in a chain whose last one is tried at once: 50 cm by 5 cm, 25 by 40."""
BISECTIONS = 1
"""How often the step from the last obstacle that can be crossed to the first that cannot is halved."""
LOWEST = 0.05
"""Height down to which halves are tried where not even the first obstacle of a chain can be crossed [m]."""
FEWER, AGAIN = 12, 0.04
"""Largest number of iterations, and first size of the trust region, after samples were added."""


class Attempt(NamedTuple):
    """One problem that was solved, or not.

    Attributes:
        height, width: of the obstacle [m].
        duration: of the single supports over it [s].
        start: what it started from: "base motion", or "last solution".
        samples: at how many samples constraints were kept.
        iterations: of the SQP.
        violation: largest scaled violation at the end.
        constraint: where it is.
    """

    height: float
    width: float
    duration: float
    start: str
    samples: int
    iterations: int
    violation: float
    constraint: str


@dataclass(frozen=True)
class Progress:
    """What a progress bar shows: obstacle and single supports at hand, iterations so far, and the worst constraint."""

    height: float
    width: float
    duration: float
    iterations: int
    violation: float
    constraint: str


Report = Callable[[Progress], None]


@dataclass(eq=False)
class Search:
    """A search for one crossing, and its record.

    Attributes:
        channels: from channels to postures.
        base: base motion.
        variables: their basis.
        parameters: reserves and weights.
        attempts: what was tried.
        chain: solutions along the chain of obstacles, as far as it led.
        report: told of every iteration.
    """

    channels: Channels
    base: Base
    variables: Variables
    parameters: Optimal
    attempts: list[Attempt] = dataclasses.field(default_factory=list)
    chain: list[Evaluation] = dataclasses.field(default_factory=list)
    report: Report | None = None

    @staticmethod
    def of(
        robot: Robot,
        obstacle: Obstacle,
        leading: int,
        report: Report | None = None,
        record: list[Attempt] | None = None,
    ) -> Search:
        """Lay out base motion and variables. Attempts are added to a record, if there is one."""
        p = robot.optimal
        base = base_motion(robot, obstacle, p, leading)
        channels = Channels(robot, np.radians(p.knee_deg))
        variables = variables_of(base, p, obstacle.distance is None)
        return Search(channels, base, variables, p, [] if record is None else record, report=report)

    @property
    def duration(self) -> float:
        """Of the single supports over the obstacle [s]."""
        return self.channels.robot.walk.single_support_over

    @property
    def iterations(self) -> int:
        """All iterations so far."""
        return sum(attempt.iterations for attempt in self.attempts)

    def run(self, obstacle: Obstacle) -> Evaluation:
        """Search. The result may violate constraints; its worst one says so."""
        stages = chain(obstacle, self.parameters)
        if 1 < len(stages) <= DIRECT:
            found = self._solve(obstacle, np.zeros(self.variables.count), "base motion")
            if found.worst.value <= NEAR:
                return self._at_every_sample(found)
        for number, stage in enumerate(stages):
            x = self.chain[-1].x if number else np.zeros(self.variables.count)
            found = self._solve(stage, x, "last solution" if number else "base motion")
            if found.worst.value > NEAR:
                return found
            self.chain.append(found)
        return self._at_every_sample(found)

    def nearest(self, obstacle: Obstacle) -> Evaluation | None:
        """The solution for an obstacle on the chain to one that cannot be crossed, as near as some bisections come."""
        stages = chain(obstacle, self.parameters)
        kept = [found for found in self.chain if found.problem.scene.obstacle != obstacle]
        high = stages[len(kept)] if len(kept) < len(stages) else obstacle
        while not kept and high.height > LOWEST:
            low = dataclasses.replace(high, height=float(np.floor(500.0 * high.height) / 1e3))
            found = self._solve(low, np.zeros(self.variables.count), "base motion")
            kept, high = ([found], high) if found.worst.value <= NEAR else ([], low)
        if not kept:
            return None
        best = kept[-1]
        for _ in range(BISECTIONS):
            found = self._solve(_between(best.problem.scene.obstacle, high), best.x, "last solution")
            if found.worst.value <= NEAR:
                best = found
            else:
                high = found.problem.scene.obstacle
        found = self._at_every_sample(best)
        return found if found.worst.value <= self.parameters.tolerance else None

    def _at_every_sample(self, found: Evaluation) -> Evaluation:
        """Add samples that break a constraint, until none does."""
        more: set[int] = set()
        obstacle = found.problem.scene.obstacle
        for _ in range(self.parameters.rounds):
            whole = every_sample(found.problem).at(found.x)
            broken = whole.broken(BETWEEN)
            if not len(broken) and found.worst.value <= self.parameters.tolerance:
                return found
            more |= set(whole.broken(0.0).tolist())
            found = self._solve(obstacle, found.x, "last solution", more, FEWER)
        return found

    def _solve(
        self, obstacle: Obstacle, x: np.ndarray, start: str, more: set[int] | None = None, most: int | None = None
    ) -> Evaluation:
        """Solve one problem, and keep a record of it."""
        problem = problem_of(self.channels, self.base, self.variables, obstacle, self.parameters, more or ())
        before, count = self.iterations, 0

        def look(here: Evaluation) -> None:
            nonlocal count
            count += 1
            if self.report is not None:
                worst = here.worst
                sizes = obstacle.height, obstacle.width, self.duration
                self.report(Progress(*sizes, before + count, worst.value, worst.group.name))

        tolerance = self.parameters.tolerance if more is not None else NEAR
        trust = self.parameters.trust if more is None else AGAIN
        found, iterations = minimise(problem, x, tolerance, most or self.parameters.iterations, trust, look)
        worst, samples = found.worst, len(problem.scene.samples)
        named = f"{worst.group.name}: {worst.group.parts[worst.column]}"
        sizes = obstacle.height, obstacle.width, self.duration
        self.attempts.append(Attempt(*sizes, start, samples, iterations, worst.value, named))
        return found


def _between(low: Obstacle, high: Obstacle) -> Obstacle:
    """The obstacle half way, in whole millimetres."""
    sizes = {name: (getattr(low, name) + getattr(high, name)) / 2.0 for name in ("height", "width")}
    return dataclasses.replace(high, **{name: float(np.floor(1e3 * size) / 1e3) for name, size in sizes.items()})


def chain(obstacle: Obstacle, p: Optimal) -> list[Obstacle]:
    """Obstacles that lead to one: both sizes grow together, by no more than the steps of the parameters."""
    low, narrow = min(p.chain_height, obstacle.height), min(p.chain_width, obstacle.width)
    links = max((obstacle.height - low) / p.height_step, (obstacle.width - narrow) / p.width_step)
    shares = np.linspace(0.0, 1.0, int(np.ceil(links - 1e-9)) + 1) if links > 1e-9 else [1.0]
    return [
        dataclasses.replace(
            obstacle,
            height=float(low + share * (obstacle.height - low)),
            width=float(narrow + share * (obstacle.width - narrow)),
        )
        for share in shares
    ]
