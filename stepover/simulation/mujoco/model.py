"""The robot, the floor and the obstacles as a MuJoCo model, built from the one reading of the robot.

What may touch what is said by bits: a robot's link touches no other link, each foot has a floor of its own, whose
height may change, and all other links have another floor. MuJoCo takes the larger friction of two surfaces, so that
the robot's own is zero.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from stepover.model.collision import hull_of
from stepover.model.description import BOX, CYLINDER, MESH, PRISMATIC, Description, Hinge, Link, Place, Solid
from stepover.model.obstacle import LATERAL_HALF_EXTENT
from stepover.simulation.engine import Scene
from stepover.simulation.mujoco.parameters import Contact
from stepover.simulation.simulated import SimulatedRobot

FOOT_BITS, OTHER_BIT = (1, 2), 4
"""What the left foot, the right foot and all other links are to the floors."""


def model_of(scene: Scene, robot: SimulatedRobot, contact: Contact) -> mujoco.MjModel:
    """The compiled model: floors and obstacles, the robot with an actuator on each joint, bushes last."""
    spec = mujoco.MjSpec()
    spec.modelname = robot.description.name
    _settle(spec, scene, contact)
    friction = scene.disturbances.friction or scene.robot.simulation.friction
    for name, bit in (("left floor", FOOT_BITS[0]), ("right floor", FOOT_BITS[1]), ("floor", OTHER_BIT)):
        _still(spec, name, mujoco.mjtGeom.mjGEOM_PLANE, (0.0, 0.0, 0.05), (0.0, 0.0, 0.0), bit)
    for number, (front, width, height) in enumerate(row[:3] for row in scene.obstacles):
        half = (width / 2.0, LATERAL_HALF_EXTENT, height / 2.0)
        place = (front + half[0], 0.0, half[2])
        every = OTHER_BIT | FOOT_BITS[0] | FOOT_BITS[1]
        _still(spec, f"obstacle {number}", mujoco.mjtGeom.mjGEOM_BOX, half, place, every)
    _add_robot(spec, robot, contact, friction)
    for joint in (*scene.robot.body.joint_names, *robot.passive):
        actuator = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.ctrllimited, actuator.forcelimited = mujoco.mjtLimited.mjLIMITED_FALSE, mujoco.mjtLimited.mjLIMITED_FALSE
    return spec.compile()


def _settle(spec: mujoco.MjSpec, scene: Scene, contact: Contact) -> None:
    """Time step, gravity and solver."""
    option = spec.option
    option.timestep, option.gravity = scene.robot.simulation.time_step, scene.disturbances.gravity
    option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    option.cone, option.solver = mujoco.mjtCone.mjCONE_ELLIPTIC, mujoco.mjtSolver.mjSOL_NEWTON
    option.iterations, option.tolerance = contact.iterations, contact.tolerance
    option.impratio = contact.friction_stiffness
    spec.compiler.degree = False


def _still(
    spec: mujoco.MjSpec, name: str, kind: int, size: Sequence[float], place: Sequence[float], bits: int
) -> None:
    """A geometry that never moves."""
    spec.worldbody.add_geom(
        name=name, type=kind, size=size, pos=place, contype=0, conaffinity=bits, friction=[0.0, 0.0, 0.0], condim=3
    )


def _add_robot(spec: mujoco.MjSpec, robot: SimulatedRobot, contact: Contact, friction: float) -> None:
    """Bodies, joints and shapes, from the root outwards."""
    description = robot.description
    root = description.links[0]
    bodies = {root.name: _body(spec, spec.worldbody, root, None, robot, contact, friction)}
    left = list(description.joints)
    while left:
        joint = next(joint for joint in left if joint.parent in bodies)
        left.remove(joint)
        link = description.link_by_name[joint.child]
        bodies[link.name] = _body(spec, bodies[joint.parent], link, joint, robot, contact, friction)


def _body(
    spec: mujoco.MjSpec, parent: mujoco.MjsBody, link: Link, joint: Hinge | None, robot: SimulatedRobot, contact: Contact, friction: float
) -> mujoco.MjsBody:
    """A link behind its joint; the root behind a free one."""
    place = joint.place if joint else None
    body = parent.add_body(name=link.name)
    if place is not None:
        body.pos, body.quat = place.translation, _quaternion(place)
    inertia = link.inertia
    body.mass, body.ipos, body.explicitinertial = inertia.mass, inertia.centre, True
    m = inertia.matrix
    body.fullinertia = [m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2]]
    if joint is None:
        body.add_freejoint()
    else:
        kind = mujoco.mjtJoint.mjJNT_SLIDE if joint.kind == PRISMATIC else mujoco.mjtJoint.mjJNT_HINGE
        body.add_joint(name=joint.name, type=kind, axis=joint.axis, limited=mujoco.mjtLimited.mjLIMITED_FALSE)
    foot = _foot_of(robot, link.name)
    for number, solid in enumerate(link.solids):
        _shape(spec, body, solid, f"{link.name} {number}", FOOT_BITS[foot] if foot >= 0 else OTHER_BIT, contact, friction)
    return body


def _foot_of(robot: SimulatedRobot, link: str) -> int:
    """0 for a link of the left foot, 1 of the right one, -1 for any other; what is beyond a bush counts as the foot."""
    return next((k for k, foot in enumerate(robot.feet) if link == foot or (link in robot.passive and link.startswith(f"{foot}_"))), -1)


def _shape(spec: mujoco.MjSpec, body: mujoco.MjsBody, solid: Solid, name: str, bit: int, contact: Contact, friction: float) -> None:
    """A shape of a link."""
    how = {
        "name": name, "pos": solid.place.translation, "quat": _quaternion(solid.place), "contype": bit, "conaffinity": 0,
        "friction": [friction, 0.0, 0.0], "condim": 3, "mass": 0.0, "solref": contact.solref, "solimp": contact.solimp,
        "priority": 1,
    }  # fmt: skip
    if solid.kind == MESH:
        corners, faces = hull_of(solid.corners)
        spec.add_mesh(name=name, uservert=corners.ravel(), userface=faces.ravel())
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, **how)
    elif solid.kind == BOX:
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=np.array(solid.size) / 2.0, **how)
    elif solid.kind == CYLINDER:
        size = [solid.size[0], solid.size[1] / 2.0, 0.0]
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=size, **how)
    else:
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[solid.size[0], 0.0, 0.0], **how)


def _quaternion(place: Place) -> np.ndarray:
    """Quaternion w x y z of a place's rotation."""
    result = np.zeros(4)
    mujoco.mju_mat2Quat(result, place.rotation.ravel())
    return result
