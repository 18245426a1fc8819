"""UBMG, the upper body motion generator. Sec. III-C3 and III-D.

The chest turns against the waist, so that the upper body keeps looking ahead while the hips clear the way. Where
the leading knee would over-stretch before landing, the arms swing back: the CoM would follow, so the dynamic
filter moves the waist ahead. While the arms accelerate back, the multi-body ZMP runs ahead (p_ref2 < 0); once
they are back, it lies behind (p_ref2 > 0); both move the waist ahead.

The filter may not see a posture that over-reaches. So what it will answer to the arms is computed in half-sitting:
the ZMP of the standing robot that swings its arms needs no reach, and the rest of the motion adds nothing to it, as
the chest looks ahead throughout.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.com_waist import ComWaist
from stepover.planning.algorithm_1.preview_control import kajita_gains, track
from stepover.planning.algorithm_1.step_sequence import StepSequence
from stepover.planning.trajectories import FeetTrajectories


@dataclass(frozen=True, eq=False)
class UpperBody:
    """What UBMG decided.

    Attributes:
        q: (N, nq) configurations with the upper body set and the rest in half-sitting.
        waist_shift: (N, 2) what the filter will answer to the arms [m].
        zmp_change: (N, 2) what the arms do to the multi-body ZMP, -p_ref2 [m].
        arm_swing: how far the arms go back [rad], 0 if UBMG idles.
        knee_before, knee_after: smallest spare angle of the lead knee in phase 1 without and with the arms [rad],
            counted from the margin that is asked for; -inf where the sole is out of reach.
    """

    q: np.ndarray
    waist_shift: np.ndarray
    zmp_change: np.ndarray
    arm_swing: float
    knee_before: float
    knee_after: float


def upper_body(robot: Robot, sequence: StepSequence, feet: FeetTrajectories, first: ComWaist, arms: str) -> UpperBody:
    """Upper body trajectories: step 5 of Algorithm 1.

    Args:
        robot: the robot.
        sequence: the steps.
        feet: trajectories of the feet.
        first: CoM and waist of CWTG1.
        arms: "auto" swings them back as far as the lead knee needs, "on" as far as robot.toml allows, "off" not.
    """
    none = np.zeros_like(sequence.zmp)
    before = float(_knee_spare(robot, sequence, feet, first.waist, none[None])[0])
    if arms == "off" or (arms == "auto" and before >= 0.0):
        return UpperBody(with_arms(robot, sequence, first.yaw, 0.0), none, none, 0.0, before, before)
    change, answer = arm_response(robot, _swing_times(robot, sequence), len(sequence.time))
    count = robot.upper_body.arm_swing_sizes
    shares = np.arange(1, count + 1) / count if arms == "auto" else np.ones(1)  # nearly linear in the angle
    spare = _knee_spare(robot, sequence, feet, first.waist, shares[:, None, None] * answer)
    enough = int(np.argmax(spare >= 0.0)) if (spare >= 0.0).any() else -1
    share, after = shares[enough], float(spare[enough])
    swing = float(share * np.radians(robot.upper_body.arm_swing_max_deg))
    q = with_arms(robot, sequence, first.yaw, swing)
    return UpperBody(q, share * answer, share * change, swing, before, after)


def with_arms(robot: Robot, sequence: StepSequence, waist_yaw: np.ndarray, swing: float) -> np.ndarray:
    """Configurations (N, nq): chest against the waist's yaw (N,), arms back by swing [rad] over the obstacle."""
    q = np.tile(robot.half_sitting(), (len(waist_yaw), 1))
    q[:, robot.body.column(robot.upper_body.chest_yaw)] = -waist_yaw
    back = _profile(_swing_times(robot, sequence), sequence.time) * swing
    for joint in robot.upper_body.shoulders:
        q[:, robot.body.column(joint)] += back
    return q


def moved(waist: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Waist poses (N, 7) moved horizontally by shift (N, 2)."""
    result = waist.copy()
    result[:, :2] += shift
    return result


@lru_cache(maxsize=16)
def arm_response(robot: Robot, times: tuple[float, ...], count: int) -> tuple[np.ndarray, np.ndarray]:
    """What the largest arm swing does to the ZMP of the standing robot, and what the filter answers.

    Args:
        robot: the robot.
        times: start back, back, start forth, forth [s].
        count: number of samples.

    Returns:
        Change of the multi-body ZMP (count, 2) and the waist's answer (count, 2) [m].
    """
    dt = robot.walk.sample_time
    q = np.tile(robot.half_sitting(), (count, 1))
    swing = np.radians(robot.upper_body.arm_swing_max_deg) * _profile(times, np.arange(count) * dt)
    for joint in robot.upper_body.shoulders:
        q[:, robot.body.column(joint)] += swing
    change = robot.body.zmp(q, dt) - robot.rest_zmp()
    return change, track(kajita_gains(robot.preview, dt), -change, robot.preview, dt).position


def _swing_times(robot: Robot, sequence: StepSequence) -> tuple[float, ...]:
    """When the arms start back, are back, start forth and hang again [s]: before leg 1 lands, while leg 2 steps."""
    parts = robot.upper_body
    one, two = (sequence.time[[step.lift_off, step.touch_down]] for step in map(sequence.step, (LEG_1, LEG_2)))
    back = (one[0] + parts.arms_start * (one[1] - one[0]), one[0] + parts.arms_back * (one[1] - one[0]))
    forth = (two[0], two[0] + parts.arms_forth * (two[1] - two[0]))
    return tuple(float(time) for time in (*back, *forth))


def _profile(times: tuple[float, ...], at: np.ndarray) -> np.ndarray:
    """Share (N,) of the arm swing at times (N,) [s]: cubics back and forth."""
    return np.asarray(CubicHermiteSpline(times, [0.0, 1.0, 1.0, 0.0], np.zeros(4))(np.clip(at, times[0], times[-1])))


def _knee_spare(
    robot: Robot, sequence: StepSequence, feet: FeetTrajectories, waist: np.ndarray, shifts: np.ndarray
) -> np.ndarray:
    """Smallest spare angle (S,) [rad] of the lead knee in phase 1 to its margin; -inf where the sole is out of reach.

    For the waist (N, 7) moved by each of some shifts (S, N, 2).
    """
    step = sequence.step(LEG_1)
    over, leg = slice(step.lift_off, step.touch_down), robot.leg(step.side)
    waists = np.concatenate([moved(waist[over], shift[over]) for shift in shifts])
    knee, excess = leg.knee(waists, np.tile(feet.foot(step.side)[over], (len(shifts), 1)))
    margin = np.radians(robot.checks.knee_margin_deg + robot.upper_body.knee_spare_deg)
    spare = np.where(excess > 0.0, -np.inf, np.abs(knee) - margin)
    return np.asarray(spare.reshape(len(shifts), -1).min(axis=1))
