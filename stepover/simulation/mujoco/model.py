"""Robot, floors and obstacles as a MuJoCo model, built from the one reading of the robot.

Bits say what may touch what: the robot's links never touch each other, each foot has a floor of its own, whose height
may change, and all other links have another floor. The robot's shapes have the higher priority, so that their
friction counts; MuJoCo would take the larger one of two surfaces.
"""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from stepover.model.collision import hull_of
from stepover.model.description.links import BOX, CYLINDER, MESH, PRISMATIC, Hinge, Link, Place, Solid
from stepover.model.obstacle import LATERAL_HALF_EXTENT
from stepover.model.parameters.physics import Simulation
from stepover.simulation.engine import NO_FOOT, Scene
from stepover.simulation.simulated import SimulatedRobot

mujoco.set_mju_user_warning(lambda text: None)  # it would write a file; World looks at the count instead

FOOT_BITS, OTHER_BIT = (1, 2), 4
"""What the left foot, the right foot and every other link are to the floors."""
FLOORS = ("left floor", "right floor", "floor")
"""Names of the floors under the left foot, the right foot and every other link."""
IMPEDANCE = 0.95, 0.99, 0.001, 0.5, 2.0
"""How much of its penetration a contact resists at first touch and beyond a depth, that depth [m], midpoint, power."""
DAMPED = 1.0
"""Damping ratio of contacts: they neither bounce nor creep."""
ITERATIONS, TOLERANCE = 100, 1e-10
"""Most iterations of the solver, which needs 7 at most over 15 cm, and when it has converged."""
NOT_LIMITED = mujoco.mjtLimited.mjLIMITED_FALSE


def model_of(scene: Scene, robot: SimulatedRobot) -> mujoco.MjModel:
    """The compiled model: robot, floors and obstacles, in this order; a motor on each joint, the bushes' last."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    option = spec.option
    parameters = scene.robot.simulation
    option.timestep, option.gravity = parameters.time_step, scene.disturbances.gravity
    option.integrator, option.solver = mujoco.mjtIntegrator.mjINT_EULER, mujoco.mjtSolver.mjSOL_NEWTON
    option.cone, option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, parameters.friction_stiffness
    option.iterations, option.tolerance = ITERATIONS, TOLERANCE
    _add_robot(spec, robot, _surface(parameters, scene.disturbances.friction))
    _add_surroundings(spec, scene)
    for joint in (*scene.robot.body.joint_names, *robot.passive):
        motor = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        motor.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        motor.ctrllimited = motor.forcelimited = NOT_LIMITED
    return spec.compile()


def foot_of(robot: SimulatedRobot, link: str) -> int:
    """0 for a link of the left foot, 1 of the right one, NO_FOOT for others; the plate under a bush is of the foot."""
    for foot, name in enumerate(robot.feet):
        if link == name or (link in robot.passive and link.startswith(f"{name}_")):
            return foot
    return NO_FOOT


def _add_surroundings(spec: mujoco.MjSpec, scene: Scene) -> None:
    """Floors, each a body whose place may be set, and obstacles."""
    bits = (*FOOT_BITS, OTHER_BIT)
    for name, bit in zip(FLOORS, bits, strict=True):
        floor = {"name": name, "type": mujoco.mjtGeom.mjGEOM_PLANE, "size": (0.0, 0.0, 0.05)}
        body = spec.worldbody.add_body(name=name, mocap=True)
        body.add_geom(**floor, contype=0, conaffinity=bit, condim=3)
    for number, (front, width, height) in enumerate(row[:3] for row in scene.obstacles):
        half = (width / 2.0, LATERAL_HALF_EXTENT, height / 2.0)
        beam = {"name": f"obstacle {number}", "type": mujoco.mjtGeom.mjGEOM_BOX, "size": half}
        spec.worldbody.add_geom(**beam, pos=(front + half[0], 0.0, half[2]), contype=0, conaffinity=sum(bits), condim=3)


def _surface(parameters: Simulation, friction: float | None) -> dict[str, Any]:
    """How the robot's shapes touch others; friction replaces the robot's own, if it is given."""
    slide = friction or parameters.friction
    settling = parameters.contact_time, DAMPED
    return {"friction": (slide, 0.0, 0.0), "priority": 1, "condim": 3, "solref": settling, "solimp": IMPEDANCE}


def _add_robot(spec: mujoco.MjSpec, robot: SimulatedRobot, surface: dict[str, Any]) -> None:
    """Bodies, joints and shapes, from the root outwards."""
    links, left = robot.description.link_by_name, list(robot.description.joints)
    root = robot.description.links[0]
    bodies = {root.name: _add_link(spec.worldbody, root, None)}
    while left:
        joint = next(joint for joint in left if joint.parent in bodies)
        left.remove(joint)
        bodies[joint.child] = _add_link(bodies[joint.parent], links[joint.child], joint)
    for name, body in bodies.items():
        foot = foot_of(robot, name)
        bit = OTHER_BIT if foot == NO_FOOT else FOOT_BITS[foot]
        for number, solid in enumerate(links[name].solids):
            _add_shape(spec, body, solid, {"name": f"{name} {number}", "contype": bit, **surface})


def _add_link(parent: mujoco.MjsBody, link: Link, joint: Hinge | None) -> mujoco.MjsBody:
    """A body behind its joint; the root behind a free one."""
    body, inertia = parent.add_body(name=link.name), link.inertia
    body.mass, body.ipos, body.explicitinertial = inertia.mass, inertia.centre, True
    m = inertia.matrix
    body.fullinertia = (m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2])
    if joint is None:
        body.add_freejoint()
        return body
    body.pos, body.quat = joint.place.translation, _quaternion(joint.place)
    kind = mujoco.mjtJoint.mjJNT_SLIDE if joint.kind == PRISMATIC else mujoco.mjtJoint.mjJNT_HINGE
    body.add_joint(name=joint.name, type=kind, axis=joint.axis, limited=NOT_LIMITED)
    return body


def _add_shape(spec: mujoco.MjSpec, body: mujoco.MjsBody, solid: Solid, how: dict[str, Any]) -> None:
    """A shape of a link; its mass is the link's already."""
    how |= {"pos": solid.place.translation, "quat": _quaternion(solid.place), "conaffinity": 0, "mass": 0.0}
    if solid.kind == MESH:
        corners, faces = hull_of(solid.corners)
        spec.add_mesh(name=how["name"], uservert=corners.ravel(), userface=faces.ravel())
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=how["name"], **how)
    elif solid.kind == BOX:
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=np.array(solid.size) / 2.0, **how)
    elif solid.kind == CYLINDER:
        size = (solid.size[0], solid.size[1] / 2.0, 0.0)
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=size, **how)
    else:
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(solid.size[0], 0.0, 0.0), **how)


def _quaternion(place: Place) -> np.ndarray:
    """Quaternion w x y z (4,) of a place's rotation."""
    result = np.zeros(4)
    mujoco.mju_mat2Quat(result, place.rotation.ravel())
    return result
