import numpy as np
import pytest

from stepover.model import pose
from stepover.planning.algorithm_1.penetration import (
    PointsOnLeg,
    ankle_displacements,
    displace,
    horizontal_depth,
    jacobians,
)

ANGLES = np.radians([-3.0, 2.0, -60.0, 100.0, -35.0, -2.0])


def placed(robot, side, yaw_deg):
    """A leg that steps over: the leg, its waist (7,), joint angles (6,) and sole (7,)."""
    leg = robot.leg(side)
    waist = pose.pose(np.array([[0.3, 0.1, 0.66]]), np.radians(yaw_deg))
    rotations, positions = leg.sole(waist, ANGLES[None])
    return leg, waist[0], ANGLES, pose.from_matrices(rotations, positions)[0]


def point_on(robot, leg, waist, angles, joint, local):
    """World position of a point given in a link's frame."""
    q = robot.half_sitting()[None].copy()
    q[0, :7], q[0, leg.columns] = waist, angles
    placements = robot.body.placements(q)
    index = robot.body.index(leg.joints[joint])
    return placements.rotations[0, index] @ local + placements.positions[0, index]


def one_point(waist, angles, point, joint):
    """A point of the leg at one posture."""
    return PointsOnLeg(waist[None], angles[None], point[None], np.array([joint]))


def displaced(leg, waist, angles, point, joint, push, damping):
    """displace for one posture."""
    return displace(leg, one_point(waist, angles, point, joint), push[None], damping)[0]


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("yaw", [0.0, 25.0])
@pytest.mark.parametrize("joint", [2, 3])
def test_jacobians_match_finite_differences(robot, side, yaw, joint):
    leg, waist, angles, _ = placed(robot, side, yaw)
    local = np.array([0.1, 0.0, -0.05])
    point = point_on(robot, leg, waist, angles, joint, local)
    j_s, j_p = (j[0] for j in jacobians(leg, one_point(waist, angles, point, joint)))
    to_waist = pose.rotation(waist[None])[0].T
    for k in range(4):
        step = np.zeros(6)
        step[k] = 1e-6
        moved = [point_on(robot, leg, waist, angles + s * step, joint, local) for s in (1, -1)]
        np.testing.assert_allclose(j_s[:, k], to_waist @ (moved[0] - moved[1]) / 2e-6, atol=1e-7)
        ankles = [leg.joint_frames(waist[None], (angles + s * step)[None])[0][0] for s in (1, -1)]
        np.testing.assert_allclose(j_p[:, k], to_waist @ (ankles[0] - ankles[1]) / 2e-6, atol=1e-7)


@pytest.mark.parametrize("yaw", [0.0, 25.0])
def test_after_the_full_ik_the_point_moves_by_ds(robot, yaw):
    leg, waist, angles, sole = placed(robot, 1, yaw)
    local = np.array([0.09, 0.0, -0.15])
    point = point_on(robot, leg, waist, angles, 3, local)
    push = np.array([-0.004, 0.0, 0.0])
    moved_sole = sole.copy()
    moved_sole[:3] += displaced(leg, waist, angles, point, 3, push, 1e-4)
    solved = leg.inverse(waist[None], moved_sole[None])[0]
    way = point_on(robot, leg, waist, solved, 3, local) - point
    assert way[0] == pytest.approx(push[0], rel=0.1)


def test_a_thigh_point_leaves_the_knee_column_empty_and_the_push_finite(robot):
    leg, waist, angles, _ = placed(robot, 1, 0.0)
    point = point_on(robot, leg, waist, angles, 2, np.array([0.05, 0.0, -0.2]))
    j_s = jacobians(leg, one_point(waist, angles, point, 2))[0][0]
    assert not j_s[:, 3].any()
    assert np.linalg.norm(displaced(leg, waist, angles, point, 2, np.array([-0.005, 0.0, 0.0]), 0.02)) < 0.1


def test_postures_do_not_see_each_other(robot):
    postures = [placed(robot, 1, yaw)[1:3] for yaw in (0.0, 25.0, 10.0)]
    waist, angles = (np.array(part) for part in zip(*postures, strict=True))
    angles[1, 3] += 0.1
    points, joints = waist[:, :3] + [0.1, 0.0, -0.4], np.array([2, 3, 5])
    push = np.outer([-0.004, 0.003, 0.01], [1.0, 0.0, 0.0])
    together = displace(robot.leg(1), PointsOnLeg(waist, angles, points, joints), push, 0.02)
    for k, one in enumerate(together):
        alone = displaced(robot.leg(1), waist[k], angles[k], points[k], joints[k], push[k], 0.02)
        np.testing.assert_allclose(one, alone, rtol=1e-12)


def test_horizontal_depth_of_a_square():
    square = np.array([[[0.0, 0.1], [0.1, 0.1], [0.1, 0.3], [0.0, 0.3]]])
    box = np.array([0.08, 0.5, -1.0, 0.2])
    way, point = horizontal_depth(square, box, 0.0)
    assert way[0] == pytest.approx(-0.02)
    assert point[0, 0] == pytest.approx(0.1)
    ahead, _ = horizontal_depth(square, np.array([-0.5, 0.03, -1.0, 0.2]), 0.0)
    assert ahead[0] == pytest.approx(0.03)
    free = [np.array([0.2, 0.5, -1.0, 0.2]), np.array([0.0, 0.1, -1.0, 0.05])]
    assert all(horizontal_depth(square, rectangle, 0.0)[0][0] == 0.0 for rectangle in free)


def test_depth_counts_only_what_is_below_the_top():
    slope = np.array([[[0.0, 0.0], [0.2, 0.2], [0.0, 0.2]]])  # its right edge passes z = 0.1 at x = 0.1
    way, point = horizontal_depth(slope, np.array([0.06, 0.5, -1.0, 0.1]), 0.0)
    assert way[0] == pytest.approx(-0.04)
    np.testing.assert_allclose(point[0], [0.1, 0.1])


def test_free_legs_are_not_pushed(robot, planned):
    motion = planned.motion
    over = motion.samples(3)
    rectangle = motion.bare_obstacle
    push = ankle_displacements(robot, 1, motion.waist[over], motion.left_foot[over], rectangle)
    assert not push.any()


def test_the_push_points_out_of_the_obstacle(robot, planned):
    motion = planned.motion
    sample = motion.samples(3).start + 60
    foot = motion.left_foot[sample : sample + 1]
    toe = foot[0, 0] + robot.foot.toe  # a wall that the toe has just entered, lower than the shank
    wall = np.array([toe - 0.01, toe + 1.0, -1.0, foot[0, 2] + 0.02])
    push = ankle_displacements(robot, 1, motion.waist[sample : sample + 1], foot, wall)
    assert push[0, 0] < -0.005
