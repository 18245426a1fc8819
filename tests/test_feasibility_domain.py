"""model/feasibility_domain.py and model/domains.py: Fig. 2 and Remarks 1 and 2 of Sec. II-A."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from stepover import InvalidInput, Obstacle
from stepover.analysis.planar.biped import leg_lines, planar_leg
from stepover.analysis.planar.crossing import lines_meet
from stepover.analysis.planar.domains import Domains
from stepover.analysis.planar.feasibility_domain import Reading, feasibility_domains, feasible, taken
from stepover.planning.algorithm_1.feasibility import key_configurations

STEP = 0.0005
"""Between the places at which brute force tries the obstacle [m]."""
READINGS = [
    Reading(),
    Reading(margins=True),
    Reading(outline=False),
    Reading(outline=False, feet=False),
    Reading(hip_share=0.0),
    Reading(ankle_height=False),
    Reading(feet=False),
]
HOLLOW = READINGS[-2:]
"""Here brute force also finds places inside a leg: between link and outline, below a shin or in the space of a foot."""


@pytest.fixture(scope="module")
def domains(robot, obstacle):
    """Fig. 2 at 200 x 200."""
    return feasibility_domains(robot, obstacle, points=200)


def judge(robot, obstacle, reading, x_ads, x_hds, z_hds):
    """The library's judgement of single postures, by the number of the condition."""
    biped = reading.biped(robot)
    legs = (taken(biped, reading, obstacle, x, z_hds) for x in (x_hds, x_hds - x_ads))
    return feasible(biped, reading, obstacle, x_ads, *legs)


def brute_force(robot, obstacle, reading, x_ads, x_hds, z_hds):
    """One posture with the obstacle at every place between the feet, crossings by (5): the same judgement."""
    biped, (width, top), half = reading.biped(robot), reading.box(obstacle), robot.foot.sole_length / 2.0
    legs = [planar_leg(biped, np.array(x), np.array(z_hds)) for x in (x_hds, x_hds - x_ads)]
    if not all(leg.possible for leg in legs) or z_hds <= top:
        return dict.fromkeys((6, 7, 8), False)
    rear, front = (
        [line + np.array([x, 0.0]) for line in leg_lines(biped, leg)] for leg, x in zip(legs, (0.0, x_ads), strict=True)
    )
    toe = half if reading.feet else 0.0
    places = np.arange(toe + STEP / 2.0, x_ads - toe - width, STEP)
    corners = np.array([[0.0, 0.0], [0.0, top], [width, top], [width, 0.0]])
    edges = corners + np.column_stack([places, np.zeros_like(places)])[:, None]
    free = bool((~lines_meet([line[None] for line in rear + front], edges)).any())
    middles = np.concatenate([(links[0][:-1, 0] + links[0][1:, 0]) / 2.0 for links in (rear, front)])
    com = reading.hip_share * x_hds + (1.0 - reading.hip_share) * middles.mean()
    limits = {6: (-half, half), 7: (-half, x_ads + half), 8: (x_ads - half, x_ads + half)}
    return {equation: free and low <= com <= high for equation, (low, high) in limits.items()}


@pytest.mark.parametrize("reading", READINGS, ids=str)
def test_eliminating_the_obstacles_place_is_exact(robot, obstacle, reading):
    """Against brute force on random postures: what it finds is found, and the rest has less room than its step."""
    rng, count = np.random.default_rng(11), 1000
    x_ads, z_hds = rng.uniform(0.1, 0.9, count), rng.uniform(0.35, 0.70, count)
    x_hds = x_ads * rng.uniform(-0.1, 1.1, count)
    wider = dataclasses.replace(obstacle, width=obstacle.width + 1.01 * STEP)
    found = judge(robot, obstacle, reading, x_ads, x_hds, z_hds)
    surely = judge(robot, wider, reading, x_ads, x_hds, z_hds)
    for k in range(count):
        for equation, good in brute_force(robot, obstacle, reading, x_ads[k], x_hds[k], z_hds[k]).items():
            assert surely[equation][k] <= good, (k, equation)
            assert good <= found[equation][k] or reading in HOLLOW, (k, equation)
    assert found[7].sum() > 20
    assert found[6].sum() < found[7].sum()
    assert (found[7] & ~surely[7]).sum() < 0.05 * found[7].sum()


def test_the_domains_are_what_single_postures_say(robot, obstacle, domains):
    """The table over both legs, against each posture by itself."""
    rng = np.random.default_rng(12)
    fine = domains.cell[0] / 4.0
    hips = np.arange(-300, 600) * fine
    for _ in range(300):
        row, column = rng.integers(0, 200, 2)
        found = judge(robot, obstacle, Reading(), domains.x_ads[column], hips, domains.z_hds[row])
        for equation in (6, 7, 8):
            assert found[equation].any() == domains.masks[equation][row, column]
        slice_ = judge(robot, obstacle, Reading(), domains.x_ads[column], domains.x_ads[column] / 2, domains.z_hds[row])
        assert slice_[7] == domains.masks[22][row, column]


def test_remark_1_both_ends_of_phase_2_are_tighter_than_its_middle(domains):
    for equation in (6, 8):
        assert domains.area(equation) < 0.5 * domains.area(7)
        assert not (domains.masks[equation] & ~domains.masks[7]).any()
    assert not (domains.masks[22] & ~domains.masks[7]).any()


def test_areas_and_limits_of_an_independent_study(domains):
    """Another search over X_hds, at its own resolution: 201 points, the hip on a grid as coarse."""
    known = {6: 0.0679, 7: 0.1425, 8: 0.0292, 22: 0.0652}
    for equation, area in known.items():
        assert domains.area(equation) == pytest.approx(area, rel=0.1)
    for z_hds, limits in {0.50: (0.285, 0.89), 0.55: (0.275, 0.80), 0.60: (0.27, 0.67), 0.65: (0.275, 0.50)}.items():
        assert domains.limits(7, z_hds) == pytest.approx(limits, abs=0.011)


def test_remark_2_a_lower_hip_widens_the_range_down_to_047(domains):
    top, end, widest = domains.trend(7)
    assert 0.68 < top < 0.70
    assert end <= 0.47
    assert widest <= 0.47
    between = (domains.z_hds >= 0.47) & (domains.z_hds <= top)
    ranges = domains.ranges(7)[between][::-1]
    assert (np.diff(ranges) >= -1.001 * domains.cell[0]).all()
    assert ranges[-1] > ranges[0] + 0.5


def test_the_trend_ends_where_ankle_and_hip_meet_their_limits(robot, domains):
    """Rear ankle at 75 degrees and rear hip at 42 put the hip at 0.105 + 0.3 (cos 75 + cos 42) = 0.406 m."""
    lowest = 0.105 + 0.3 * (np.cos(np.radians(75.0)) + np.cos(np.radians(42.0)))
    assert domains.trend(7)[1] == pytest.approx(lowest, abs=3 * domains.cell[1])


def test_tied_to_the_step_the_hip_gains_less_by_going_down(domains):
    assert domains.trend(22)[1] > 0.5
    assert domains.limits(22, 0.50)[1] > domains.limits(22, 0.60)[1]
    assert domains.limits(22, 0.50)[0] > domains.limits(22, 0.60)[0]


def test_what_other_readings_give(robot, obstacle):
    found = {reading: feasibility_domains(robot, obstacle, reading, points=100) for reading in READINGS}
    assert found[Reading(ankle_height=False)].trend(7)[0] < 0.6  # no hip near the text's 0.7
    assert found[Reading(feet=False)].trend(7)[1] > 0.55  # Remark 2 fails
    bare = found[Reading(outline=False, feet=False)]
    assert bare.x_ads[bare.masks[7].any(axis=0)][0] < 0.1  # steps shorter than a foot
    assert found[Reading(margins=True)].area(6) < 0.05 * found[Reading(margins=True)].area(7)
    for reading, one in found.items():
        assert one.area(6) < one.area(7), reading
        assert one.area(8) < one.area(7), reading


def test_fewer_demands_never_shrink_a_domain(robot, obstacle):
    whole = feasibility_domains(robot, obstacle, Reading(margins=True), points=60)
    for less in (Reading(), Reading(margins=True, outline=False), Reading(margins=True, feet=False)):
        more = feasibility_domains(robot, obstacle, less, points=60)
        for equation, mask in whole.masks.items():
            assert not (mask & ~more.masks[equation]).any(), (less, equation)


@pytest.mark.parametrize("margins", [False, True])
def test_higher_and_wider_obstacles_leave_less(robot, margins):
    for obstacles in (
        [Obstacle(height, 0.05) for height in (0.05, 0.15, 0.25)],
        [Obstacle(0.15, width) for width in (0.02, 0.05, 0.20)],
    ):
        found = [feasibility_domains(robot, one, Reading(margins=margins), points=60) for one in obstacles]
        for less, more in zip(found[1:], found, strict=False):
            for equation, mask in less.masks.items():
                assert not (mask & ~more.masks[equation]).any()
            assert less.area(7) < more.area(7)


def test_margins_are_a_larger_bare_obstacle(robot):
    grown = feasibility_domains(robot, Obstacle(0.18, 0.11), points=60)
    with_margins = feasibility_domains(robot, Obstacle(0.15, 0.05), Reading(margins=True), points=60)
    for equation, mask in grown.masks.items():
        np.testing.assert_array_equal(mask, with_margins.masks[equation])


def mirrored(biped):
    """The biped that walks the other way: outline turned about, hip and ankle swing as far back as they did ahead."""
    outline = tuple(line * [-1.0, 1.0] for line in biped.outline)
    return dataclasses.replace(biped, outline=outline, limits=-biped.limits[:, ::-1])


def test_mirrored_legs_take_up_the_mirror_image(robot, obstacle):
    """A straight leg has no knee to bend: its lines mirror exactly, what is ahead comes behind."""
    biped = Reading().biped(robot)
    lean = np.radians(np.linspace(-40.0, 40.0, 17))
    ahead, height = 0.6 * np.sin(lean), 0.105 + 0.6 * np.cos(lean) - 1e-12
    one = taken(biped, Reading(), obstacle, ahead, height)
    other = taken(mirrored(biped), Reading(), obstacle, -ahead, height)
    np.testing.assert_allclose(one.ahead, other.behind, atol=1e-5)
    np.testing.assert_allclose(one.behind, other.ahead, atol=1e-5)
    np.testing.assert_allclose(one.centre, -other.centre, atol=1e-5)


def test_straight_bare_links_see_no_difference_between_the_two_feet(robot, obstacle):
    """Without outline and knee (a shin of no length) seen from the other side (6) is (8), and (7) is itself."""
    reading = Reading(outline=False)
    biped = dataclasses.replace(reading.biped(robot), shank=1e-6, thigh=0.6, limits=np.tile([-9.0, 9.0], (3, 1)))
    hips, z_hds, x_ads = np.linspace(-0.3, 0.7, 201), 0.65, 0.4
    legs = {x: taken(biped, reading, obstacle, hips - x, np.full(201, z_hds)) for x in (0.0, x_ads)}
    found = feasible(biped, reading, obstacle, x_ads, legs[0.0], legs[x_ads])
    np.testing.assert_array_equal(found[6], found[8][::-1])
    np.testing.assert_array_equal(found[7], found[7][::-1])


def test_areas_hardly_depend_on_the_resolution(robot, obstacle, domains):
    for points, tolerance in ((100, 0.02), (400, 0.02)):
        other = feasibility_domains(robot, obstacle, points=points)
        for equation in domains.masks:
            assert other.area(equation) == pytest.approx(domains.area(equation), rel=tolerance), equation


def test_the_key_configuration_is_dynamic_only(robot, obstacle, domains):
    """FU's, for the obstacle with its margins, lies inside (7) and (22), outside (6) and (8)."""
    key = key_configurations(robot, obstacle)[0]
    row, column = np.abs(domains.z_hds - key.z_hds).argmin(), np.abs(domains.x_ads - key.x_ads).argmin()
    assert [bool(domains.masks[equation][row, column]) for equation in (6, 7, 8, 22)] == [False, True, False, True]


def test_quasi_statically_15_cm_with_margins_needs_its_own_step(robot, obstacle):
    """(6) and (8) share step lengths of 0.40 to 0.49 m for 18 x 11 cm, and none for 23 x 11 cm."""
    steps = feasibility_domains(robot, obstacle, Reading(margins=True)).common_steps()
    assert 0.39 < steps[0] < steps[-1] < 0.50
    higher = Obstacle(0.20, 0.05)
    assert len(feasibility_domains(robot, higher, Reading(margins=True)).common_steps()) == 0
    assert len(feasibility_domains(robot, higher).common_steps()) > 0


def test_measures_of_a_domain_by_hand():
    """Three heights, five steps 0.1 m apart: ranges 0.3, 0.2, 0.1 from below."""
    mask = np.array([[0, 1, 1, 1, 0], [0, 1, 1, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 0, 0]], dtype=bool)
    other = mask[::-1]
    one = Domains(np.linspace(0.0, 0.4, 5), np.array([0.4, 0.5, 0.6, 0.7]), {6: mask, 7: other, 8: np.zeros_like(mask)})
    assert one.area(6) == pytest.approx(0.06)
    np.testing.assert_allclose(one.ranges(6), [0.3, 0.2, 0.1, 0.0])
    assert one.limits(6, 0.52) == pytest.approx((0.1, 0.2))
    assert np.isnan(one.limits(6, 0.7)).all()
    assert one.trend(6) == pytest.approx((0.6, 0.4, 0.4))
    assert one.trend(7) == pytest.approx((0.7, 0.6, 0.7))  # one step less is allowed, two are not
    assert np.isnan(one.trend(8)).all()
    np.testing.assert_allclose(one.common_steps(6, 7), [0.1, 0.2, 0.3])
    assert len(one.common_steps(6, 8)) == 0


def test_an_obstacle_that_nothing_clears_leaves_nothing(robot):
    for obstacle in (Obstacle(0.8, 0.05), Obstacle(0.15, 0.9)):
        found = feasibility_domains(robot, obstacle, points=50)
        assert not any(mask.any() for mask in found.masks.values())


@pytest.mark.parametrize(
    "options",
    [{"points": 1}, {"finer": 0}, {"x_ads_max": 0.0}, {"x_ads_max": np.inf}, {"x_ads_max": np.nan},
     {"z_hds": (0.7, 0.4)}, {"z_hds": (0.0, 0.4)}, {"z_hds": (0.4, np.nan)}],
)  # fmt: skip
def test_grids_that_are_none_are_refused(robot, obstacle, options):
    with pytest.raises(InvalidInput, match="two points or more"):
        feasibility_domains(robot, obstacle, **options)


@pytest.mark.parametrize("share", [-0.1, 1.1, np.nan])
def test_a_share_of_the_mass_lies_between_0_and_1(share):
    with pytest.raises(InvalidInput, match="hip_share"):
        Reading(hip_share=share)
