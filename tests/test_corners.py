"""model/description/corners.py: hulls around round shapes, against coal's own distances."""

from __future__ import annotations

import coal
import numpy as np
import pytest

from stepover import InvalidInput
from stepover.model.body import Body
from stepover.model.collision import shapes_of
from stepover.model.description.corners import corners_of
from stepover.robots.urdf import read_urdf

ROUND = {"cylinder": coal.Cylinder(0.05, 0.3), "sphere": coal.Sphere(0.08)}
SIZES = {"cylinder": (0.05, 0.3), "sphere": (0.08,)}
SURPLUS = {"cylinder": 1.02, "sphere": 1.071}


def body_of(tmp_path, geometry):
    """A body of one link with one collision shape."""
    urdf = tmp_path / "one.urdf"
    urdf.write_text(
        '<robot name="one"><link name="ONE"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
        f'<collision><origin xyz="0.1 0 0" rpy="0 1.5707963 0"/><geometry>{geometry}</geometry></collision>'
        "</link></robot>"
    )
    return Body(read_urdf(urdf)[0])


@pytest.mark.parametrize("kind", ROUND)
def test_a_hull_holds_what_is_round_and_hardly_more(kind):
    """Seen from all sides: the hull reaches as far as the shape's own support, by coal, and at most so much further."""
    shape = ROUND[kind]
    hull = corners_of(kind, SIZES[kind])
    directions = np.random.default_rng(4).normal(size=(500, 3))
    directions = np.vstack([directions / np.linalg.norm(directions, axis=1, keepdims=True), np.eye(3), -np.eye(3)])
    reach = (hull @ directions.T).max(axis=0)
    far, place = 5.0, coal.Transform3s()
    for direction, hull_reach in zip(directions, reach, strict=True):
        plane = coal.Halfspace(-direction, -far)
        own = far - coal.distance(shape, place, plane, place, coal.DistanceRequest(), coal.DistanceResult())
        assert own - 1e-9 <= hull_reach <= own * SURPLUS[kind] + 1e-9


@pytest.mark.parametrize(
    ("geometry", "low", "high"),
    [
        ('<cylinder radius="0.05" length="0.3"/>', [-0.05, -0.05, -0.05], [0.25, 0.05, 0.05]),
        ('<sphere radius="0.08"/>', [0.02, -0.08, -0.08], [0.18, 0.08, 0.08]),
        ('<box size="0.3 0.1 0.2"/>', [0.0, -0.05, -0.15], [0.2, 0.05, 0.15]),
    ],
)
def test_a_urdfs_shape_lies_where_the_urdf_puts_it(tmp_path, geometry, low, high):
    vertices = shapes_of(body_of(tmp_path, geometry))[0].vertices
    np.testing.assert_allclose(vertices.min(axis=0), low, atol=0.01)
    np.testing.assert_allclose(vertices.max(axis=0), high, atol=0.01)
    assert (vertices.min(axis=0) <= np.array(low) + 1e-6).all()
    assert (vertices.max(axis=0) >= np.array(high) - 1e-6).all()


def test_a_shape_that_is_not_read_is_not_passed_over(tmp_path):
    with pytest.raises(InvalidInput, match="'capsule' is not known; known are box, cylinder, sphere and mesh"):
        body_of(tmp_path, '<capsule radius="0.05" length="0.3"/>')
