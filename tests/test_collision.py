"""model/collision.py: separating axes against coal's exact distances, the broad phase against brute force."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin
import pytest
from conftest import random_q

from stepover import Obstacle
from stepover.model.collision import (
    clearance,
    distance_between,
    exact_distance,
    keep_free,
    least_separation,
    profile,
    separation,
)
from stepover.model.kinematics import Placements
from stepover.model.obstacle import LATERAL_HALF_EXTENT

BEAM = Obstacle(0.15, 0.05).profile(0.1, margins=False)


@pytest.fixture(scope="module")
def strewn(robot, pin_model):
    """HRP-2 in 150 random postures around the beam."""
    q = random_q(pin_model, 150, seed=11)
    q[:, :3] *= [0.4, 0.05, 0.3]
    return robot.body.placements(q)


@pytest.fixture(scope="module")
def walking(robot, motion):
    """Every fifth sample of the planned motion."""
    return robot.body.placements(motion.q[::5])


def brute_force(shapes, placements, rectangle):
    """Exact distances (shapes, N) by coal from solids built here, from the shapes' corners in the world."""
    x_min, x_max, z_min, z_max = rectangle
    beam = coal.Box(x_max - x_min, 2.0 * LATERAL_HALF_EXTENT, z_max - z_min)
    place = coal.Transform3s(np.eye(3), np.array([(x_min + x_max) / 2.0, 0.0, (z_min + z_max) / 2.0]))
    distances = np.empty((len(shapes), len(placements.positions)))
    for i, shape in enumerate(shapes):
        points = coal.StdVec_Vec3s()
        for vertex in shape.vertices:
            points.append(vertex)
        solid = coal.Convex.convexHull(points, True, "Qt")
        for k in range(len(placements.positions)):
            where = coal.Transform3s(
                placements.rotations[k, shape.joint].copy(), placements.positions[k, shape.joint].copy()
            )
            request, result = coal.DistanceRequest(), coal.DistanceResult()
            distances[i, k] = coal.distance(solid, where, beam, place, request, result)
    return distances


def test_separation_is_exact_inside_and_a_lower_bound_outside(robot, strewn):
    exact = brute_force(robot.shapes, strewn, BEAM)
    ours = np.array([separation(shape, strewn, BEAM) for shape in robot.shapes])
    assert (exact < -0.01).sum() > 100
    assert (exact > 0.01).sum() > 1000
    np.testing.assert_array_equal(np.sign(ours[np.abs(exact) > 1e-5]), np.sign(exact[np.abs(exact) > 1e-5]))
    inside = exact < 0.0
    np.testing.assert_allclose(ours[inside], exact[inside], atol=1e-5)
    assert (ours[~inside] <= exact[~inside] + 1e-6).all()
    assert np.median(ours[~inside] / exact[~inside]) > 0.9


def test_shapes_are_where_the_urdf_puts_them(robot, pin_model, strewn):
    """Every corner in the world, against pinocchio's own geometry placements."""
    geometry = pin.buildGeomFromUrdf(
        pin_model, str(robot.urdf_path), pin.GeometryType.COLLISION, package_dirs=[str(robot.urdf_path.parent)]
    )
    data, places = pin_model.createData(), geometry.createData()
    q = random_q(pin_model, 150, seed=11)
    q[:, :3] *= [0.4, 0.05, 0.3]
    pin.updateGeometryPlacements(pin_model, data, geometry, places, q[17])
    for shape, item, place in zip(robot.shapes, geometry.geometryObjects, places.oMg, strict=True):
        rotations, positions = strewn.rotations[17, shape.joint], strewn.positions[17, shape.joint]
        world = shape.vertices @ rotations.T + positions
        box = item.geometry
        if isinstance(box, coal.Box):
            own = (world - place.translation) @ place.rotation
            np.testing.assert_allclose(np.abs(own), np.tile(box.halfSide, (8, 1)), atol=1e-9)
        xz = profile(shape, Placements(strewn.rotations[17:18], strewn.positions[17:18]))[0]
        np.testing.assert_allclose(xz, world[:, [0, 2]], atol=1e-12)


def test_clearance_is_the_smallest_of_all_distances(robot, motion, walking):
    exact = brute_force(robot.shapes, walking, motion.bare_obstacle)
    found = clearance(robot.shapes, walking, motion.bare_obstacle)
    own = [shape.link == found.link for shape in robot.shapes]
    assert found.distance == pytest.approx(exact.min(), abs=1e-6)
    assert found.distance == pytest.approx(exact[own, found.sample].min(), abs=1e-6)


def test_clearance_of_a_collision_is_negative(robot, motion, walking):
    thick = motion.bare_obstacle + np.array([0.0, 0.0, 0.0, 0.1])
    exact = brute_force(robot.shapes, walking, thick)
    found = clearance(robot.shapes, walking, thick)
    assert found.distance < -0.01
    assert found.distance == pytest.approx(exact.min(), abs=1e-5)


def test_a_rectangle_a_sample(robot, strewn):
    rectangles = BEAM + np.outer(np.linspace(-0.5, 0.5, 150), [1.0, 1.0, 0.0, 0.0])
    for shape in robot.shapes[::5]:
        each = [
            separation(shape, Placements(strewn.rotations[k : k + 1], strewn.positions[k : k + 1]), rectangles[k])[0]
            for k in range(150)
        ]
        np.testing.assert_allclose(separation(shape, strewn, rectangles), each, atol=1e-12)


@pytest.mark.parametrize("up_to", [np.inf, 0.02, 0.0])
@pytest.mark.parametrize("moving", [False, True])
def test_the_least_separation_is_that_of_all_shapes(robot, strewn, up_to, moving):
    rectangle = BEAM + np.outer(np.linspace(-0.5, 0.5, 150), [1.0, 1.0, 0.0, 0.0]) if moving else BEAM
    each = np.array([separation(shape, strewn, rectangle) for shape in robot.shapes])
    least, which = least_separation(robot.shapes, strewn, rectangle, up_to)
    np.testing.assert_allclose(least, np.minimum(each.min(axis=0), up_to), atol=1e-12)
    told = each.min(axis=0) < up_to
    assert told.sum() > 20
    np.testing.assert_allclose(each[which, np.arange(150)][told], least[told], atol=1e-12)


@pytest.mark.parametrize("spare", [-0.02, 0.0, 0.003])
def test_a_sample_keeps_free_by_what_its_least_separation_is(robot, strewn, spare):
    least, _ = least_separation(robot.shapes, strewn, BEAM)
    free = keep_free(robot.shapes, strewn, BEAM, spare)
    assert 10 < free.sum() < 140
    np.testing.assert_array_equal(free, least >= spare)


def foot_at(robot, x, z, yaw=0.0):
    """The right foot's lower box and its placement, the ankle at (x, z)."""
    shape = next(s for s in robot.shapes if s.link == "RLEG_LINK5" and s.vertices[:, 2].min() < -0.1)
    q = robot.half_sitting()[None]
    placements = robot.body.placements(q)
    positions, rotations = placements.positions.copy(), placements.rotations.copy()
    positions[0, shape.joint] = [x, 0.0, z]
    rotations[0, shape.joint] = [[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]]
    return shape, Placements(rotations, positions)


def test_known_distances_of_a_level_foot(robot):
    """Toe 0.1356 m ahead of the ankle, heel 0.1056 m behind, sole 0.105 m under it; beam from 0.10 to 0.15 m."""
    for x, z, expected in (
        (0.1 - 0.1356 - 0.04, 0.105, 0.04),  # before the beam
        (0.15 + 0.1056 + 0.03, 0.105, 0.03),  # behind it
        (0.12, 0.15 + 0.105 + 0.02, 0.02),  # above it
        (0.12, 0.15 + 0.105 - 0.02, -0.02),  # 2 cm into its top: out upwards
        (0.1 - 0.1356 + 0.01, 0.105, -0.01),  # 1 cm into its front: out backwards, not through the floor
    ):
        shape, placements = foot_at(robot, x, z)
        assert exact_distance(shape, placements, 0, BEAM) == pytest.approx(expected, abs=1e-6)
        assert separation(shape, placements, BEAM)[0] == pytest.approx(expected, abs=1e-6)


def test_a_corner_that_is_nearest(robot):
    shape, placements = foot_at(robot, 0.1 - 0.1356 - 0.03, 0.15 + 0.105 + 0.04)
    assert exact_distance(shape, placements, 0, BEAM) == pytest.approx(0.05, abs=1e-6)
    assert separation(shape, placements, BEAM)[0] == pytest.approx(0.04, abs=1e-9)


def test_the_outer_corner_of_a_yawed_foot_comes_nearest(robot):
    level, turned = (separation(*foot_at(robot, -0.1, 0.105, yaw), BEAM)[0] for yaw in (0.0, 0.3))
    corner = np.cos(0.3) * 0.1356 + np.sin(0.3) * 0.079
    assert level == pytest.approx(0.2 - 0.1356)
    assert turned == pytest.approx(0.2 - corner)


def test_distance_between_the_feet(robot):
    feet = [next(s for s in robot.shapes if s.link == name) for name in ("LLEG_LINK5", "RLEG_LINK5")]
    placements = robot.body.placements(robot.half_sitting()[None])
    assert distance_between(*feet, placements, 0) == pytest.approx(0.19 - 2.0 * 0.059, abs=1e-6)
