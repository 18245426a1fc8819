"""The result of a planner: a motion, with all that is needed to check it without the planner."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stepover import __version__
from stepover.errors import InvalidInput
from stepover.model.obstacle import LATERAL_HALF_EXTENT, Obstacle
from stepover.model.robot import Robot
from stepover.motion import formats
from stepover.motion.footsteps import Footsteps


@dataclass(frozen=True, eq=False)
class Motion:
    """A whole-body motion, N samples in SI units. World: origin between the ankles at the start, x ahead, y left, z up.

    Attributes:
        time: (N,) [s], uniform.
        q: (N, nq) configurations in pinocchio's order, free-flyer first (x y z, quaternion x y z w).
        joint_names: (nq - 7,) names of the joints behind q[7:].
        left_foot, right_foot: (N, 7) poses of the sole frames. Their origins are on the soles, under the ankles.
        waist: (N, 7) pose of the root body.
        com: (N, 3) centre of mass of the multi-body model [m].
        zmp_reference: (N, 2) desired ZMP [m].
        zmp: (N, 2) multi-body ZMP [m].
        support: (N,) 0 double, +1 left foot only, -1 right foot only.
        phase: (N,) 0 walking, 1, 2, 3 the phases of Sec. II; all 0 if the planner does not set phases.
        footsteps: places and times at which the feet come down.
        obstacles: (M, 7) front face x, width, height, margin_width, margin_height, lateral half extent [m], yaw [rad].
        robot: name of the robot; `robot_name` rejects a path.
        robot_fingerprint: Robot.fingerprint of the robot in the plan; "" if unknown.
        planner: name of the planner; "" if unknown.
        zmp_first_stage: (N, 2) multi-body ZMP before the dynamic filter [m]; None if the planner has no filter.
        key_configuration: (3,) X_ads, X_hds, Z_hds [m]; None if the planner does not use one.
        version: version of stepover that planned the motion.
    """

    time: np.ndarray
    q: np.ndarray
    joint_names: np.ndarray
    left_foot: np.ndarray
    right_foot: np.ndarray
    waist: np.ndarray
    com: np.ndarray
    zmp_reference: np.ndarray
    zmp: np.ndarray
    support: np.ndarray
    phase: np.ndarray
    footsteps: Footsteps
    obstacles: np.ndarray
    robot: str
    robot_fingerprint: str = ""
    planner: str = ""
    zmp_first_stage: np.ndarray | None = None
    key_configuration: np.ndarray | None = None
    version: str = __version__

    @property
    def dt(self) -> float:
        """Sample time [s]."""
        return float(self.time[-1] - self.time[0]) / (len(self.time) - 1)

    @property
    def obstacle(self) -> np.ndarray:
        """The first obstacle (6,): a row of `obstacles` without its yaw [m]."""
        return self.obstacles[0, :6]

    @property
    def bare_obstacle(self) -> np.ndarray:
        """Rectangle (4,) x_min, x_max, z_min, z_max of the first obstacle without margins [m]."""
        return self.profile(0, margins=False)

    def profile(self, number: int, margins: bool) -> np.ndarray:
        """Rectangle (4,) x_min, x_max, z_min, z_max of an obstacle in its own frame [m]. Numbers start at 0."""
        front, width, height, beside, above = self.obstacles[number, :5]
        return Obstacle(height, width, above, beside).profile(front, margins)

    @property
    def has_phases(self) -> bool:
        """Whether the planner set the phases of Sec. II."""
        return bool(np.any(self.phase))

    def foot(self, side: int) -> np.ndarray:
        """Sole poses (N, 7) of a side: +1 left, -1 right."""
        return self.left_foot if side > 0 else self.right_foot

    def samples(self, phase: int) -> slice:
        """Samples of a phase of Sec. II: 1, 2 or 3.

        Raises:
            InvalidInput: the motion has no such phase.
        """
        inside = np.flatnonzero(self.phase == phase)
        if len(inside) == 0:
            raise InvalidInput(f"the motion has no phase {phase}: its planner does not know the phases of Sec. II")
        return slice(int(inside[0]), int(inside[-1]) + 1)

    def hash(self) -> str:
        """SHA-256 of q rounded to a micrometre (microradian). Equal motions have equal hashes."""
        rounded = np.round(self.q * 1e6).astype(np.int64) + 0
        return hashlib.sha256(rounded.tobytes()).hexdigest()

    @property
    def robot_name(self) -> str:
        """The robot's name, to load it by: a motion from elsewhere never says which file is opened.

        Raises:
            InvalidInput: it is a path.
        """
        if Path(self.robot).suffix == ".toml" or {"/", "\\"} & set(self.robot):
            raise InvalidInput(f"the motion names its robot by the path {self.robot!r}: give that robot.toml yourself")
        return self.robot

    def require_robot(self, robot: Robot) -> None:
        """Reject a robot that the motion was not planned for.

        Raises:
            InvalidInput: the joints or the fingerprint differ.
        """
        if list(self.joint_names) != robot.body.joint_names:
            raise InvalidInput(f"the motion is for {self.robot!r}: its joints are not those of {robot.name!r}")
        if self.robot_fingerprint and self.robot_fingerprint != robot.fingerprint:
            raise InvalidInput(
                f"the motion was planned for another robot than this {robot.name!r}: the fingerprint of URDF, meshes "
                f"and facts is {self.robot_fingerprint} in the motion and {robot.fingerprint} here; give the "
                "robot.toml of the motion, or plan it again"
            )

    def export(self, path: str | Path, format: str) -> None:
        """Write the motion in one of the formats in `motion/formats`, such as "csv".

        Raises:
            InvalidInput: there is no such format, or the folder does not exist or cannot be written to.
        """
        formats.find(format).export(self, Path(path))

    def save(self, path: str | Path) -> None:
        """Write an npz file. Numpy alone can read it.

        Raises:
            InvalidInput: the folder does not exist or cannot be written to.
        """
        self.export(path, "npz")

    def save_csv(self, path: str | Path) -> None:
        """Write time, waist, CoM, ZMPs, feet and joints as a table with one row for each sample.

        Raises:
            InvalidInput: the folder does not exist or cannot be written to.
        """
        self.export(path, "csv")

    @staticmethod
    def load(path: str | Path) -> Motion:
        """Read a motion file, of format 1 or 2.

        Raises:
            InvalidInput: no such file, not a regular file, or too large.
            CorruptMotion: it is cut short, not a motion, lacks a key, has an unknown one, or contradicts itself.
        """
        motion: Motion = formats.find("npz").load(Path(path))
        return motion


def obstacle_row(obstacle: Obstacle, front_face: float) -> np.ndarray:
    """The seven numbers (7,) of an obstacle as stored in a motion."""
    sizes = [obstacle.width, obstacle.height, obstacle.margin_width, obstacle.margin_height]
    return np.array([front_face, *sizes, LATERAL_HALF_EXTENT, obstacle.yaw])
