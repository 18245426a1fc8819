"""robots/urdf.py: one reading of a URDF, held against pinocchio's own, and what it refuses, each in one line."""

from __future__ import annotations

import locale
import os
import shutil

import numpy as np
import pinocchio as pin
import pytest

from stepover import InvalidInput
from stepover.locations import data_folder
from stepover.model.description.links import MESH
from stepover.model.description.urdf_text import urdf_text
from stepover.robots import urdf as module
from stepover.robots.files import find_file
from stepover.robots.meshes import corners_of_mesh
from stepover.robots.urdf import read_urdf

HRP2 = data_folder() / "hrp2"
TEXT = (HRP2 / "hrp2.urdf").read_text()
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


@pytest.fixture
def folder(tmp_path):
    """A folder with HRP-2's URDF and meshes."""
    for path in HRP2.iterdir():
        shutil.copy(path, tmp_path)
    return tmp_path


def changed(folder, *pairs, encoding="utf-8"):
    """HRP-2's URDF in the folder, with texts replaced once each."""
    text = TEXT
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "hrp2.urdf"
    path.write_bytes(text.encode(encoding))
    return path


def refused(path, *words):
    """The one line of a refusal, which names the file and some words."""
    with pytest.raises(InvalidInput) as error:
        read_urdf(path)
    line = str(error.value)
    assert "\n" not in line
    for word in (path.name, *words):
        assert word in line, line
    return line


def same_models(one, other, atol):
    """Whether two of pinocchio's models are the same robot."""
    assert list(one.names) == list(other.names)
    for a, b in zip(one.inertias, other.inertias, strict=True):
        assert a.mass == pytest.approx(b.mass, abs=atol)
        np.testing.assert_allclose(a.lever, b.lever, atol=atol)
        np.testing.assert_allclose(a.inertia, b.inertia, atol=atol)
    for a, b in zip(one.jointPlacements, other.jointPlacements, strict=True):
        np.testing.assert_allclose(a.homogeneous, b.homogeneous, atol=atol)
    for limits in ("lowerPositionLimit", "upperPositionLimit", "velocityLimit", "effortLimit"):
        np.testing.assert_array_equal(getattr(one, limits), getattr(other, limits))


def model(path):
    """Pinocchio's model of what we read."""
    return pin.buildModelFromXML(urdf_text(read_urdf(path)[0]), pin.JointModelFreeFlyer())


class TestAgainstPinocchio:
    def test_hrp2_to_the_bit(self):
        same_models(
            model(HRP2 / "hrp2.urdf"), pin.buildModelFromUrdf(str(HRP2 / "hrp2.urdf"), pin.JointModelFreeFlyer()), 0
        )

    def test_a_robot_with_many_fixed_joints(self):
        path = find_file("package://jvrc_description/urdf/jvrc1.urdf", HRP2)
        assert 'type="fixed"' in path.read_text()
        same_models(model(path), pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer()), 1e-12)

    @pytest.mark.parametrize("seed", range(5))
    def test_random_trees(self, tmp_path, seed):
        path = tmp_path / "random.urdf"
        path.write_text(random_tree(np.random.default_rng(seed)))
        same_models(model(path), pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer()), 1e-9)


def random_tree(random):
    """A URDF of nine links in chains and branches, every third joint fixed, everything turned."""
    parts = []
    for k in range(9):
        xyz, rpy, com, turn = (" ".join(f"{x:.6f}" for x in random.uniform(-1.0, 1.0, 3)) for _ in range(4))
        a, b, c = random.uniform(0.1, 0.15, 3)
        parts.append(
            f'<link name="l{k}"><inertial><origin xyz="{com}" rpy="{turn}"/>'
            f'<mass value="{random.uniform(1.0, 3.0):.5f}"/>'
            f'<inertia ixx="{a:.5f}" iyy="{b:.5f}" izz="{c:.5f}" ixy="0.01" ixz="-0.01" iyz="0.005"/></inertial></link>'
        )
        if k:
            kind = "fixed" if k % 3 == 0 else "revolute"
            parts.append(
                f'<joint name="j{k}" type="{kind}"><parent link="l{random.integers(k)}"/><child link="l{k}"/>'
                f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 1 0"/>'
                '<limit lower="-1" upper="1" velocity="2" effort="3"/></joint>'
            )
    return f'<robot name="random">{"".join(parts)}</robot>'


class TestNumbers:
    @pytest.mark.parametrize(
        ("value", "words"),
        [("0,806", ("finite number", "point")), ("nan", ("finite",)), ("inf", ("finite",)), ("1e400", ("finite",)),
         ("-0.806", ("zero or positive",)), ("", ("no value",)), ("0x10", ("finite",)), ("8_06", ("finite",)),
         ("1e6", ("at most",))],
    )  # fmt: skip
    def test_a_mass(self, folder, value, words):
        refused(changed(folder, ('value="0.806"', f'value="{value}"')), "RLEG_LINK1", *words)

    def test_a_mass_of_a_link_without_shapes_is_missing(self, folder):
        refused(changed(folder, ('<mass value="0.806"/>', "")), "RLEG_LINK1", "<mass>")

    @pytest.mark.parametrize("ixx", ["-0.000806", "0", "0.1", "900"])
    def test_an_impossible_inertia(self, folder, ixx):
        refused(changed(folder, ('ixx="0.000806"', f'ixx="{ixx}"')), "RLEG_LINK1", "kg m^2")

    def test_axes_are_normalised_once(self, folder):
        path = changed(folder, ('<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>'))
        description, findings = read_urdf(path)
        assert all(abs(np.linalg.norm(joint.axis) - 1.0) < 1e-15 for joint in description.joints)
        assert [finding.severity for finding in findings.found] == ["note"]
        assert "length 2" in str(findings.found[0])
        same_models(model(path), model(HRP2 / "hrp2.urdf"), 0)

    @pytest.mark.parametrize("axis", ["0 0 0", "0 1", "0 nan 0"])
    def test_an_axis_that_is_none(self, folder, axis):
        refused(changed(folder, ('<axis xyz="0 1 0"/>', f'<axis xyz="{axis}"/>')), "axis")

    def test_all_errors_are_counted(self, folder):
        line = refused(changed(folder, ('value="0.806"', 'value="x"'), ('value="2.076"', 'value="y"')), "RLEG_LINK1")
        assert "(and 1 more)" in line

    def test_the_text_does_not_depend_on_the_locale(self):
        try:
            locale.setlocale(locale.LC_NUMERIC, "de_DE.UTF-8")
        except locale.Error:
            pytest.skip("no locale with a comma is installed")
        try:
            text = urdf_text(read_urdf(HRP2 / "hrp2.urdf")[0])
            assert "0.806" in text
            assert "0,806" not in text
        finally:
            locale.setlocale(locale.LC_NUMERIC, "C")


class TestJoints:
    @pytest.mark.parametrize("kind", ["continuous", "prismatic", "floating", "planar", "hinge"])
    def test_other_kinds(self, folder, kind):
        refused(changed(folder, ('type="revolute"', f'type="{kind}"')), "RLEG_JOINT0", kind, "revolute")

    @pytest.mark.parametrize(
        ("old", "new", "word"),
        [("<limit", "<limits", "no <limit>"), ('effort="', 'effort="-', "positive"),
         ('velocity="', 'velocity="-', "positive"), ('<parent link="BODY"/>', "", "no <parent>"),
         ('<parent link="BODY"/>', '<parent link="BODI"/>', "no link 'BODI'")],
    )  # fmt: skip
    def test_what_is_missing_or_wrong(self, folder, old, new, word):
        refused(changed(folder, (old, new)), "RLEG_JOINT0", word)

    def test_a_name_twice(self, folder):
        refused(changed(folder, ('joint name="RLEG_JOINT1"', 'joint name="RLEG_JOINT0"')), "RLEG_JOINT0", "2 times")
        refused(changed(folder, ('link name="RLEG_LINK1"', 'link name="RLEG_LINK0"')), "RLEG_LINK0", "2 times")

    def test_two_roots_and_a_circle(self, folder):
        refused(changed(folder, ("</robot>", '<link name="LOOSE"/></robot>')), "one root", "LOOSE")
        refused(changed(folder, ('<parent link="BODY"/>', '<parent link="RLEG_LINK5"/>')), "RLEG_LINK0")

    def test_a_moving_link_without_mass(self, folder):
        inertial = TEXT[TEXT.index('<link name="RLEG_LINK1">') : TEXT.index('<link name="RLEG_LINK2">')]
        refused(changed(folder, (inertial, '<link name="RLEG_LINK1"/>')), "RLEG_LINK1", "no mass")

    def test_a_coupled_joint_is_known(self, folder):
        path = changed(
            folder, ('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><mimic joint="LLEG_JOINT3" multiplier="-1"/>')
        )
        joints = read_urdf(path)[0].joints
        assert [joint.mimic for joint in joints if joint.mimic] == [("LLEG_JOINT3", -1.0, 0.0)]
        refused(changed(folder, ("<axis", '<mimic joint="NONE"/><axis')), "NONE", "no such joint")


class TestDocuments:
    @pytest.mark.parametrize(
        ("text", "words"),
        [("", ("XML",)), ("<robot", ("XML",)), (TEXT + "<x/>", ("XML",)), ("<sdf/>", ("<sdf>", "not a URDF")),
         ('<?xml version="1.0" encoding="utf-99"?><robot/>', ("XML",)),
         ('<!DOCTYPE r [<!ENTITY a "b">]><robot name="&a;"/>', ("document type",)),
         ('<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot/>', ("document type",)),
         ('<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="x"/></robot>', ("xacro",)),
         ("<robot>&undefined;</robot>", ("XML",)), ('<robot name="r"/>', ("one root",))],
    )  # fmt: skip
    def test_what_is_none(self, tmp_path, text, words):
        path = tmp_path / "robot.urdf"
        path.write_text(text)
        refused(path, *words)

    def test_latin_1(self, folder):
        refused(changed(folder, ("primitive shapes", "Körper"), encoding="latin-1"), "UTF-8")

    def test_a_byte_order_mark(self, folder):
        assert read_urdf(changed(folder, encoding="utf-8-sig"))[0].mass == pytest.approx(58.0, abs=0.01)

    def test_no_file_a_folder_a_fifo_and_a_device(self, tmp_path):
        refused(tmp_path / "none.urdf", "No such file")
        (tmp_path / "folder.urdf").mkdir()
        refused(tmp_path / "folder.urdf", "regular")
        os.mkfifo(tmp_path / "fifo.urdf")
        refused(tmp_path / "fifo.urdf", "regular")
        (tmp_path / "zero.urdf").symlink_to("/dev/zero")
        refused(tmp_path / "zero.urdf", "regular")

    def test_a_huge_file(self, folder, monkeypatch):
        monkeypatch.setattr(module, "MOST_BYTES", 1000)
        refused(changed(folder), "19,507 bytes; 1,000 are read at most")


class TestShapes:
    @pytest.mark.parametrize(
        ("shape", "word"),
        [('<capsule radius="0.1" length="0.2"/>', "capsule"), ('<box size="0 1 1"/>', "positive"), ("", "no shape"),
         ('<sphere radius="0"/>', "positive"), ('<cylinder radius="0.1"/>', "length"),
         ('<mesh filename="none.obj"/>', "none.obj"),
         ('<box size="1 1"/>', "3 numbers")],
    )  # fmt: skip
    def test_what_is_none(self, folder, shape, word):
        old = '<collision><origin xyz="-0.025 0 0.215"/><geometry><box size="0.29 0.32 0.22"/></geometry>'
        new = f'<collision><origin xyz="-0.025 0 0.215"/><geometry>{shape}</geometry>'
        refused(changed(folder, (old, new)), "BODY", word)

    @pytest.mark.parametrize(
        ("name", "content", "word"),
        [("m.stl", b"", "mesh"), ("m.stl", b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "Git LFS"),
         ("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "flat"), ("m.stl", bytes(range(1, 256)) * 4, "mesh")],
    )  # fmt: skip
    def test_a_mesh_that_is_none(self, folder, name, content, word):
        (folder / name).write_bytes(content)
        path = changed(folder, *[('<collision><origin xyz="0 0 0"/><geometry><mesh filename="shank_right_knee.obj"',
                                  f'<collision><origin xyz="0 0 0"/><geometry><mesh filename="{name}"')])  # fmt: skip
        refused(path, "RLEG_LINK3", word)

    @pytest.mark.parametrize("name", ["none.stl", "shape.glb"])
    def test_visuals_are_not_read(self, folder, name):
        path = changed(folder, ('<mesh filename="shank_right_knee.obj"', f'<mesh filename="{name}"'))
        description, findings = read_urdf(path)
        assert len(description.link_by_name["RLEG_LINK3"].solids) == 2
        assert findings.found == []

    def test_the_unit_of_a_collada_file(self, tmp_path):
        sizes = []
        for unit in ("1", "0.001"):
            path = tmp_path / f"{unit}.dae"
            path.write_text(collada(unit))
            sizes.append(np.ptp(corners_of_mesh(path), axis=0))
        np.testing.assert_allclose(sizes[1], sizes[0] / 1000.0)
        np.testing.assert_allclose(sizes[0], 1.0)


class TestResolver:
    @pytest.fixture
    def package(self, tmp_path):
        """A clone of the package `robot_description` in a folder of another name, with a mesh."""
        clone = tmp_path / "robot_description-master"
        (clone / "meshes").mkdir(parents=True)
        (clone / "package.xml").write_text("<package><name>robot_description</name></package>")
        (clone / "meshes" / "m.obj").write_text(TETRAHEDRON)
        return clone

    NAME = "package://robot_description/meshes/m.obj"

    def test_by_the_name_in_package_xml(self, package):
        assert find_file(self.NAME, package / "urdf") == package / "meshes" / "m.obj"

    def test_by_the_folder(self, package):
        package = package.rename(package.parent / "robot_description")
        assert find_file(self.NAME, package / "urdf") == package / "meshes" / "m.obj"

    def test_by_the_ros_package_path(self, package, tmp_path_factory, monkeypatch):
        elsewhere = tmp_path_factory.mktemp("elsewhere") / "r.urdf"
        with pytest.raises(InvalidInput, match="ROS_PACKAGE_PATH"):
            find_file(self.NAME, elsewhere.parent)
        monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{package.parent}")
        assert find_file(self.NAME, elsewhere.parent) == package / "meshes" / "m.obj"

    def test_in_a_python_package(self, tmp_path):
        found = find_file("package://jvrc_description/meshes/R_KNEE_S.dae", tmp_path)
        assert found.is_file()

    def test_a_file_address(self, package):
        path = package / "meshes" / "m.obj"
        assert find_file(f"file://{path}", package) == path


def test_meshes_are_read_as_they_are_written():
    solids = read_urdf(HRP2 / "hrp2.urdf")[0].link_by_name["RLEG_LINK3"].solids
    assert [solid.kind for solid in solids] == [MESH, MESH]
    lines = [line.split()[1:] for line in (HRP2 / "shank_right_knee.obj").read_text().splitlines() if line[:2] == "v "]
    written = np.unique(np.array(lines, dtype=float), axis=0)
    np.testing.assert_allclose(np.unique(solids[0].corners, axis=0), written)


def collada(unit):
    """A tetrahedron as a COLLADA file in some unit [m]."""
    return f"""<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="x" meter="{unit}"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION"
source="#p"/></vertices><triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
