"""Numbers for the assumptions of Sec. II-B about robot and motion: masses, heights, momenta, speeds, durations."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby

import numpy as np

from stepover.analysis.planar.biped import planar_biped
from stepover.model.gravity import GRAVITY
from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, NORMAL
from stepover.motion.motion import Motion


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


def upper_body_share(robot: Robot, lighter: float = 0.0) -> float:
    """Share of the mass that is above the hip joints, the waist included, with the waist lighter by a mass [kg]."""
    legs = sum(robot.body.mass_beyond(leg[0]) for leg in (robot.legs.left, robot.legs.right))
    return 1.0 - legs / (robot.body.mass - lighter)


def waist_above_com(motion: Motion) -> np.ndarray:
    """Height of the waist above the CoM (N,) [m]. Remark 4 assumes that it is constant."""
    return np.asarray(motion.waist[:, 2] - motion.com[:, 2])


def waist_rise_over_com(motion: Motion) -> float:
    """Mean of that height in the double support over the obstacle, minus the one at rest [m]."""
    apart = waist_above_com(motion)
    return float(apart[motion.samples(2)].mean() - apart[0])


def vertical_acceleration(height: np.ndarray, dt: float) -> float:
    """Largest vertical acceleration of a height (N,) over g."""
    return float(np.abs(np.diff(height, 2)).max() / dt**2 / GRAVITY)


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


def forward_speed(motion: Motion) -> tuple[float, float, float]:
    """Least and mean forward speed of the CoM from the step before the obstacle to the end of phase 3 [m/s], and when.

    The step before ends as leg 1 lifts off; it begins one double support after the landing before it.
    """
    before = int(np.flatnonzero(motion.footsteps.kind == LEG_1)[0]) - 1
    landed = motion.footsteps.time[before - 1] if before > 0 else motion.time[np.flatnonzero(motion.support)[0]]
    crossing = slice(int(np.searchsorted(motion.time, landed)), motion.samples(3).stop + 1)
    speed = np.gradient(motion.com[:, 0], motion.dt)[crossing]
    return float(speed.min()), float(speed.mean()), float(motion.time[crossing][speed.argmin()])


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
