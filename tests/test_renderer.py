"""The software renderer: places against formulas, near before far, smooth edges, floor, shadow, veil."""

import numpy as np
import pytest

from stepover.errors import InvalidInput
from stepover.model.kinematics import Placements
from stepover.report.render import ground, picture
from stepover.report.render.camera import LENS, Camera, Size, checked
from stepover.report.render.mesh import Mesh
from stepover.report.render.picture import draw
from stepover.report.render.raster import Window, covered, nearest, seen, triangle_of
from stepover.report.scene import Solid

SIZE = Size(320, 240)
WHOLE = Window(0, 0, 40, 30)
SIGNS = np.array(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0])).reshape(3, -1).T


def cube(middle, side=0.2, colour="#FF0000", **more):
    return Solid("cube", [np.asarray(middle) + side / 2.0 * SIGNS], colour, **more)


@pytest.fixture
def camera():
    """On the floor's right, level, looking along y at half a metre of height."""
    return Camera(np.array([0.0, -4.0, 0.5]), np.array([0.0, 0.0, 0.5]), SIZE)


def is_red(image):
    red, green, blue = image.astype(int).transpose(2, 0, 1)
    return (red > 100) & (green < 60) & (blue < 60)


def is_green(image):
    red, green, blue = image.astype(int).transpose(2, 0, 1)
    return (green > 100) & (red < 60) & (blue < 60)


class TestCamera:
    def test_a_corner_of_a_cube_lands_where_the_formula_says(self, camera):
        corner = np.array([0.3, -0.2, 0.9])
        focal = 120.0 / np.tan(np.radians(LENS) / 2.0)
        pixel, distance = camera.project(corner)
        assert distance == pytest.approx(3.8)
        assert pixel == pytest.approx([160.0 + focal * 0.3 / 3.8, 120.0 - focal * 0.4 / 3.8])

    def test_the_drawn_cube_ends_there(self, camera):
        image = draw(camera, Mesh.of([cube([0.0, 0.0, 0.5])]))
        near = camera.project(np.array([[-0.1, -0.1, 0.6], [0.1, -0.1, 0.4]]))[0]
        rows, columns = np.nonzero(is_red(image))
        assert [columns.min(), rows.min()] == pytest.approx(near[0], abs=1.0)
        assert [columns.max() + 1, rows.max() + 1] == pytest.approx(near[1], abs=1.0)

    def test_a_camera_from_the_side_and_above(self):
        eye, target = np.array([1.0, -3.0, 2.0]), np.array([0.2, 0.1, 0.4])
        pixel, distance = Camera(eye, target, SIZE).project(target)
        assert pixel == pytest.approx([160.0, 120.0])
        assert distance == pytest.approx(np.linalg.norm(target - eye))
        higher = Camera(eye, target, SIZE).project(target + np.array([0.0, 0.0, 0.1]))[0]
        assert higher[0] == pytest.approx(160.0)
        assert higher[1] < 120.0

    @pytest.mark.parametrize("size", [(320, 240), (200, 400), (640, 100)])
    def test_around_points(self, size):
        points = np.random.default_rng(0).normal(size=(50, 3)) * [0.5, 0.2, 0.8]
        camera = Camera.around(points, (-0.3, 1.0, -0.2), checked(size), border=0.1)
        pixels, distances = camera.project(points)
        free = 0.1 * size[1]
        room = np.array([[free, free], np.subtract(size, free)])
        low, high = pixels.min(axis=0), pixels.max(axis=0)
        assert (low > room[0] - 1e-6).all()
        assert (high < room[1] + 1e-6).all()
        assert (distances > 0.0).all()
        assert np.isclose([low, high], room).all(axis=0).any(), "it cannot be nearer"

    def test_moved(self, camera):
        shift, point = np.array([0.7, 0.0, 0.0]), np.array([0.1, 0.2, 0.3])
        assert camera.moved(shift).project(point + shift)[0] == pytest.approx(camera.project(point)[0])

    @pytest.mark.parametrize(
        "size",
        [(0, 10), (15, 400), (640, -480), (640.0, 480), (640,), 640, "ab", (True, 99), (10_000, 720), None, (6, 4, 3)],
    )  # fmt: skip
    def test_bad_sizes(self, size):
        with pytest.raises(InvalidInput, match=r"16 to 8192 pixels$") as error:
            checked(size)
        assert "\n" not in str(error.value)

    def test_odd_sizes(self):
        assert checked((641, 481)) == (641, 481)
        with pytest.raises(InvalidInput, match="even"):
            checked((641, 480), even=True)


class TestRaster:
    def test_a_triangle_covers_its_samples(self):
        corners = np.array([[[2.0, 3.0], [34.0, 3.0], [2.0, 27.0]]])
        found = seen(nearest(corners, np.ones((1, 3)), WHOLE))
        x, y = np.meshgrid(np.arange(40) + 0.5, np.arange(30) + 0.5)
        inside = (x >= 2.0) & (y >= 3.0) & ((x - 2.0) / 32.0 + (y - 3.0) / 24.0 <= 1.0)
        assert (found == inside).all()
        assert (covered(corners, np.ones((1, 3)), WHOLE) == inside).all()

    @pytest.mark.parametrize("turned", [False, True])
    def test_two_triangles_leave_no_gap(self, turned):
        square = np.array([[3.3, 2.1], [35.7, 4.2], [33.1, 26.9], [1.2, 28.4]])
        corners = square[[[0, 1, 2], [0, 2, 3]]][:, :: -1 if turned else 1]
        whole = square[[[0, 1, 3], [1, 2, 3]]]
        one, other = (seen(nearest(each, np.ones((2, 3)), WHOLE)) for each in (corners, whole))
        assert (one == other).all()
        assert one.sum() == pytest.approx(32.2 * 24.2, rel=0.05)

    def test_near_hides_far_in_either_order(self):
        far, near = np.array([[0, 0], [40, 0], [0, 30.0]]), np.array([[0, 0], [20, 0], [0, 15.0]])
        for order in ([0, 1], [1, 0]):
            buffer = nearest(np.array([far, near])[order], np.full((2, 3), [[5.0], [2.0]])[order], WHOLE)
            assert triangle_of(buffer)[2, 2] == order.index(1)
            assert triangle_of(buffer)[10, 18] == order.index(0)

    def test_triangles_that_pass_through_each_other(self):
        flat = np.array([[0.0, 0.0], [40.0, 0.0], [0.0, 30.0]])
        distances = np.array([[3.0, 3.0, 3.0], [2.0, 6.0, 2.0]])
        buffer = triangle_of(nearest(np.array([flat, flat]), distances, WHOLE))
        # 1 / distance falls from 1/2 to 1/6 over 40 samples and passes 1/3 in the middle
        assert buffer[1, :19].tolist() == [1] * 19
        assert buffer[1, 21:30].tolist() == [0] * 9

    def test_what_lies_outside_or_behind_is_left_out(self):
        corners = np.array([[[-90.0, -50.0], [-60.0, -50.0], [-70.0, -10.0]], [[0.0, 0.0], [40.0, 0.0], [0.0, 30.0]]])
        assert not seen(nearest(corners, np.array([[1.0] * 3, [1.0, 1.0, -1.0]]), WHOLE)).any()
        large = np.array([[[-1e4, -1e4], [3e4, -1e4], [-1e4, 3e4]]])
        assert seen(nearest(large, np.ones((1, 3)), WHOLE)).all()


class TestMesh:
    def test_a_cube_has_six_faces_that_look_outwards(self):
        mesh = Mesh.of([cube([1.0, 2.0, 3.0]), cube([0.0, 0.0, 0.0])])
        assert len(np.unique(mesh.faces)) == 12
        outwards = mesh.corners.mean(axis=1)[:12] - [1.0, 2.0, 3.0]
        assert (np.einsum("ta,ta->t", outwards, mesh.normals[:12, 0]) > 0.0).all()
        turning = np.cross(mesh.corners[:, 1] - mesh.corners[:, 0], mesh.corners[:, 2] - mesh.corners[:, 0])
        assert (np.einsum("ta,ta->t", turning, mesh.normals[:, 0]) > 0.0).all()

    def test_coplanar_hulls_of_a_solid_have_one_face(self):
        corners = 0.1 * SIGNS
        mesh = Mesh.of([Solid("two", [corners, corners + np.array([0.1, 0.0, 0.0])], "#FFFFFF")])
        assert len(np.unique(mesh.faces)) == 8, "four sides in common, and two ends of each"

    def test_what_bends_a_little_is_round(self):
        height = np.linspace(-0.995, 0.995, 400)
        turn, radius = 2.4 * np.arange(400), np.sqrt(1.0 - height**2)
        ball = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])
        mesh = Mesh.of([Solid("ball", [ball], "#FFFFFF")])
        assert np.einsum("tka,tka->tk", mesh.normals, mesh.corners).min() > 0.99
        assert len(np.unique(mesh.faces)) == 1

    def test_what_bends_sharply_has_edges(self):
        mesh = Mesh.of([cube([0.0, 0.0, 0.0])])
        assert (np.sort(np.abs(mesh.normals), axis=2) == [0.0, 0.0, 1.0]).all()

    def test_it_moves_with_its_joint(self):
        turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        placed = Placements(np.array([[np.eye(3), turn]]), np.array([[[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]]]))
        mesh = Mesh.of([cube([1.0, 0.0, 0.0]), cube([1.0, 0.0, 0.0], joint=1)]).placed(placed, 0)
        assert mesh.corners[:12].reshape(-1, 3).mean(axis=0) == pytest.approx([1.0, 0.0, 0.0], abs=1e-2)
        assert mesh.corners[12:, :, 1].min() == pytest.approx(0.9)
        assert mesh.corners[12:, :, 0].max() == pytest.approx(5.1)


class TestPicture:
    def test_near_hides_far_in_either_order(self, camera):
        near, far = cube([0.0, -1.0, 0.5]), cube([0.0, 1.0, 0.5], side=0.4, colour="#00FF00")
        for order in ([near, far], [far, near]):
            image = draw(camera, Mesh.of(order))
            assert is_red(image)[120, 160]
            assert is_green(image).any()
            assert not is_green(image)[115:125, 155:165].any()

    def test_the_near_side_of_a_solid_is_seen(self, camera):
        """The light falls on the side towards the camera, not on the far one."""
        image = draw(camera, Mesh.of([cube([0.0, 0.0, 0.5], side=0.5)]))
        shade = picture.AMBIENT - picture.SUN * picture.LIGHT[1]
        assert image[120, 160, 0] == pytest.approx(255.0 * shade, abs=1.0)

    def test_edges_are_smooth_and_the_area_is_right(self, camera, monkeypatch):
        monkeypatch.setattr(picture, "EDGE", 1.0)
        monkeypatch.setattr(picture, "SHADOW", 0.0)
        monkeypatch.setattr(picture, "AMBIENT", 1.0)
        monkeypatch.setattr(picture, "SUN", 0.0)
        monkeypatch.setattr(picture, "SKY", 0.0)
        monkeypatch.setattr(ground, "LINE", ground.FLOOR)
        camera = Camera(np.array([0.0, -4.0, 3.0]), np.array([0.0, 0.0, 0.0]), SIZE)
        points = np.array([[-0.31, -0.29, 0.0], [0.33, -0.2, 0.0], [0.02, 0.4, 0.0]])
        mesh = Mesh.of([Solid("plate", [np.vstack([points, points - [0.0, 0.0, 1e-6]])], "#000000")])
        image = draw(camera, mesh)[..., 0] / 255.0
        share = np.clip(1.0 - image / ground.FLOOR[0], 0.0, 1.0)
        (x, y), (u, v) = np.diff(camera.project(points)[0], axis=0)
        assert share.sum() == pytest.approx(abs(x * v - y * u) / 2.0, rel=0.01)
        levels = np.unique(np.round(share, 2))
        assert len(levels) == picture.FINENESS**2 + 1, levels
        assert levels == pytest.approx(np.arange(5) / 4.0, abs=0.02)

    def test_the_veil_tints_what_is_behind_it_and_not_what_is_before_it(self, camera):
        before, behind = cube([-0.2, -1.0, 0.5]), cube([0.2, 1.0, 0.5])
        solid, veil = Mesh.of([before, behind]), Mesh.of([cube([0.0, 0.0, 0.5], side=1.0, colour="#0000FF")])
        plain, tinted = draw(camera, solid).astype(int), draw(camera, solid, veil).astype(int)
        here, there = (
            camera.project(np.array(middle))[0].astype(int) for middle in ([-0.2, -1.1, 0.5], [0.2, 0.9, 0.5])
        )
        assert (plain[here[1], here[0]] == tinted[here[1], here[0]]).all()
        assert tinted[there[1], there[0], 2] > plain[there[1], there[0], 2] + 30
        assert tinted[there[1], there[0], 0] > 50, "it is seen through the veil"

    def test_the_shadow_falls_away_from_the_light(self):
        camera = Camera(np.array([0.0, -4.0, 2.0]), np.array([0.0, 0.0, 0.0]), SIZE)
        with_it, height = draw(camera, Mesh.of([cube([0.0, 0.0, 0.5], side=0.1)])), 0.5
        place = np.array([0.0, 0.0, height]) - height / picture.LIGHT[2] * picture.LIGHT
        assert np.linalg.norm(picture.LIGHT) == pytest.approx(1.0, abs=1e-4)
        column, row = camera.project(place)[0].astype(int)
        empty = (ground.ground(camera) * 255.0 + 0.5).astype(int)
        assert with_it[row, column, 0] == pytest.approx((1.0 - picture.SHADOW) * empty[row, column, 0], abs=4)
        assert place[1] > 0.0, "behind the robot, as seen from the camera"
        other = camera.project(place * [-1.0, -1.0, 1.0])[0].astype(int)
        assert (with_it[other[1], other[0]] == empty[other[1], other[0]]).all()

    @pytest.mark.parametrize(
        "middle", [[50.0, 0.0, 0.5], [0.0, 0.0, 50.0], [0.0, -20.0, 0.5], [0.0, -4.0, 0.5], [0.0, 0.0, -5.0]]
    )
    def test_what_is_not_in_the_picture_leaves_the_floor(self, camera, middle):
        empty = np.asarray(ground.ground(camera) * 255.0 + 0.5, dtype=np.uint8)
        assert (draw(camera, Mesh.of([cube(middle)]), Mesh.of([cube(middle, side=0.4)])) == empty).all()

    def test_the_same_bytes_twice(self, camera):
        mesh, veil = Mesh.of([cube([0.1, 0.0, 0.4])]), Mesh.of([cube([0.1, 0.0, 0.4], side=0.3)])
        first = draw(camera, mesh, veil)
        assert draw(Camera(camera.eye, camera.eye + camera.forward, SIZE), mesh, veil).tobytes() == first.tobytes()
        assert draw(camera, mesh, veil).tobytes() == first.tobytes(), "the floor that is kept has not changed"


class TestGround:
    def test_lines_lie_where_the_grid_is(self):
        camera = Camera(np.array([0.0, -3.0, 1.0]), np.array([0.0, 0.0, 0.0]), SIZE)
        floor = ground.ground(camera)
        (x, y), _ = camera.project(np.array([0.25, 0.125, 0.0]))
        (between, _), _ = camera.project(np.array([0.125, 0.125, 0.0]))
        assert floor[int(y), int(x)] == pytest.approx(ground.LINE, abs=0.03)
        assert floor[int(y), int(between)] == pytest.approx(ground.FLOOR, abs=0.01)

    @pytest.mark.parametrize(("eye", "most", "mean"), [((0.3, -4.0, 0.9), 0.2, 0.010), ((0.3, -6.0, 9.0), 0.1, 0.005)])
    def test_lines_are_averaged_over_pixels(self, eye, most, mean):
        """A coarse picture is the mean of a fine one: no line is lost, and none flickers.

        A pixel's place on the floor is taken as a rectangle along the grid. Seen flatly, slanted lines are off by more.
        """
        cameras = [Camera(np.array(eye), np.array([0.1, 0.0, 0.2]), Size(*size)) for size in ((1280, 960), (80, 60))]
        fine, coarse = (ground.ground(camera) for camera in cameras)
        off = np.abs(fine.reshape(60, 16, 80, 16, 3).mean(axis=(1, 3)) - coarse)
        contrast = np.subtract(ground.FLOOR, ground.LINE).max()
        assert off.max() < most * contrast
        assert off.mean() < mean * contrast

    def test_the_far_floor_is_the_background(self):
        camera = Camera(np.array([0.0, -4.0, 0.6]), np.array([0.0, 0.0, 0.6]), SIZE)
        floor = ground.ground(camera)
        assert floor[121, 100] == pytest.approx(ground.HORIZON, abs=1e-3)
        assert floor[0, 100, 0] > floor[119, 100, 0] - 1e-6

    def test_from_below_the_floor_there_is_none(self):
        camera = Camera(np.array([0.0, -4.0, -0.5]), np.array([0.0, 0.0, 0.6]), SIZE)
        assert np.isfinite(ground.ground(camera)).all()
