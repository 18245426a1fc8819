"""What is written down while the physics runs, at every sample of the motion; and when a robot counts as fallen."""

from __future__ import annotations

import hashlib
import math

import numpy as np

from stepover.model.parameters.physics import Simulation
from stepover.model.pose import axes
from stepover.simulation.pybullet.world import World
from stepover.simulation.touch import Touch


class Recording:
    """Measured series at the motion's sample times, N long, of which the first `count` are filled.

    Forces and torques are means over the time steps since the sample before; they are zero at the first sample.

    Attributes:
        q: (N, nq) measured configurations.
        dq: (N, nq - 7) joint speeds [rad/s].
        torque: (N, nq - 7) [N m].
        feet: (N, 2, 6) wrenches of the floor on the left and right foot, about the world's origin.
        total: (N, 6) the same on the whole robot.
        saturated: (N, nq - 7) whether a motor gave all the torque it has.
        bush: (N, 6) deflections of the rubber under the left and the right ankle: up, roll, pitch [m, rad].
        bush_depth: of the rubber below the ankle [m]; 0 on rigid soles.
        believed_waist, believed_com: (N, 3) where the stabilizer's estimator takes them to be [m]; NaN without one.
        obstacle_depth: (N,) largest depth of a contact with the obstacle [m], NaN where there is none.
        touched: the first sample with such a contact and the links that have it, or None.
        count: samples filled so far.
    """

    def __init__(self, samples: int, joints: int, bush_depth: float = 0.0) -> None:
        """Make room."""
        self.bush_depth = bush_depth
        self.q = np.zeros((samples, 7 + joints))
        self.dq, self.torque = np.zeros((samples, joints)), np.zeros((samples, joints))
        self.feet, self.total = np.zeros((samples, 2, 6)), np.zeros((samples, 6))
        self.saturated, self.bush = np.zeros((samples, joints), dtype=bool), np.zeros((samples, 6))
        self.believed_waist, self.believed_com = np.full((2, samples, 3), np.nan)
        self.obstacle_depth = np.full(samples, np.nan)
        self.touched: tuple[int, list[str]] | None = None
        self.count = 0

    def add(self, world: World, touch: Touch, torque: np.ndarray, saturated: np.ndarray) -> None:
        """Write down the present state, and the means since the sample before."""
        k = self.count
        angles, self.dq[k], _ = world.joint_states()
        self.q[k] = np.concatenate([world.base_pose(), angles])
        if k and self.q[k, 3:7] @ self.q[k - 1, 3:7] < 0.0:
            self.q[k, 3:7] *= -1.0
        self.torque[k], self.feet[k], self.total[k] = torque, touch.feet, touch.total
        self.saturated[k], self.bush[k] = saturated, world.bush()
        if touch.obstacle:
            self.obstacle_depth[k] = max(touch.obstacle.values())
            self.touched = self.touched or (k, sorted(touch.obstacle))
        self.count += 1

    def believe(self, sample: int, waist: np.ndarray, com: np.ndarray) -> None:
        """Write down where an estimator takes the robot to have been at a sample."""
        if sample >= 0:
            self.believed_waist[sample], self.believed_com[sample] = waist, com

    def state_hash(self) -> str:
        """SHA-256 of all recorded states, torques and forces, to the last bit."""
        series = (self.q, self.dq, self.torque, self.feet, self.total)
        return hashlib.sha256(b"".join(part[: self.count].tobytes() for part in series)).hexdigest()


def has_fallen(parameters: Simulation, waist: np.ndarray, planned: np.ndarray, touch: Touch) -> str | None:
    """Why a robot counts as fallen, as the beginning of a sentence; None while it stands.

    Args:
        parameters: of the simulation, for the limits.
        waist: (7,) measured pose.
        planned: (7,) planned pose.
        touch: what touches it.
    """
    up, planned_up = (axes(x[3:].tolist())[:, 2] for x in (waist, planned))
    tilt = math.degrees(math.acos(min(max(up @ planned_up, -1.0), 1.0)))
    drop = float(planned[2] - waist[2])
    if touch.others:
        return f"the floor is touched by {' and '.join(sorted(touch.others))}"
    if tilt > parameters.fall_tilt_deg:
        return f"the waist is tilted by {tilt:.0f} degrees against the plan"
    if drop > parameters.fall_drop:
        return f"the waist is {1e3 * drop:.0f} mm below the plan"
    return None
