"""A planner in one file, to be copied: the robot stands before the obstacle for two seconds."""

from __future__ import annotations

import numpy as np

from stepover.model.course import Course
from stepover.model.obstacle import Obstacle
from stepover.model.pose import pose
from stepover.model.robot import Robot
from stepover.motion.footsteps import Footsteps
from stepover.motion.motion import Motion, obstacle_row
from stepover.planning.checks import require
from stepover.planning.request import one_obstacle

COUNT, FRONT_FACE = 400, 1.0
"""Number of samples; where the obstacle's front face is unless it states its distance [m]."""


def stand_still(robot: Robot, obstacle: Obstacle | Course) -> Motion:
    """Plan to stand still.

    Raises:
        InvalidInput: no Robot, no Obstacle, or several obstacles.
        Infeasible: the half-sitting posture breaks a limit, or reaches into the obstacle.
    """
    obstacle = one_obstacle(robot, obstacle)
    body, dt = robot.body, robot.walk.sample_time
    q = np.tile(robot.half_sitting(), (COUNT, 1))
    left, right = (pose(np.tile([0.0, side * robot.posture.feet_apart / 2.0, 0.0], (COUNT, 1))) for side in (1, -1))
    zmp, both = body.zmp(q, dt), np.zeros(COUNT, dtype=int)
    motion = Motion(
        time=np.arange(COUNT) * dt, q=q, joint_names=np.array(body.joint_names),
        left_foot=left, right_foot=right, waist=q[:, :7], com=body.com(body.placements(q)),
        zmp_reference=zmp, zmp=zmp, support=both, phase=both, footsteps=Footsteps.from_rows(np.empty((0, 6))),
        obstacles=obstacle_row(obstacle, obstacle.distance or FRONT_FACE)[None],
        robot=robot.name, robot_fingerprint=robot.fingerprint, planner="toy",
    )  # fmt: skip
    require(robot, motion)
    return motion
