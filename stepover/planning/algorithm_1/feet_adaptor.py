"""FTA, the feet trajectory adaptor: what the key configuration alone does not guarantee. Sec. III-E.

A collision-free double support does not make a collision-free crossing: with high obstacles the trailing leg
meets the safety boundary in phase 3. Three methods, in the paper's order: (1) the swing foot's horizontal
trajectory moves back until nothing collides; (2) the waist rises, then the foot is adapted again; (3) a controller
on the penetration distance, Eqs. (23)-(25), pushes the ankle where a small rest remains. All of them are zero, with
zero speed, at lift-off and landing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from stepover.errors import Infeasible, NoWay
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.planning.algorithm_1.adaptor_ways import best_way, displaced, limits, raise_waist, shift_back, waist_bump
from stepover.planning.algorithm_1.feet_trajectories import FeetTrajectories
from stepover.planning.algorithm_1.penetration import ankle_displacements
from stepover.planning.algorithm_1.step_sequence import LEG_2, StepSequence
from stepover.planning.leg_check import check_legs, leg_is_free, leg_shapes


@dataclass(frozen=True, eq=False)
class Adaptation:
    """What FTA did to the trailing leg.

    Attributes:
        feet: adapted trajectories.
        waist_raise: (N,) [m].
        shift: method (1), how far the foot went back [m].
        raised: method (2), how far the waist rose [m].
        pushed: method (3), largest displacement of the ankle [m].
        start, end: first and last time at which anything differs [s], NaN if nothing does.
        clear: whether the legs are free, within reach and limits along phase 3.
        inside: how deep methods (1) and (2) leave the trailing leg inside [m], by few samples at least that, where it
            is more than method (3) is for; infinity where no way is within reach and limits; else 0.
    """

    feet: FeetTrajectories
    waist_raise: np.ndarray
    shift: float
    raised: float
    pushed: float
    start: float
    end: float
    clear: bool
    inside: float = 0.0

    @property
    def acted(self) -> bool:
        """Whether anything was adapted."""
        return max(self.shift, self.raised, self.pushed) > 0.0

    def still_clear(self, robot: Robot, obstacle: Obstacle, sequence: StepSequence, waist: np.ndarray) -> bool:
        """Whether the adapted feet are free under another waist (N, 7), raised already: then FTA has nothing left."""
        return _clear(robot, obstacle, sequence, waist, self.feet)

    def refusal(self, robot: Robot, obstacle: Obstacle, sequence: StepSequence, waist: np.ndarray) -> Infeasible:
        """What to raise where it is not clear, for the waist (N, 7) given; NoWay where too much is left for (3)."""
        if self.inside > 0.0:
            return NoWay(self.inside, lambda: self.explain(robot, obstacle, sequence, waist))
        return self.explain(robot, obstacle, sequence, waist)

    def explain(self, robot: Robot, obstacle: Obstacle, sequence: StepSequence, waist: np.ndarray) -> Infeasible:
        """What remains where it is not clear: the link, the depth and when."""
        step, lifted = sequence.step(LEG_2), raise_waist(robot, sequence, waist, self.raised)
        swing = slice(step.lift_off, step.touch_down + 1)
        soles = self.feet.left[swing], self.feet.right[swing]
        check = check_legs(robot, lifted[swing], *soles, *limits(robot, obstacle, sequence), up_to=0.0)
        worst = int(np.argmin(check.separation))
        if check.separation[worst] >= 0.0:
            worst = int(np.argmin(np.where(check.reach > 0.0, -1e3 * check.reach, check.limit)))
            over, past, short = 1e3 * check.reach[worst], -np.degrees(check.limit[worst]), np.inf
            folded = f"a leg's joint is {past:.1f} degrees past its limit"
            what = f"a sole is {over:.1f} mm out of reach" if over > 0.0 else folded
        else:
            link, short = leg_shapes(robot)[check.shape[worst]].link, float(-check.separation[worst])
            what = f"{link} stays {1e3 * short:.1f} mm inside the obstacle's safety margin"
        when = f"t = {sequence.time[step.lift_off + worst]:.3f} s (phase 3)"
        return Infeasible(f"FTA finds no way: {what} at {when}", short=short)


METHODS = (1, 2, 3)
"""The methods of Sec. III-E, for those who want to switch some off."""
SETTLED = 1e-4
"""Method (3) ends where a round would move the ankle by less [m]: next to nothing of what is to spare."""


def adapt_feet(
    robot: Robot,
    obstacle: Obstacle,
    sequence: StepSequence,
    waist: np.ndarray,
    feet: FeetTrajectories,
    methods: tuple[int, ...] = METHODS,
) -> Adaptation:
    """Adapt the trailing leg until it is free: step 7 of Algorithm 1.

    Args:
        robot: the robot.
        obstacle: the obstacle with its margins.
        sequence: the steps.
        waist: (N, 7) waist after the dynamic filter.
        feet: trajectories of FTG.
        methods: which of the three may be used.
    """
    adaptor, step = robot.adaptor, sequence.step(LEG_2)
    if _clear(robot, obstacle, sequence, waist, feet):
        return Adaptation(feet, np.zeros(len(waist)), 0.0, 0.0, 0.0, np.nan, np.nan, clear=True)
    shifts = np.arange(0.0, adaptor.shift_max + 1e-9, adaptor.shift_step) if 1 in methods else np.zeros(1)
    raises = np.arange(0.0, adaptor.raise_max + 1e-9, adaptor.raise_step) if 2 in methods else np.zeros(1)
    hopeless = -adaptor.push_max if 3 in methods else -np.inf
    free_by, shift, height = best_way(robot, obstacle, sequence, waist, feet, raises, shifts, hopeless)
    lifted = raise_waist(robot, sequence, waist, height)
    shifted = shift_back(robot, feet, step, shift) if shift > 0.0 else feet
    push = 3 in methods and hopeless < free_by < adaptor.spare
    adapted = push_ankle(robot, obstacle, sequence, lifted, shifted) if push else shifted
    pushed = np.linalg.norm(adapted.foot(step.side)[:, :3] - shifted.foot(step.side)[:, :3], axis=1).max()
    bump = waist_bump(robot, sequence, height)
    changed = np.abs(adapted.foot(step.side) - feet.foot(step.side)).max(axis=1) + bump > 1e-9
    when = sequence.time[changed]
    span = (float(when[0]), float(when[-1])) if changed.any() else (np.nan, np.nan)
    inside = -free_by if free_by <= hopeless else 0.0
    clear = inside == 0.0 and _clear(robot, obstacle, sequence, lifted, adapted)
    return Adaptation(adapted, bump, shift, height, float(pushed), *span, clear, inside)


def push_ankle(
    robot: Robot, obstacle: Obstacle, sequence: StepSequence, waist: np.ndarray, feet: FeetTrajectories
) -> FeetTrajectories:
    """Method (3): the controller on the penetration distance, Eqs. (23)-(25), until hardly anything penetrates.

    Each round computes the ankle's displacement at every colliding sample, spreads the largest smoothly over the
    neighbouring ones, and moves the foot with it, its orientation kept.
    """
    step, adaptor = sequence.step(LEG_2), robot.adaptor
    swing = slice(step.lift_off, step.touch_down + 1)
    share = np.linspace(0.0, 1.0, step.touch_down - step.lift_off + 1)
    window = np.minimum(1.0, np.minimum(share, 1.0 - share) / adaptor.push_taper)
    window = window**2 * (3.0 - 2.0 * window)
    width = adaptor.push_width * len(share)
    start = feet
    for _ in range(adaptor.push_rounds):
        rectangle = obstacle.profile(sequence.front_face, margins=True)
        push = ankle_displacements(robot, step.side, waist[swing], feet.foot(step.side)[swing], rectangle, adaptor)
        if np.abs(push).max() < SETTLED:
            break
        ahead, back = (maximum_filter1d(np.maximum(way, 0.0), int(width) | 1, axis=0) for way in (push, -push))
        spread = gaussian_filter1d(ahead - back, width / 3.0, axis=0)
        further = displaced(feet, step, spread * window[:, None])
        if np.abs(further.foot(step.side)[:, :3] - start.foot(step.side)[:, :3]).max() > adaptor.push_total:
            break
        feet = further
    return feet


def _clear(robot: Robot, obstacle: Obstacle, sequence: StepSequence, waist: np.ndarray, feet: FeetTrajectories) -> bool:
    """Whether both legs are free along phase 3, within reach and limits; first the trailing, likelier to fail."""
    step, asked = sequence.step(LEG_2), limits(robot, obstacle, sequence)
    swing = slice(step.lift_off, step.touch_down + 1)
    return all(
        leg_is_free(robot, side, waist[swing], feet.foot(side)[swing], *asked).all() for side in (step.side, -step.side)
    )
