"""model/robot.py and data/hrp2: the URDF row by row against the published figures, and what load_robot refuses."""

from __future__ import annotations

import base64
import dataclasses
import importlib
import json
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pinocchio as pin
import pybullet
import pytest
from conftest import HRP2, random_q

from stepover import InvalidInput, load_robot
from stepover.locations import data_folder
from stepover.model.parameters.entry import entry_of
from stepover.robots.loading import PARAMETERS

URDF = ElementTree.parse(HRP2 / "hrp2.urdf").getroot()
LINKS = {link.get("name"): link for link in URDF.iter("link")}
JOINTS = {joint.get("name"): joint for joint in URDF.iter("joint")}

# axis, origin [m], range [deg], speed [rad/s], torque [N m], mass [kg], centre of mass [m]; the right side
LEG = """
z   0      -0.060  0       -45   30  3.54 100  1.169  -.010  .005  .065
x   0       0      0       -35   20  3.81 100  0.806   0    -.026 -.003
y   0       0      0      -125   42  4.42 100  2.076   .003 -.078 -.152
y   0       0     -0.300     0  150  3.98 100  1.748   .018 -.058 -.138
y   0      -0.035 -0.300   -75   42  5.08 100  0.654   .008 -.001 -.002
x   0       0      0       -20   35  9.14 100  1.639  -.001 -.005 -.065
"""
CHEST = """
z   .032    0      .3477   -45   45  4.40  40  0.786  -.016  .005 -.025
y   0       0      0        -5   60  2.40  40 11.525  -.029  .007  .121
"""
HEAD = """
z  -.007    0      .2973   -45   45  6.88  10  0.375  -.001  .004 -.008
y   0       0      0       -30   45  6.88  10  0.993   .013  0     .079
"""
ARM = """
y   .008   -.250   .181   -180   60  4.17  60   .810  -.010  .046  0
x   0       0      0       -95   10  2.42  60  1.034  -.011 -.012 -.009
z   0       0      0       -92   92  4.16  60  1.599  -.005 -.005 -.167
y   0       0     -.250   -137    2  2.24  50   .777   0    -.016 -.063
z   0       0     -.250    -92   92  4.73  20   .555  -.003 -.004  .041
y   0       0      0       -92   92  6.64  10   .712  -.001  .002 -.073
y   .022    0     -.095    -60   16  2.77   1   .086  -.002 -.004 -.030
"""
BODY_MASS, BODY_CENTRE = 15.03 + 1.96, (-0.014, 0.0, 0.220)
# size, centre in the link's frame [m]; the right side. The shanks are prisms.
BOXES = {
    "BODY": [((0.290, 0.320, 0.220), (-0.025, 0.0, 0.215))],
    "RLEG_LINK0": [((0.105, 0.074, 0.070), (-0.0075, 0.0, 0.065))],
    "RLEG_LINK2": [((0.107, 0.136, 0.270), (0.0035, -0.068, -0.105))],
    "RLEG_LINK5": [((0.2412, 0.138, 0.030), (0.015, -0.010, -0.090)), ((0.110, 0.100, 0.075), (0.005, 0.0, -0.0375))],
    "CHEST_LINK1": [((0.350, 0.380, 0.285), (-0.045, 0.0, 0.1425))],
    "HEAD_LINK1": [((0.240, 0.200, 0.195), (0.0, 0.0, 0.1075))],
    "RARM_LINK1": [((0.120, 0.110, 0.090), (0.0, 0.0, 0.0))],
    "RARM_LINK2": [((0.090, 0.100, 0.195), (-0.005, 0.0, -0.1425))],
    "RARM_LINK3": [((0.076, 0.088, 0.155), (0.0, -0.006, -0.0775))],
    "RARM_LINK5": [((0.080, 0.090, 0.190), (0.005, 0.0, -0.095))],
}
OUTLINE = {
    "L1": (0.0590, 0.1022), "L2": (0.1022, 0.0590), "L3": (0.1180, 0.0), "L4": (0.0772, -0.2253),
    "L5": (-0.0772, -0.2492), "L6": (-0.0163, -0.0939), "L7": (-0.0322, -0.0183),
}  # fmt: skip
PRISMS = {"knee": ("L1", "L2", "L3", "L6", "L7"), "calf": ("L3", "L4", "L5", "L6")}
MIRROR = np.array([1.0, -1.0, 1.0])
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def rows():
    """Name, parent link and the row of all 30 joints, the left side mirrored from the right."""
    limbs = [("RLEG", "BODY", LEG), ("LLEG", "BODY", LEG), ("CHEST", "BODY", CHEST)]
    limbs += [("HEAD", "CHEST_LINK1", HEAD), ("RARM", "CHEST_LINK1", ARM), ("LARM", "CHEST_LINK1", ARM)]
    for name, parent, table in limbs:
        for index, line in enumerate(table.strip().splitlines()):
            axis, *numbers = line.split()
            values = np.array(numbers, dtype=float)
            if name[0] == "L":
                values[[1, 9]] *= -1.0
                if axis in "xz":
                    values[[3, 4]] = -values[[4, 3]]
            yield f"{name}_JOINT{index}", parent, axis, values
            parent = f"{name}_LINK{index}"


ROWS = list(rows())


def vector(element, key="xyz"):
    """Three numbers of an attribute."""
    return np.array(element.get(key).split(), dtype=float)


def boxes_of(name, tag):
    """Sizes and centres of a link's boxes."""
    return [
        (vector(shape.find("geometry/box"), "size"), vector(shape.find("origin")))
        for shape in LINKS[name].iter(tag)
        if shape.find("geometry/box") is not None
    ]


def expected_boxes(name):
    """The table's boxes, for both sides."""
    if name[0] == "L" and f"R{name[1:]}" in BOXES:
        return [(size, np.array(centre) * MIRROR) for size, centre in BOXES[f"R{name[1:]}"]]
    return BOXES.get(name, [])


def test_thirty_joints_in_the_published_order(robot):
    assert [name for name, *_ in ROWS] == list(JOINTS)
    assert len(JOINTS) == 30
    assert sorted(robot.body.joint_names) == sorted(JOINTS)
    assert set(LINKS) == {"BODY"} | {name.replace("JOINT", "LINK") for name in JOINTS}
    for prefix, count in (("RLEG", 6), ("LLEG", 6), ("CHEST", 2), ("HEAD", 2), ("RARM", 7), ("LARM", 7)):
        own = [name for name in robot.body.joint_names if name.startswith(prefix)]
        assert own == [f"{prefix}_JOINT{index}" for index in range(count)]


@pytest.mark.parametrize(("name", "parent", "axis", "row"), ROWS, ids=[name for name, *_ in ROWS])
def test_joint_and_link_row_by_row(robot, pin_model, name, parent, axis, row):
    joint, limit = JOINTS[name], JOINTS[name].find("limit")
    link = LINKS[name.replace("JOINT", "LINK")]
    assert joint.get("type") == "revolute"
    assert joint.find("parent").get("link") == parent
    assert joint.find("child").get("link") == link.get("name")
    np.testing.assert_array_equal(vector(joint.find("axis")), AXES[axis])
    np.testing.assert_allclose(vector(joint.find("origin")), row[:3], atol=1e-12)
    assert joint.find("origin").get("rpy") is None
    degrees = np.degrees([float(limit.get("lower")), float(limit.get("upper"))])
    np.testing.assert_allclose(degrees, row[3:5], atol=1e-6)
    assert float(limit.get("velocity")) == row[5]
    assert float(limit.get("effort")) == row[6]
    inertial = link.find("inertial")
    assert float(inertial.find("mass").get("value")) == pytest.approx(row[7], abs=1e-12)
    np.testing.assert_allclose(vector(inertial.find("origin")), row[8:11], atol=1e-12)
    column = robot.body.column(name) - 7
    np.testing.assert_allclose(np.degrees([robot.body.lower[column], robot.body.upper[column]]), row[3:5], atol=1e-6)
    assert robot.body.speed_limits[column] == row[5]
    assert robot.body.effort_limits[column] == row[6]
    np.testing.assert_allclose(robot.body.axes[column], AXES[axis], atol=1e-12)
    assert pin_model.inertias[pin_model.getJointId(name)].mass == pytest.approx(row[7])


def test_root_row():
    inertial = LINKS["BODY"].find("inertial")
    assert float(inertial.find("mass").get("value")) == pytest.approx(BODY_MASS)
    np.testing.assert_allclose(vector(inertial.find("origin")), BODY_CENTRE)


@pytest.mark.parametrize("name", LINKS)
@pytest.mark.parametrize("tag", ["collision", "visual"])
def test_boxes_row_by_row(name, tag):
    expected, actual = expected_boxes(name), boxes_of(name, tag)
    assert len(actual) == len(expected)
    for (size, centre), (wanted_size, wanted_centre) in zip(actual, expected, strict=True):
        np.testing.assert_allclose(size, wanted_size, atol=1e-12)
        np.testing.assert_allclose(centre, wanted_centre, atol=1e-12)


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("part", PRISMS)
def test_shank_prisms_are_the_outline_extruded(robot, side, part):
    points = np.array([OUTLINE[name] for name in PRISMS[part]])
    lateral = (-0.125, 0.0) if side == "right" else (0.0, 0.125)
    expected = {(x, y, z) for x, z in points for y in lateral}
    lines = (HRP2 / f"shank_{side}_{part}.obj").read_text().splitlines()
    corners = [tuple(float(v) for v in line.split()[1:]) for line in lines if line.startswith("v ")]
    assert set(corners) == expected
    files = [mesh.get("filename") for mesh in LINKS[f"{side[0].upper()}LEG_LINK3"].iter("mesh")]
    assert files.count(f"shank_{side}_{part}.obj") == 2
    ours = [s for s in robot.shapes if s.link == f"{side[0].upper()}LEG_LINK3" and len(s.vertices) == len(expected)]
    assert len(ours) == 1
    assert {tuple(vertex) for vertex in ours[0].vertices.round(7) + 0.0} == expected
    for k in range(len(points)):  # convex: every corner lies on the same side of every edge
        (ax, az), (bx, bz) = points[k], points[(k + 1) % len(points)]
        turns = (bx - ax) * (points[:, 1] - az) - (bz - az) * (points[:, 0] - ax)
        assert turns.max() <= 1e-12


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("part", PRISMS)
def test_shank_meshes_are_closed_and_face_outwards(side, part):
    lines = (HRP2 / f"shank_{side}_{part}.obj").read_text().splitlines()
    corners = np.array([line.split()[1:] for line in lines if line.startswith("v ")], dtype=float)
    faces = [[int(index) - 1 for index in line.split()[1:]] for line in lines if line.startswith("f ")]
    edges = [(face[k - 1], face[k]) for face in faces for k in range(len(face))]
    assert len(edges) == len(set(edges))
    assert {(b, a) for a, b in edges} == set(edges)
    for face in faces:
        normal = np.cross(corners[face[1]] - corners[face[0]], corners[face[2]] - corners[face[1]])
        assert normal @ (corners[face].mean(axis=0) - corners.mean(axis=0)) > 0.0


def test_the_outline_of_robot_toml_is_that_of_the_shanks(robot):
    assert robot.outline.front == tuple(OUTLINE[name] for name in ("L1", "L2", "L3", "L4"))
    assert robot.outline.rear == tuple(OUTLINE[name] for name in ("L5", "L6", "L7"))
    angles = np.radians([60.0, 30.0, 0.0])
    np.testing.assert_allclose(robot.outline.front[:3], 0.118 * np.column_stack([np.cos(angles), np.sin(angles)]),
                               atol=5e-5)  # fmt: skip


def test_every_link_of_the_size_table_has_its_collision_shape(robot):
    counts = {name: len(expected_boxes(name)) + 2 * name.endswith("LEG_LINK3") for name in LINKS}
    assert {name: [s.link for s in robot.shapes].count(name) for name in LINKS} == counts
    for shape in robot.shapes:
        moved_by = 1 if shape.link == "BODY" else robot.body.index(shape.link.replace("LINK", "JOINT"))
        assert shape.joint == moved_by


@pytest.mark.parametrize("name", [name for name in LINKS if name[0] == "L"])
def test_left_mirrors_right(name):
    left, right = LINKS[name].find("inertial"), LINKS[f"R{name[1:]}"].find("inertial")
    np.testing.assert_allclose(vector(left.find("origin")), vector(right.find("origin")) * MIRROR)
    assert left.find("mass").get("value") == right.find("mass").get("value")
    assert left.find("inertia").attrib == right.find("inertia").attrib


@pytest.mark.parametrize("name", LINKS)
def test_inertias_are_possible(name):
    inertia = LINKS[name].find("inertial/inertia")
    assert all(float(inertia.get(key)) == 0.0 for key in ("ixy", "ixz", "iyz"))
    moments = sorted(float(inertia.get(key)) for key in ("ixx", "iyy", "izz"))
    assert moments[0] > 0.0
    assert moments[2] <= moments[0] + moments[1] + 1e-9


@pytest.mark.parametrize(
    ("name", "moments"),
    [("RLEG_LINK2", (0.026, 0.025, 0.0038)), ("RLEG_LINK3", (0.022, 0.0225, 0.0046)),
     ("RLEG_LINK5", (0.004, 0.0069, 0.0071)), ("CHEST_LINK1", (0.16, 0.137, 0.18))],
)  # fmt: skip
def test_published_inertias(name, moments):
    inertia = LINKS[name].find("inertial/inertia")
    assert tuple(float(inertia.get(key)) for key in ("ixx", "iyy", "izz")) == moments


@pytest.mark.parametrize("name", ["BODY", "RLEG_LINK0", "HEAD_LINK1", *[f"RARM_LINK{i}" for i in (1, 2, 3, 5)]])
def test_other_inertias_are_those_of_their_boxes(name):
    (size, _), mass = expected_boxes(name)[0], float(LINKS[name].find("inertial/mass").get("value"))
    square = np.square(size)
    inertia = LINKS[name].find("inertial/inertia")
    actual = [float(inertia.get(key)) for key in ("ixx", "iyy", "izz")]
    np.testing.assert_allclose(actual, mass / 12.0 * (square.sum() - square), rtol=1e-4)


def test_mass_and_its_distribution(robot):
    assert robot.body.mass == pytest.approx(58.0, abs=0.005)
    right, left = (robot.body.mass_beyond(joint) for joint in ("RLEG_JOINT0", "LLEG_JOINT0"))
    legs = right + left
    assert right == pytest.approx(8.092, abs=1e-9)
    assert 1.0 - legs / robot.body.mass == pytest.approx(0.721, abs=0.001)


def test_half_sitting(robot, pin_model):
    q = robot.half_sitting()
    height = 0.3 * np.cos(np.radians(26.0)) + 0.3 * np.cos(np.radians(24.0)) + 0.105
    assert q[2] == pytest.approx(height, abs=1e-5)
    assert robot.leg(1).length == pytest.approx(0.705)
    assert robot.leg(-1).length == pytest.approx(0.705)
    data = pin_model.createData()
    com = pin.centerOfMass(pin_model, data, q)
    assert com[2] == pytest.approx(0.81, abs=0.005)
    assert com[1] == pytest.approx(0.0, abs=0.003)
    pin.forwardKinematics(pin_model, data, q)
    for name, y in (("RLEG_JOINT5", -0.095), ("LLEG_JOINT5", 0.095)):
        ankle = data.oMi[pin_model.getJointId(name)]
        np.testing.assert_allclose(ankle.translation, [0.0, y, 0.105], atol=1e-5)
        np.testing.assert_allclose(ankle.rotation, np.eye(3), atol=1e-9)


def test_half_sitting_bends_what_it_says(robot):
    angles = dict(zip(robot.body.joint_names, np.degrees(robot.half_sitting()[7:]), strict=True))
    for side, outward in (("R", -1.0), ("L", 1.0)):
        assert [angles[f"{side}LEG_JOINT{k}"] for k in range(6)] == pytest.approx([0, 0, -26, 50, -24, 0])
        assert [angles[f"{side}ARM_JOINT{k}"] for k in range(4)] == pytest.approx([15, 10 * outward, 0, -30])
    assert all(angles[name] == 0.0 for name in angles if name[:3] in ("CHE", "HEA"))


def test_the_feet_lie_on_their_sides(robot):
    left, right = robot.contact_patch(1), robot.contact_patch(-1)
    np.testing.assert_allclose([*right.min(axis=0), *right.max(axis=0)], [-0.096, -0.079, 0.126, 0.059])
    np.testing.assert_allclose([*left.min(axis=0), *left.max(axis=0)], [-0.096, -0.059, 0.126, 0.079])
    for patch in (left, right):  # counter-clockwise
        edges = np.roll(patch, -1, axis=0) - patch
        ahead = np.roll(edges, -1, axis=0)
        assert (edges[:, 0] * ahead[:, 1] - edges[:, 1] * ahead[:, 0] > 0.0).all()
    for side in (1, -1):
        assert np.sign(robot.body.origin(robot.leg(side).joints[0])[1][1]) == side
        foot = [s for s in robot.shapes if s.joint == robot.body.index(robot.leg(side).joints[-1])]
        box = np.vstack([s.vertices for s in foot])
        assert box[:, 0].min() == pytest.approx(-robot.foot.heel)
        assert box[:, 0].max() == pytest.approx(robot.foot.toe)
        assert box[:, 2].min() == pytest.approx(-robot.foot.ankle_height)


def test_pinocchio_pybullet_and_meshcat_read_the_same_robot(robot, pin_model):
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body = pybullet.loadURDF(str(HRP2 / "hrp2.urdf"), physicsClientId=client)
        count = pybullet.getNumJoints(body, physicsClientId=client)
        masses = [pybullet.getDynamicsInfo(body, k, physicsClientId=client)[0] for k in range(-1, count)]
        names = [pybullet.getJointInfo(body, k, physicsClientId=client)[1].decode() for k in range(count)]
        shapes = sum(len(pybullet.getCollisionShapeData(body, k, physicsClientId=client)) for k in range(-1, count))
    finally:
        pybullet.disconnect(client)
    assert sorted(names) == sorted(robot.body.joint_names)
    assert min(masses) > 0.0
    assert sum(masses) == pytest.approx(pin.computeTotalMass(pin_model), abs=1e-6)
    assert sum(masses) == pytest.approx(robot.body.mass, abs=1e-6)
    assert shapes == len(robot.shapes)


@pytest.mark.filterwarnings("ignore:zmq.eventloop:DeprecationWarning")
def test_meshcat_shows_every_shape(pin_model):
    meshcat = importlib.import_module("meshcat")
    folder = str(HRP2)
    visual = pin.buildGeomFromUrdf(pin_model, f"{folder}/hrp2.urdf", pin.GeometryType.VISUAL, package_dirs=[folder])
    viewer = importlib.import_module("pinocchio.visualize").MeshcatVisualizer(pin_model, pin.GeometryModel(), visual)
    window = meshcat.Visualizer()
    try:
        viewer.initViewer(viewer=window)
        viewer.loadViewerModel()
        viewer.display(pin.neutral(pin_model))
        page = window.static_html()
    finally:
        window.window.server_proc.kill()
        window.window.server_proc.wait()
    assert len(visual.geometryObjects) == sum(len(list(link.iter("visual"))) for link in LINKS.values())
    sent = [base64.b64decode(part) for part in re.findall(r"base64,([A-Za-z0-9+/=]+)", page)]
    for item in visual.geometryObjects:
        assert any(b"set_object" in part and item.name.encode() in part for part in sent), item.name


def joint_places(table, above=()):
    """Every place in robot.toml that names joints: (keys, value with one of them replaced)."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from joint_places(value, (*above, key))
        elif isinstance(value, str) and value in JOINTS:
            yield (*above, key), "NO_JOINT"
        elif isinstance(value, list) and set(map(str, value)) <= set(JOINTS):
            yield (*above, key), [*value[:-1], "NO_JOINT"]
        elif key in JOINTS:
            yield (*above, "NO_JOINT"), value


def refusal(path):
    """The line with which a robot is refused."""
    with pytest.raises(InvalidInput) as caught:
        load_robot(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_joints_that_the_urdf_lacks_are_named(spoilt, robot_table):
    places = dict(joint_places(robot_table))
    assert len(places) >= 6
    for keys, value in places.items():
        assert "'NO_JOINT'" in refusal(spoilt({keys: value})), keys


def test_a_leg_that_is_no_chain_is_refused(spoilt, robot_table):
    joints = robot_table["legs"]["right"]
    for wrong in (joints[::-1], joints[:5], [*joints[:5], robot_table["legs"]["left"][5]], joints[1:] + joints[:1]):
        assert "must be the six joints of one chain" in refusal(spoilt({("legs", "right"): wrong}))


def test_legs_on_the_wrong_side_are_named(spoilt, robot_table):
    legs = robot_table["legs"]
    swapped = {("legs", "left"): legs["right"], ("legs", "right"): legs["left"]}
    assert "legs.left: 'RLEG_JOINT0' is not on the left side" in refusal(spoilt(swapped))
    assert "legs.right: 'LLEG_JOINT0' is not on the right side" in refusal(spoilt({("legs", "right"): legs["left"]}))


def test_a_knee_of_no_leg_is_named(spoilt):
    assert "legs.knee: 'RARM_JOINT3' is in neither leg" in refusal(spoilt({("legs", "knee"): ["RARM_JOINT3"]}))


@pytest.mark.parametrize("link", ["NO_LINK", "RLEG_LINK0"])
def test_a_root_that_is_not_the_root_is_refused(spoilt, link):
    message = refusal(spoilt({("root",): link}))
    assert repr(link) in message
    assert "BODY" in message


def test_an_unknown_robot_is_refused():
    message = refusal("hrp5")
    assert "'hrp5'" in message
    assert "hrp2" in message


def test_a_folder_with_a_robot_in_it_is_answered_with_the_path(spoilt):
    folder = spoilt({}).parent
    with pytest.raises(InvalidInput, match=f"such as {folder}/robot.toml"):
        load_robot(folder)


def test_missing_and_broken_files_are_refused(spoilt, tmp_path):
    assert "nowhere.toml" in refusal(tmp_path / "nowhere.toml")
    assert "other.urdf" in refusal(spoilt({("urdf",): "other.urdf"}))
    (tmp_path / "broken.urdf").write_text("<robot name='x'><link")
    assert "broken.urdf" in refusal(spoilt({("urdf",): str(tmp_path / "broken.urdf")}))
    for name, content in (("broken.toml", b"name = [1"), ("binary.toml", b"\xff\xfe\x00"), ("empty.toml", b"")):
        (tmp_path / name).write_bytes(content)
        assert name in refusal(tmp_path / name)
    assert "cannot be read" in refusal(tmp_path.with_suffix(".toml") / "robot.toml")


def test_a_urdf_with_a_joint_that_turns_on_and_on_is_refused(spoilt, tmp_path):
    urdf = (HRP2 / "hrp2.urdf").read_text().replace('"HEAD_JOINT1" type="revolute"', '"HEAD_JOINT1" type="continuous"')
    (tmp_path / "hrp2.urdf").write_text(urdf)
    for mesh in HRP2.glob("*.obj"):
        shutil.copy(mesh, tmp_path)
    assert "'HEAD_JOINT1'" in refusal(spoilt({("urdf",): "hrp2.urdf"}))


def test_a_urdf_whose_mesh_is_gone_is_refused(spoilt, tmp_path):
    (tmp_path / "hrp2.urdf").write_text((HRP2 / "hrp2.urdf").read_text())
    assert "shank_" in refusal(spoilt({("urdf",): "hrp2.urdf"}))


def test_a_robot_by_its_path_is_the_robot_by_its_name(robot):
    other = load_robot(HRP2 / "robot.toml")
    assert other.walk == robot.walk
    np.testing.assert_array_equal(other.half_sitting(), robot.half_sitting())


def test_data_is_found_in_a_checkout():
    assert (data_folder() / "hrp2" / "robot.toml").is_file()


def test_data_is_found_in_an_installed_package(tmp_path):
    package = tmp_path / "site" / "stepover"
    shutil.copytree(data_folder().parent / "stepover", package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(data_folder(), package / "data")
    code = "import json, stepover as s; print(json.dumps([s.__file__, str(s.load_robot('hrp2').urdf_path.parent)]))"
    found = subprocess.run(
        [sys.executable, "-c", code], env={"PYTHONPATH": str(package.parent)}, cwd=tmp_path,
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert json.loads(found.stdout) == [str(package / "__init__.py"), str(package / "data" / "hrp2")]


def test_our_kinematics_are_those_of_the_urdf(robot, pin_model):
    q = random_q(pin_model, 5, seed=1)
    placements, data = robot.body.placements(q), pin_model.createData()
    for k, sample in enumerate(q):
        pin.forwardKinematics(pin_model, data, sample)
        for name in robot.body.joint_names:
            place = data.oMi[pin_model.getJointId(name)]
            np.testing.assert_allclose(placements.positions[k, robot.body.index(name)], place.translation, atol=1e-12)
            np.testing.assert_allclose(placements.rotations[k, robot.body.index(name)], place.rotation, atol=1e-12)


def table_rows(first):
    """Cells of the rows of README's tables whose first cell matches."""
    for line in (HRP2 / "README.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("|") and (found := re.fullmatch(first, cells[0])):
            yield found.group(1), cells[1:]


def numbers(cell):
    """The numbers of a cell: 0, -0.035, -0.300 or -45..30."""
    return [float(part) for part in re.findall(r"-?\d+(?:\.\d+)?(?!\d*\.\d)", cell.replace("..", " "))]


def test_readme_says_of_each_joint_what_the_urdf_holds():
    ours = {name: (axis, row) for name, _, axis, row in ROWS if not name.startswith("L")}
    theirs = dict(table_rows(r"(\w+_JOINT\d), .*"))
    assert set(theirs) == set(ours)
    for name, (axis, *cells) in theirs.items():
        assert axis == ours[name][0]
        assert [value for cell in cells for value in numbers(cell)] == pytest.approx(ours[name][1].tolist()), name


def test_readme_says_of_each_shape_what_the_urdf_holds():
    rows = table_rows(r"(BODY|(?:RLEG|CHEST|HEAD|RARM)_LINK\d)(?:, .*)?")
    sizes = [(name, *map(numbers, cells)) for name, cells in rows if len(numbers(cells[1])) == 3]
    ours = [(name, *box) for name, boxes in BOXES.items() for box in boxes]
    assert len(sizes) == len(ours)
    for (name, size, centre), (our_name, our_size, our_centre) in zip(sizes, ours, strict=True):
        assert (name, tuple(size), tuple(centre)) == (our_name, our_size, our_centre)
    assert {name: tuple(numbers(cells[0])) for name, cells in table_rows(r"(L[1-7])")} == OUTLINE


def test_published_values_of_robot_toml_are_known_by_the_same_source(robot_table):
    """A parameter that the file gives although the default is HRP-2's is a published fact of the machine."""
    kept = {(section, key): mark for section, key, mark in marks() if section in PARAMETERS}
    assert set(kept) == {(table, key) for table in PARAMETERS for key in robot_table.get(table, {})}
    for (table, key), mark in kept.items():
        (field,) = (field for field in dataclasses.fields(PARAMETERS[table]) if field.name == key)
        assert mark == entry_of(field).source
        assert mark[0] in "PD"


def marks():
    """Section, key and mark of every line of robot.toml; a section's own mark holds for its lines without one."""
    section, common, lines = "", "", []
    for line in (HRP2 / "robot.toml").read_text().splitlines():
        if line.startswith("#") and lines:
            lines[-1] += f"\n{line}"  # the comment goes on
        elif line.strip():
            lines.append(line)
    for line in lines:
        mark = re.search(r"#.*\b([PDE](?: (?:S\d|\[13\]|[IVX]+(?:-[A-Z]\d?)?))*)\s*$", line, re.MULTILINE)
        if found := re.match(r"\[([\w.]+)\]", line):
            section, common = found.group(1), mark.group(1) if mark else ""
        elif section and "=" in line:
            yield section, line.split("=")[0].strip(), mark.group(1) if mark else common


def test_every_figure_of_robot_toml_has_its_mark():
    assert [f"{section}.{key}" for section, key, mark in marks() if not mark] == []
