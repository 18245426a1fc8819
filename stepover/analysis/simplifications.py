"""Numbers for the assumptions of Sec. II-B about robot and motion: masses, heights, momenta, speeds, durations."""

from __future__ import annotations

import timeit
from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from stepover.analysis.planar.biped import planar_biped
from stepover.model.gravity import GRAVITY
from stepover.model.obstacle import Obstacle
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, NORMAL
from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.feasibility import key_configurations
from stepover.planning.algorithm_1.feet_trajectories import feet_trajectories
from stepover.planning.algorithm_1.step_sequence import Crossing, step_sequence


@dataclass(frozen=True)
class Momentum:
    """Rates of change of the angular momentum along a motion, about the CoM except for the cart.

    Attributes:
        share: (2,) rms about x and y over the rms of the cart's own, Eq. (21); 0 for a point mass.
        zmp: (2,) the resulting shift of the ZMP in x and y, rms [m].
        yaw: largest rate about z [N m].
        yaw_share: the same over the largest rate of the cart.
    """

    share: np.ndarray
    zmp: np.ndarray
    yaw: float
    yaw_share: float


def leg_length(robot: Robot) -> float:
    """Hip to sole of a stretched leg [m]."""
    biped = planar_biped(robot)
    return biped.thigh + biped.shank + biped.ankle_height


def upper_body_share(robot: Robot) -> float:
    """Share of the mass that is above the hip joints, the waist included."""
    legs = sum(robot.body.mass_beyond(leg[0]) for leg in (robot.legs.left, robot.legs.right))
    return 1.0 - legs / robot.body.mass


def waist_above_com(motion: Motion) -> np.ndarray:
    """Height of the waist above the CoM (N,) [m]. Remark 4 assumes that it is constant."""
    return np.asarray(motion.waist[:, 2] - motion.com[:, 2])


def momentum(robot: Robot, motion: Motion) -> Momentum:
    """Difference between the multi-body robot and the cart of (15) and (21), whose mass is a point above the floor.

    With L̇ about the CoM's projection on the floor, (21) states L̇ = m c_z c̈. The remainder is L̇ about the CoM.
    """
    force, moment = np.split(robot.body.contact_wrench(motion.q, motion.dt), 2, axis=1)
    about_com = moment - np.cross(motion.com, force)
    cart = motion.com[:, 2:] * force[:, 1::-1] * (-1.0, 1.0)
    rms, cart_rms = (np.sqrt((x[:, :2] ** 2).mean(axis=0)) for x in (about_com, cart))
    yaw = float(np.abs(about_com[:, 2]).max())
    weight = robot.body.mass * GRAVITY
    return Momentum(rms / cart_rms, rms[::-1] / weight, yaw, yaw / float(np.abs(cart).max()))


def slowest(motion: Motion) -> tuple[float, float]:
    """Smallest forward speed of the CoM from the first lift-off to the last landing [m/s], and when [s]."""
    walking = np.flatnonzero(motion.support)
    speed = np.gradient(motion.com[:, 0], motion.dt)[walking[0] : walking[-1] + 1]
    return float(speed.min()), float(motion.time[walking[0] + speed.argmin()])


def timing(motion: Motion) -> list[float]:
    """Durations of single and double support of normal steps and over the obstacle [s], and the number of steps.

    "Over the obstacle" means the swing of leg 1 and the double support after it.
    """
    lasting = [(side != 0, sum(1 for _ in run) * motion.dt) for side, run in groupby(motion.support.tolist())]
    singles = [time for alone, time in lasting if alone]
    doubles = [time for alone, time in lasting if not alone][1:-1]
    kinds = motion.footsteps.kind.tolist()
    normal, over = kinds.index(NORMAL), kinds.index(LEG_1)
    return [singles[normal], doubles[normal], singles[over], doubles[over], len(kinds)]


def special_steps(motion: Motion) -> float:
    """From the lift-off of the step before the obstacle to the touch-down of the one after it [s]."""
    starts = motion.time[np.flatnonzero((motion.support[1:] != 0) & (motion.support[:-1] == 0)) + 1]
    special = np.flatnonzero(motion.footsteps.kind != NORMAL)
    return float(motion.footsteps.time[special[-1]] - starts[special[0]])


def planning_times(robot: Robot, obstacle: Obstacle, motion: Motion, whole: float, repeats: int) -> list[float]:
    """Computing time of Algorithm 1 on this machine, from medians.

    Args:
        robot: the robot.
        obstacle: the obstacle.
        motion: the motion over the obstacle.
        whole: computing time of the whole of Algorithm 1 [s].
        repeats: number of repetitions of each measurement.

    Returns:
        Times of steps 1 and 2, and of steps 3 to 7 per sample [s]; the former over the time of the rigid-body dynamics
        of the whole motion, the latter over that of one sample.
    """

    def planning() -> None:
        sequence = step_sequence(robot, obstacle, key_configurations(robot, obstacle)[0], robot.rest_zmp())
        feet_trajectories(Crossing(robot, obstacle, sequence))

    first = _median_time(planning, repeats)
    dynamics = _median_time(lambda: robot.body.contact_wrench(motion.q, motion.dt), repeats)
    return [first, (whole - first) / len(motion.time), first / dynamics, (whole - first) / dynamics]


def _median_time(work: Callable[[], object], repeats: int) -> float:
    """Median duration of a call [s]. A first call is not counted."""
    times = timeit.repeat(work, number=1, repeat=repeats + 1)[1:]
    return float(np.median(times))
