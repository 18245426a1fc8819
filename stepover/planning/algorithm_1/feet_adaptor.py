"""FTA, the feet trajectory adaptor: what the key configuration alone does not guarantee. Sec. III-E.

A collision-free double support does not make a collision-free crossing: with high obstacles the trailing leg
meets the safety boundary in phase 3. Three methods, in the paper's order: (1) the swing foot's horizontal
trajectory moves back until nothing collides; (2) the waist rises, then the foot is adapted again; (3) a controller
on the penetration distance, Eqs. (23)-(25), pushes the ankle where a small rest remains. All of them are zero, with
zero speed, at lift-off and landing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from stepover.errors import Infeasible, TrailingLegBlocked
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_2
from stepover.planning.algorithm_1.penetration import ankle_displacements
from stepover.planning.algorithm_1.shift_and_raise import best_candidate, displaced, raise_waist, shift_back, waist_bump
from stepover.planning.algorithm_1.step_sequence import Crossing
from stepover.planning.leg_check import LegLimits, check_legs, leg_is_free
from stepover.planning.trajectories import FeetTrajectories, WaistAndFeet


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
        inside: penetration left after methods (1) and (2) [m], where it exceeds what method (3) can correct; a lower
            bound from coarse sampling. Infinity where no candidate is within reach and limits; else 0.
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

    def still_clear(self, crossing: Crossing, waist: np.ndarray) -> bool:
        """Whether the adapted feet are free under another waist (N, 7), raised already: then FTA has nothing left."""
        return _clear(crossing, WaistAndFeet(waist, self.feet))

    def refusal(self, crossing: Crossing, waist: np.ndarray) -> Infeasible:
        """What to raise where it is not clear, for the waist that was given to adapt_feet (N, 7)."""
        robot, sequence = crossing.robot, crossing.sequence
        step, lifted = sequence.step(LEG_2), raise_waist(robot, sequence, waist, self.raised)
        over = np.arange(step.lift_off, step.touch_down + 1)  # indices copy: the rest of the motion is not kept
        poses = WaistAndFeet(lifted, self.feet).at(over)
        explain = partial(_what_remains, robot, poses, crossing.limits, sequence.time[over])
        return TrailingLegBlocked(self.inside, explain) if self.inside > 0.0 else explain()


def _what_remains(robot: Robot, poses: WaistAndFeet, limits: LegLimits, time: np.ndarray) -> Infeasible:
    """Why the legs are not clear in phase 3, at its times (N,) [s]: the link, the depth and when."""
    check = check_legs(robot, poses, limits, up_to=0.0)
    worst = int(np.argmin(check.separation))
    if check.separation[worst] >= 0.0:
        worst = int(np.argmin(np.where(check.reach > 0.0, -1e3 * check.reach, check.limit)))
        over, past, short = 1e3 * check.reach[worst], -np.degrees(check.limit[worst]), np.inf
        folded = f"a leg's joint is {past:.1f} degrees past its limit"
        what = f"a sole is {over:.1f} mm out of reach" if over > 0.0 else folded
    else:
        link, short = robot.shapes[check.shape[worst]].link, float(-check.separation[worst])
        what = f"{link} stays {1e3 * short:.1f} mm inside the obstacle's safety margin"
    return Infeasible(f"FTA cannot free the trailing leg: {what} at t = {time[worst]:.3f} s (phase 3)", short=short)


METHODS = (1, 2, 3)
"""The methods of Sec. III-E, for those who want to switch some off."""
SETTLED = 1e-4
"""Method (3) ends where a round would move the ankle by less [m]: next to nothing of what is to spare."""


def adapt_feet(crossing: Crossing, poses: WaistAndFeet, methods: tuple[int, ...] = METHODS) -> Adaptation:
    """Adapt the trailing leg until it is free: step 7 of Algorithm 1.

    Args:
        crossing: robot, obstacle and steps.
        poses: waist after the dynamic filter, feet of FTG.
        methods: which of the three may be used.
    """
    robot, sequence, adaptor = crossing.robot, crossing.sequence, crossing.robot.adaptor
    waist, feet, step = poses.waist, poses.feet, sequence.step(LEG_2)
    if _clear(crossing, poses):
        return Adaptation(feet, np.zeros(len(waist)), 0.0, 0.0, 0.0, np.nan, np.nan, clear=True)
    shifts = np.arange(0.0, adaptor.shift_max + 1e-9, adaptor.shift_step) if 1 in methods else np.zeros(1)
    raises = np.arange(0.0, adaptor.raise_max + 1e-9, adaptor.raise_step) if 2 in methods else np.zeros(1)
    hopeless = -adaptor.push_max if 3 in methods else -np.inf
    free_by, shift, height = best_candidate(crossing, poses, raises, shifts, hopeless)
    lifted = raise_waist(robot, sequence, waist, height)
    shifted = shift_back(robot, feet, step, shift) if shift > 0.0 else feet
    push = 3 in methods and hopeless < free_by < adaptor.spare
    adapted = push_ankle(crossing, WaistAndFeet(lifted, shifted)) if push else shifted
    pushed = np.linalg.norm(adapted.foot(step.side)[:, :3] - shifted.foot(step.side)[:, :3], axis=1).max()
    bump = waist_bump(robot, sequence, height)
    changed = np.abs(adapted.foot(step.side) - feet.foot(step.side)).max(axis=1) + bump > 1e-9
    when = sequence.time[changed]
    span = (float(when[0]), float(when[-1])) if changed.any() else (np.nan, np.nan)
    inside = -free_by if free_by <= hopeless else 0.0
    clear = inside == 0.0 and _clear(crossing, WaistAndFeet(lifted, adapted))
    return Adaptation(adapted, bump, shift, height, float(pushed), *span, clear, inside)


def push_ankle(crossing: Crossing, poses: WaistAndFeet) -> FeetTrajectories:
    """Method (3): the controller on the penetration distance, Eqs. (23)-(25), until hardly anything penetrates.

    Each round computes the ankle's displacement at every colliding sample, spreads the largest smoothly over the
    neighbouring ones, and moves the foot with it, its orientation kept.
    """
    step, adaptor, feet = crossing.sequence.step(LEG_2), crossing.robot.adaptor, poses.feet
    window = np.minimum(1.0, np.minimum(step.share, 1.0 - step.share) / adaptor.push_taper)
    window = window**2 * (3.0 - 2.0 * window)
    width = adaptor.push_width * len(window)
    waist, rectangle = poses.waist[step.swing], crossing.limits.rectangle
    for _ in range(adaptor.push_rounds):
        push = ankle_displacements(crossing.robot, step.side, waist, feet.foot(step.side)[step.swing], rectangle)
        if np.abs(push).max() < SETTLED:
            break
        ahead, back = (maximum_filter1d(np.maximum(part, 0.0), int(width) | 1, axis=0) for part in (push, -push))
        spread = gaussian_filter1d(ahead - back, width / 3.0, axis=0)
        further = displaced(feet, step, spread * window[:, None])
        total = further.foot(step.side)[:, :3] - poses.feet.foot(step.side)[:, :3]
        if np.abs(total).max() > adaptor.push_total:
            break
        feet = further
    return feet


def _clear(crossing: Crossing, poses: WaistAndFeet) -> bool:
    """Whether both legs are free along phase 3, within reach and limits; first the trailing, likelier to fail."""
    step = crossing.sequence.step(LEG_2)
    over, limits = poses.at(step.swing), crossing.limits
    return all(leg_is_free(crossing.robot, side, over, limits).all() for side in (step.side, -step.side))
