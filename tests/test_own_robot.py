"""A robot of one's own: JVRC-1 from data/jvrc1/robot.toml alone, and what is refused of a URDF that will not do."""

from __future__ import annotations

import dataclasses
import re
import tomllib
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from conftest import HRP2, as_toml
from scipy.spatial import ConvexHull

from stepover import Infeasible, InvalidInput, Obstacle, load_robot, plan, simulate
from stepover.analysis.delta_ds import delta_ds_stepping_over
from stepover.locations import data_folder
from stepover.model.body import Body
from stepover.model.description.urdf_text import urdf_text
from stepover.planning.algorithm_1.feasibility import key_configurations
from stepover.robots.files import find_file
from stepover.robots.urdf import read_urdf
from stepover.simulation.pybullet.client import load_body, pybullet, silenced

JVRC1 = data_folder() / "jvrc1"
needs_jvrc1 = pytest.mark.skipif(
    find_spec("jvrc_description") is None, reason="jvrc_description is not installed (pip install jvrc_description)"
)
OBSTACLE = Obstacle(height=0.18, width=0.05)
"""21 % of the leg."""

BODY = '<inertial><origin xyz="{xyz}" rpy="{rpy}"/><mass value="{mass}"/>'
BODY += '<inertia ixx="0.3" iyy="0.2" izz="0.15" ixy="0.01" ixz="-0.02" iyz="0.03"/></inertial>'
FIXED = f"""<robot name="r"><link name="base"/><link name="a">{BODY.format(xyz="0.1 0 0.2", rpy="0 0 0", mass=3)}</link>
<link name="b">{BODY.format(xyz="0 0.1 0", rpy="0.3 -0.2 0.5", mass=2)}</link><link name="frame"/>
<link name="c">{BODY.format(xyz="0 0 0.1", rpy="0 0 0", mass=1)}</link>
<joint name="deep" type="fixed"><parent link="b"/><child link="frame"/><origin xyz="0.1 0.2 0.3" rpy="0.1 0 0"/></joint>
<joint name="one" type="fixed"><parent link="base"/><child link="a"/><origin xyz="0 0 0.1" rpy="0.5 0.1 -0.3"/></joint>
<joint name="two" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0.2 0 0" rpy="0 0.7 0"/></joint>
<joint name="turn" type="revolute"><parent link="frame"/><child link="c"/><origin xyz="0 0.1 0" rpy="0 0 0.4"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"""


@pytest.fixture(scope="module")
def jvrc1():
    """JVRC-1."""
    return load_robot("jvrc1")


@pytest.fixture(scope="module")
def crossing(jvrc1):
    """It steps over 18 cm."""
    return plan(jvrc1, OBSTACLE)


def shapes_under(robot, joint):
    """Corners (V, 3) of what a joint moves, in its frame."""
    return np.vstack([shape.vertices for shape in robot.shapes if shape.joint == robot.body.index(joint)])


def same_dynamics(text, whole):
    """Compare a URDF's text with pinocchio's own reading of another, link by link."""
    ours = pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
    assert list(ours.names) == list(whole.names)
    for mine, theirs in zip(ours.inertias, whole.inertias, strict=True):
        assert mine.mass == pytest.approx(theirs.mass, abs=1e-12)
        np.testing.assert_allclose(mine.lever, theirs.lever, atol=1e-12)
        np.testing.assert_allclose(mine.inertia, theirs.inertia, atol=1e-12)
    for mine, theirs in zip(ours.jointPlacements, whole.jointPlacements, strict=True):
        np.testing.assert_allclose(mine.homogeneous, theirs.homogeneous, atol=1e-12)


@needs_jvrc1
def test_it_crosses_21_percent_of_its_leg(jvrc1, crossing):
    run = simulate(crossing)
    assert OBSTACLE.height / jvrc1.leg(1).length == pytest.approx(0.21, abs=0.001)
    assert run.crossed, run.explanation
    assert run.clearance_min >= 0.025
    assert run.speed_ratio_max < 1.0


@needs_jvrc1
def test_it_weighs_in_pybullet_what_it_weighs(jvrc1):
    assert jvrc1.body.mass == pytest.approx(62.4)
    with silenced():
        client = pybullet.connect(pybullet.DIRECT)
    try:
        with silenced():
            body = load_body(jvrc1.description, client)
        links = range(-1, pybullet.getNumJoints(body, client))
        names = ["", *(pybullet.getJointInfo(body, link, client)[1].decode() for link in links[1:])]
        masses = [pybullet.getDynamicsInfo(body, link, client)[0] for link in links]
        assert sum(masses) == pytest.approx(62.4)
        assert len(masses) == 1 + len(jvrc1.body.joint_names)
        boxes = {name: pybullet.getAABB(body, link, client) for name, link in zip(names, links, strict=True)}
    finally:
        pybullet.disconnect(client)
    placed = jvrc1.body.placements(pin.neutral(jvrc1.body.model)[None])
    for shape in jvrc1.shapes:  # PyBullet's boxes have a margin around them
        corners = shape.vertices @ placed.rotations[0, shape.joint].T + placed.positions[0, shape.joint]
        low, high = boxes["" if shape.joint == 1 else jvrc1.body.joint_names[shape.joint - 2]]
        np.testing.assert_allclose(low, corners.min(axis=0), atol=0.006)
        np.testing.assert_allclose(high, corners.max(axis=0), atol=0.006)


def test_links_whose_names_hardly_differ_keep_their_own_meshes(robot):
    """HRP-2's shanks, both of meshes, with names that are one where only letters and digits count."""
    links = {"RLEG_LINK3": "shank.1", "LLEG_LINK3": "shank_1"}
    renamed = tuple(dataclasses.replace(link, name=links.get(link.name, link.name)) for link in robot.description.links)
    joints = tuple(
        dataclasses.replace(
            joint, parent=links.get(joint.parent, joint.parent), child=links.get(joint.child, joint.child)
        )
        for joint in robot.description.joints
    )
    boxes = []
    for description in (robot.description, dataclasses.replace(robot.description, links=renamed, joints=joints)):
        with silenced():
            client = pybullet.connect(pybullet.DIRECT)
            body = load_body(description, client)
        boxes.append([pybullet.getAABB(body, k, client) for k in range(pybullet.getNumJoints(body, client))])
        pybullet.disconnect(client)
    np.testing.assert_array_equal(*boxes)


@needs_jvrc1
def test_merged_it_moves_as_pinocchio_says(jvrc1):
    model = pin.buildModelFromUrdf(str(jvrc1.urdf_path), pin.JointModelFreeFlyer())
    same_dynamics(urdf_text(jvrc1.description), model)


@pytest.fixture
def fixed(tmp_path):
    """The path of a URDF with links on fixed joints."""
    path = tmp_path / "fixed.urdf"
    path.write_text(FIXED)
    return path


def test_fixed_parts_are_merged_as_pinocchio_does_it(fixed):
    description, _ = read_urdf(fixed)
    assert [link.name for link in description.links] == ["base", "c"]
    same_dynamics(urdf_text(description), pin.buildModelFromXML(FIXED, pin.JointModelFreeFlyer()))


def test_a_moving_link_without_mass_is_named(fixed):
    fixed.write_text(re.sub(r'<link name="c">.*?</link>', '<link name="c"/>', FIXED))
    with pytest.raises(InvalidInput, match=r"'c'.* has no mass"):
        read_urdf(fixed)


@needs_jvrc1
def test_the_foot_is_the_meshs(jvrc1):
    for side in (1, -1):
        foot = shapes_under(jvrc1, jvrc1.leg(side).joints[-1])
        low, high = foot.min(axis=0), foot.max(axis=0)
        expected = [-jvrc1.foot.heel, jvrc1.foot.toe, -jvrc1.foot.ankle_height]
        np.testing.assert_allclose([low[0], high[0], low[2]], expected, atol=1e-4)
        assert jvrc1.foot.sole_length == pytest.approx(high[0] - low[0], abs=1e-4)
        ground = ConvexHull(foot[foot[:, 2] < low[2] + 0.002][:, :2])
        edges = ground.equations[:, :2] @ jvrc1.contact_patch(side).T + ground.equations[:, 2:]
        assert edges.max() <= 1e-6, "the patch reaches beyond what touches the floor"


@needs_jvrc1
def test_the_outline_is_the_shanks_hull(jvrc1):
    for knee in jvrc1.legs.knee:
        outline = np.array([*jvrc1.outline.front, *jvrc1.outline.rear])
        shank = shapes_under(jvrc1, knee)[:, [0, 2]]
        corners = shank[ConvexHull(shank).vertices]
        away = np.linalg.norm(outline[:, None] - corners[None], axis=2)
        assert away.min(axis=0).max() < 2e-4, "a corner of the hull is missing"
        assert away.min(axis=1).max() < 1e-4, "a point of the outline is no corner of the hull"
        assert outline[0, 1] > outline[len(jvrc1.outline.front) - 1, 1] < outline[-1, 1]


@needs_jvrc1
def test_derived_figures_are_those_of_the_model(jvrc1):
    placed = jvrc1.body.placements(jvrc1.half_sitting()[None])
    assert jvrc1.preview.com_height == pytest.approx(jvrc1.body.com(placed)[0, 2], abs=5e-4)
    assert jvrc1.posture.feet_apart == pytest.approx(2.0 * jvrc1.body.origin("L_HIP_P")[1][1])
    straight = np.degrees(jvrc1.leg(1).meeting_axes.straight)
    assert jvrc1.checks.knee_margin_deg - straight == pytest.approx(5.0, abs=0.1)
    assert jvrc1.feasibility.knee_margin_deg - straight == pytest.approx(15.0, abs=0.1)


@needs_jvrc1
def test_delta_ds_is_measured(jvrc1, crossing):
    measured = delta_ds_stepping_over(jvrc1, OBSTACLE, float(crossing.key_configuration[0])).waist
    assert jvrc1.feasibility.delta_ds == pytest.approx(measured, abs=0.012)


def test_every_figure_of_jvrc1_has_its_mark():
    text = (JVRC1 / "robot.toml").read_text()
    mark = r"\s[PDE]( (H|S\d|\[13\]|[IVX]+(-[A-Z]\d?)?))*$"
    section, common = "", False
    for entry in re.split(r"\n(?=\w+ = |\[[a-z])", text):
        marked = any(re.search(mark, line) for line in entry.splitlines())
        if entry.startswith("["):
            section, common = entry.splitlines()[0], marked
        elif section:
            assert marked or common, f"{section} {entry}"


@needs_jvrc1
def test_jvrc1_moves_no_slower_where_speed_limits_are_kept(jvrc1):
    assert jvrc1.slow == {}
    assert jvrc1.slowed.walk is jvrc1.walk


@pytest.mark.parametrize("name", ["hrp2", "jvrc1"])
def test_a_file_has_60_values_at_most(name):
    lines = (data_folder() / name / "robot.toml").read_text().splitlines()
    values = [line for line in lines if line.strip() and line.lstrip()[0] not in "#["]
    assert 20 < len(values) <= 60


def test_the_library_knows_no_robot_by_its_joints():
    for path in Path(load_robot.__code__.co_filename).parents[1].rglob("*.py"):
        assert "jvrc" not in path.read_text().lower(), path


def changed(tmp_path, **changes):
    """Load HRP-2 with another URDF text: each change is what to replace, and what by."""
    text = (HRP2 / "hrp2.urdf").read_text().replace('filename="', f'filename="{HRP2}/')
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "own.urdf").write_text(text)
    table = tomllib.loads((HRP2 / "robot.toml").read_text()) | {"urdf": "own.urdf"}
    (tmp_path / "robot.toml").write_text(as_toml(table))
    return load_robot(tmp_path / "robot.toml")


def test_a_package_that_is_not_installed_is_named():
    with pytest.raises(InvalidInput, match="looked for the package 'no_such_description' in the folders above"):
        find_file("package://no_such_description/urdf/x.urdf", HRP2)


def test_meshes_of_a_package_are_found_above_the_urdf(tmp_path):
    mesh = tmp_path / "thing_description" / "meshes" / "a.obj"
    mesh.parent.mkdir(parents=True)
    mesh.write_text("")
    urdf = tmp_path / "thing_description" / "urdf" / "thing.urdf"
    assert find_file("package://thing_description/meshes/a.obj", urdf.parent) == mesh
    with pytest.raises(
        InvalidInput, match=r"b\.obj' is not found: looked for the package 'thing_description' in the folders above"
    ):
        find_file("package://thing_description/meshes/b.obj", urdf.parent)


def test_a_mirrored_mesh_is_mirrored_once(tmp_path):
    whole = changed(tmp_path)
    mirrored = changed(tmp_path, scale=('shank_left_calf.obj"', 'shank_left_calf.obj" scale="-2 1 1"'))
    calf, other = (shapes_under(robot, "LLEG_JOINT3") for robot in (whole, mirrored))
    calf, other = (corners[corners[:, 2] < -0.2] for corners in (calf, other))
    assert other[:, 0].min() == pytest.approx(-2.0 * calf[:, 0].max())
    assert other[:, 0].max() == pytest.approx(-2.0 * calf[:, 0].min())


def test_a_joint_that_the_urdf_lacks_is_named(tmp_path):
    with pytest.raises(InvalidInput, match="has no joint 'RLEG_JOINT5'"):
        changed(tmp_path, joint=('"RLEG_JOINT5"', '"other_name"'))


@pytest.mark.parametrize("kind", ["continuous", "prismatic", "floating"])
def test_joints_of_other_kinds_are_named(tmp_path, kind):
    with pytest.raises(InvalidInput, match=r"'HEAD_JOINT1': its type is .*; only revolute joints with limits"):
        changed(tmp_path, kind=('name="HEAD_JOINT1" type="revolute"', f'name="HEAD_JOINT1" type="{kind}"'))


def test_a_joint_without_limits_is_named(tmp_path):
    urdf = (HRP2 / "hrp2.urdf").read_text()
    limit = re.search(r'name="HEAD_JOINT1".*?(<limit[^>]*>)', urdf, re.DOTALL).group(1)
    lower, upper = (re.search(rf'{key}="[^"]*"', limit).group(0) for key in ("lower", "upper"))
    bad = limit.replace(lower, 'lower="0"').replace(upper, 'upper="0"')
    (tmp_path / "own.urdf").write_text(urdf.replace('filename="', f'filename="{HRP2}/').replace(limit, bad))
    with pytest.raises(InvalidInput, match=r"'HEAD_JOINT1': its range is 0 to 0; lower must be less than upper"):
        Body(read_urdf(tmp_path / "own.urdf")[0])


def coupled(tmp_path, joint, leader, factor=-2.0):
    """HRP-2 with a joint that mimics another one."""
    name = f'name="{joint}" type="revolute">'
    mimic = f'<mimic joint="{leader}" multiplier="{factor}" offset="0.1"/>'
    return changed(tmp_path, mimic=(name, f"{name}{mimic}"))


def test_a_coupled_joint_follows_its_leader(tmp_path):
    own = coupled(tmp_path, "RARM_JOINT4", "RARM_JOINT3")
    leader, follower = (own.half_sitting()[own.body.column(f"RARM_JOINT{k}")] for k in (3, 4))
    assert leader == pytest.approx(np.radians(-30.0))
    assert follower == pytest.approx(0.1 - 2.0 * leader)


@pytest.mark.parametrize(("joint", "leader"), [("RLEG_JOINT4", "RLEG_JOINT3"), ("RARM_JOINT4", "RARM_JOINT0")])
def test_joints_that_the_planner_moves_must_not_be_coupled(tmp_path, joint, leader):
    with pytest.raises(InvalidInput, match=f"'{joint}' mimics '{leader}'"):
        coupled(tmp_path, joint, leader)


def test_a_half_sitting_in_which_links_overlap_is_refused(spoilt):
    with pytest.raises(InvalidInput, match=r"in half-sitting LARM_LINK\d and LLEG_LINK\d overlap by \d+\.\d mm"):
        load_robot(spoilt({("posture", "angles_deg", "LARM_JOINT1"): -9.0}))


def test_a_foot_that_reaches_below_its_sole_is_refused(tmp_path):
    box = '<collision><origin xyz="0.015 0.01 -0.09"/>'
    with pytest.raises(InvalidInput, match=r"a collision shape of LLEG_LINK5 reaches 10\.0 mm below the sole"):
        changed(tmp_path, box=(box, box.replace("-0.09", "-0.10")))


def test_a_half_sitting_that_breaks_a_coupling_is_refused(tmp_path):
    with pytest.raises(InvalidInput, match=r"'RARM_JOINT3' mimics 'RARM_JOINT4': .* must be 5\.7 degrees, not -30\.0"):
        coupled(tmp_path, "RARM_JOINT3", "RARM_JOINT4")


def test_a_sole_that_is_not_flat_or_not_on_the_floor_is_named(spoilt):
    with pytest.raises(InvalidInput, match=r"'LLEG_JOINT5' is turned by 4\.0 degrees"):
        load_robot(spoilt({("posture", "angles_deg", "LLEG_JOINT4"): -20.0}))
    with pytest.raises(InvalidInput, match=r"is at z = 21\.3 mm; check waist_height.* waist_height of 0\.6487"):
        load_robot(spoilt({("posture", "waist_height"): 0.67}))


@pytest.mark.parametrize(
    ("where", "value", "message"),
    [
        (("posture", "angles_deg", "HEAD_JOINT1"), -31.0, r"'HEAD_JOINT1' stands at -31\.0 degrees.*-30\.0 to 45\.0"),
        (("foot", "contact_x"), [-96.0, 126.0], r"contact_x = -96\.0 must be 10 m at most"),
        (("foot", "contact_x"), [-0.96, 0.126], r"contact_x = \[-0\.96, 0\.126\] must lie between heel and toe, in m"),
        (("foot", "contact_x"), [0.01, 0.126], r"contact_x = \[0\.01, 0\.126\] must reach from behind the ankle"),
        (("posture", "feet_apart"), 0.3, r"feet_apart = 0\.3 is far from 0\.19 m, which follows from the URDF"),
        (("legs", "knee"), ["RLEG_JOINT2", "LLEG_JOINT3"], "'RLEG_JOINT2' is no knee: .*'RLEG_JOINT3', 'LLEG_JOINT3'"),
        (("upper_body", "shoulders"), [], "must be a list of one value or more"),
    ],
)
def test_what_no_robot_can_be_is_named(spoilt, where, value, message):
    with pytest.raises(InvalidInput, match=message):
        load_robot(spoilt({where: value}))


def test_the_joint_that_forbids_every_key_configuration_is_named(spoilt):
    turned = load_robot(spoilt({("feasibility", "waist_yaw_deg"): 50.0}))
    with pytest.raises(Infeasible, match=r"[LR]LEG_JOINT0 is \d+\.\d degrees past its limit"):
        key_configurations(turned, Obstacle(0.05, 0.05))
