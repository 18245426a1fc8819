"""The optimal control problem of one obstacle: its constraint groups and its cost, with their derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from stepover.model.obstacle import Obstacle
from stepover.model.parameters.optimal import Optimal
from stepover.planning.optimal.base import Base
from stepover.planning.optimal.channels import Channels
from stepover.planning.optimal.constraints.contact import friction, yaw_moment, zmp
from stepover.planning.optimal.constraints.floor import landing_speed, sole_heights
from stepover.planning.optimal.constraints.group import Group, Local
from stepover.planning.optimal.constraints.joints import joint_limits, joint_speeds
from stepover.planning.optimal.constraints.obstacle import clearance
from stepover.planning.optimal.constraints.own_links import own_distance
from stepover.planning.optimal.constraints.reach import reach
from stepover.planning.optimal.constraints.torque import torque
from stepover.planning.optimal.constraints.waist import lean
from stepover.planning.optimal.cost import Quadratic, centring, centring_by, quadratic
from stepover.planning.optimal.instants import Instants
from stepover.planning.optimal.scene import Scene
from stepover.planning.optimal.variables import Variables

GroupOf = Callable[[Instants], Group]
"""From what is seen to the values and gradients of one kind of constraint."""
GROUPS: tuple[GroupOf, ...] = (
    joint_limits, joint_speeds, reach, lean, zmp, friction, yaw_moment, torque, clearance, sole_heights, landing_speed,
    own_distance,
)  # fmt: skip
"""All constraint groups. Another one is a function in constraints/ and its name here."""
ALMOST = 0.4
"""Rows whose scaled value is below its negative are left out of an iteration."""
AT_ENDS = 0.1
"""How far from both ends of the crossing the deviations hardly count yet [s]."""
AROUND = 0.06
"""How far constraints are kept before and after the part that can change [s]."""


class Violation(NamedTuple):
    """The largest scaled violation, and the group, row and column where it is."""

    value: float
    group: Group
    row: int
    column: int


class Linear(NamedTuple):
    """Constraints and cost around one value of the variables.

    Attributes:
        values, jacobian: (m,) and (m, n) of the constraints that may matter.
        residuals, slopes: (r,) and (r, n) of the cost's residuals.
    """

    values: np.ndarray
    jacobian: sp.csr_matrix
    residuals: np.ndarray
    slopes: sp.csr_matrix


@dataclass(frozen=True, eq=False)
class Problem:
    """One obstacle, with the samples at which its constraints are kept.

    Attributes:
        scene: robot, base motion, obstacle, samples.
        variables: their basis.
        groups: constraint groups.
    """

    scene: Scene
    variables: Variables
    groups: Sequence[GroupOf] = GROUPS

    @cached_property
    def every(self) -> int:
        """Samples from one regular sample to the next."""
        return max(round(self.scene.parameters.look_every / self.scene.dt), 1)

    @cached_property
    def _basis(self) -> sp.csr_matrix:
        """Rows of the basis one sample before, at, and after: (3 n C, variables)."""
        samples = self.scene.samples
        around = np.concatenate([samples - 1, samples, samples + 1])
        return self.variables.rows(around, self.scene.channels.count)

    @cached_property
    def _base_steps(self) -> np.ndarray:
        """Channels (3, n, C) of the base motion."""
        samples = self.scene.samples
        return self.scene.base.channels[np.array([samples - 1, samples, samples + 1])]

    @cached_property
    def _quadratic(self) -> Quadratic:
        """The cost's linear residuals."""
        return quadratic(self.scene, self.variables, self.every)

    @cached_property
    def given(self) -> list[np.ndarray]:
        """What the base walk itself exceeds at both ends (n, m), where nothing can change it: for each group."""
        scene, around = self.scene, round(AT_ENDS / self.scene.dt)
        first, last = scene.base.crossing[0].lift_off + around, scene.base.crossing[-1].touch_down - around
        ends = (scene.samples <= first) | (scene.samples >= last)
        seen = self._seen(np.zeros(self.variables.count))
        return [np.where(ends[:, None], np.maximum(group(seen).values, 0.0), 0.0) for group in self.groups]

    def at(self, x: np.ndarray) -> Evaluation:
        """Everything for one value of the variables (n,)."""
        return Evaluation(self, x, self._seen(x))

    def _seen(self, x: np.ndarray) -> Instants:
        """The motion at the samples."""
        moved = self._base_steps + (self._basis @ x).reshape(self._base_steps.shape)
        place = 0.0 if self.variables.place is None else float(x[self.variables.place])
        return Instants(self.scene, moved, self.scene.base.sequence.front_face + place)

    def rows(self, local: Local, rows: np.ndarray, seen: Instants) -> sp.csr_matrix:
        """Derivatives (R, n) by the variables from those by what is seen at samples rows (R,)."""
        count, dt = self.scene.channels.count, self.scene.dt
        by = np.zeros((3, len(rows), count))
        if local.motion is not None:
            position, speed, quickening = np.split(local.motion, 3, axis=1)
            speed, quickening = speed / (2.0 * dt), quickening / dt**2
            steps = (quickening - speed, position - 2.0 * quickening, quickening + speed)
            for k, step in enumerate(steps):
                if np.any(step):
                    by[k] = (step[:, None] @ seen.by_channels[0][k][rows])[:, 0]
        if local.channels is not None:
            by[1] += local.channels
        if local.channel_speeds is not None:
            by[0] -= local.channel_speeds / (2.0 * dt)
            by[2] += local.channel_speeds / (2.0 * dt)
        starts = (np.arange(3) * len(self.scene.samples) + rows[:, None]) * count
        columns = (starts[..., None] + np.arange(count)).ravel()
        ends = np.arange(0, len(columns) + 1, 3 * count)
        dense = by.transpose(1, 0, 2).ravel()
        found = sp.csr_matrix((dense, columns, ends), (len(rows), self._basis.shape[0])) @ self._basis
        if local.front is not None and self.variables.place is not None:
            place = np.full(len(rows), self.variables.place)
            found = found + sp.csr_matrix((local.front, (np.arange(len(rows)), place)), found.shape)
        return found.tocsr()


@dataclass(frozen=True, eq=False)
class Evaluation:
    """A problem at one value of the variables.

    Attributes:
        problem: the problem.
        x: (n,) variables.
        seen: the motion at the samples.
    """

    problem: Problem
    x: np.ndarray
    seen: Instants

    @cached_property
    def groups(self) -> list[Group]:
        """All constraint groups."""
        found = [group(self.seen) for group in self.problem.groups]
        pairs = zip(found, self.problem.given, strict=True)
        return [replace(group, values=group.values - given) for group, given in pairs]

    @cached_property
    def residuals(self) -> np.ndarray:
        """(r,) of the cost."""
        fixed, free = self.problem._quadratic, centring(self.seen, self.problem.every)
        return np.concatenate([fixed.matrix @ self.x + fixed.offset, free.residuals.ravel()])

    @property
    def cost(self) -> float:
        """Half the sum of squares."""
        return float(0.5 * self.residuals @ self.residuals)

    @cached_property
    def violation(self) -> float:
        """Sum of all scaled violations."""
        return float(sum(np.maximum(group.values, 0.0).sum() for group in self.groups))

    @cached_property
    def worst(self) -> Violation:
        """The largest scaled violation."""
        worst = max(self.groups, key=lambda group: group.values.max())
        row, column = np.unravel_index(worst.values.argmax(), worst.values.shape)
        return Violation(float(worst.values[row, column]), worst, int(row), int(column))

    def broken(self, tolerance: float) -> np.ndarray:
        """Samples at which a group is violated by more than a tolerance."""
        most = np.max([group.values.max(axis=1) for group in self.groups], axis=0)
        return self.problem.scene.samples[most > tolerance]

    def linear(self) -> Linear:
        """Linearised constraints and residuals."""
        problem, values, jacobians = self.problem, [], []
        for group in self.groups:
            rows, columns = np.nonzero(group.values > -ALMOST)
            if len(rows):
                values.append(group.values[rows, columns])
                jacobians.append(problem.rows(group.gradient(rows, columns), rows, self.seen))
        free = centring(self.seen, problem.every)
        by = centring_by(self.seen, free)
        slopes = problem.rows(Local(motion=by.reshape(-1, by.shape[2])), np.repeat(free.rows, 3), self.seen)
        residual_slopes = sp.vstack([problem._quadratic.matrix, slopes]).tocsr()
        return Linear(np.concatenate(values), sp.vstack(jacobians).tocsr(), self.residuals, residual_slopes)


def problem_of(
    channels: Channels, base: Base, variables: Variables, obstacle: Obstacle, p: Optimal, more: Iterable[int] = ()
) -> Problem:
    """The problem of an obstacle, with more samples where they are wanted."""
    samples = np.array(sorted({*looked_at(channels, base, variables, p).tolist(), *more}))
    return Problem(Scene(channels, base, obstacle, p, samples), variables)


def every_sample(problem: Problem) -> Problem:
    """The same problem with its constraints at every sample; all but the distances between the robot's own links."""
    scene, groups = problem.scene, [group for group in problem.groups if group is not own_distance]
    samples = np.arange(scene.samples[0], scene.samples[-1] + 1)
    return Problem(
        Scene(scene.channels, scene.base, scene.obstacle, scene.parameters, samples), problem.variables, groups
    )


def looked_at(channels: Channels, base: Base, variables: Variables, p: Optimal) -> np.ndarray:
    """Samples at which constraints are kept: regular ones, and all near lift-off and touch-down."""
    dt = channels.robot.walk.sample_time
    change = np.flatnonzero(np.diff(variables.basis.indptr) > 0)[[0, -1]] // channels.count
    around = round(AROUND / dt)
    first, last = max(change[0] - around, 1), min(change[1] + around, len(base.time) - 2)
    chosen = np.zeros(len(base.time), dtype=bool)
    chosen[first : last + 1 : max(round(p.look_every / dt), 1)] = True
    near = round(p.look_near / dt)
    for event in {k for step in base.sequence.steps for k in (step.lift_off, step.touch_down)}:
        if first <= event <= last:
            chosen[max(event - near, first) : min(event + near, last) + 1] = True
    chosen[last] = True
    return np.flatnonzero(chosen)
