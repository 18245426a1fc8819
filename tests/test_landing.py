"""report/landing*.py: the swings of Fig. 3, the force at landing, the landing control, the verdicts."""

from __future__ import annotations

import dataclasses
import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from stepover import Obstacle, simulate
from stepover.analysis.landing.control import THRESHOLD, AsPlanned, LandingControl
from stepover.analysis.landing.force import land, measured
from stepover.analysis.landing.settings import BASES, FITTED, RIGID, VARIATIONS, Setting
from stepover.analysis.landing.swings import (
    NAIVE,
    SAME_APEX,
    SHAPED,
    Curves,
    landing_motion,
    leg_1_swing,
    lowest_apex,
    planned_in,
    profile_of,
    through_control_points,
    with_feet,
)
from stepover.control.sensors import Sensed
from stepover.errors import InvalidInput
from stepover.model.pose import pose
from stepover.motion.footsteps import LEG_1
from stepover.planning.algorithm_1.feet_trajectories import Swing, fourth_order
from stepover.planning.checks import require
from stepover.planning.measures import measure
from stepover.report.tables import landing as landing_tables
from stepover.report.tables.landing import PAPER_NAIVE, PAPER_SHAPED, nearest_pairs, pair
from stepover.reproduction.claims import read_claims
from stepover.studies import landing as landing_study
from stepover.studies.agreement import NEARLY, NO, YES
from stepover.studies.landing import LONG, SHORT, Landed, Point, agreement_of, at

DT, STEP = 0.005, 0.001


@pytest.fixture(scope="module")
def naive(robot, obstacle):
    """The motion with the naive swing."""
    return landing_motion(robot, obstacle, NAIVE)


@pytest.fixture(scope="module")
def step(planned):
    """Leg 1's step."""
    return planned.sequence.step(LEG_1)


@pytest.fixture(scope="module")
def stored():
    """The stored table."""
    return landing_study.read_table()


# The swings of Fig. 3


def test_the_fourth_order_swing_is_the_polynomial_of_its_five_conditions():
    share, rest = np.linspace(0.0, 1.0, 201), np.zeros(201)
    swing = fourth_order(Swing(share, rest + 0.1, rest + 9.0, rest + 1.0), share, 0.3)
    powers = np.arange(5)
    conditions = [0.0**powers, 1.0**powers, [0, 1, 0, 0, 0], powers, 0.5**powers]  # z, z, z', z' at the ends, apex
    coefficients = np.linalg.solve(np.array(conditions, float), [0.0, 0.0, 0.0, 0.0, 0.3])
    np.testing.assert_allclose(swing.z, np.polynomial.polynomial.polyval(share, coefficients), atol=1e-12)
    np.testing.assert_array_equal(swing.x, share)
    np.testing.assert_array_equal(swing.y, 0.1)
    np.testing.assert_array_equal(swing.pitch, 0.0)


def test_its_speed_near_the_floor(robot, obstacle, planned):
    """Of z = 16 a s^2 (1-s)^2 at height h: s (1-s) = sqrt(h / a) / 4 =: u, and dz/ds = -32 a u sqrt(1 - 4 u)."""
    profile = profile_of(planned.nominal.crossing, NAIVE)
    apex = profile.height.max()
    u = np.sqrt(0.010 / apex) / 4.0
    expected = 32.0 * apex * u * np.sqrt(1.0 - 4.0 * u) / 1.5
    assert profile.time[-1] == pytest.approx(1.5)
    assert profile.speed_near_floor(0.010) == pytest.approx(expected, rel=2e-3)


def test_the_shaped_swing_near_the_floor(robot, obstacle, planned):
    """A parabola from the height with margin at 0.74 of the time: its speed at h is 2 sqrt(h top) / (0.26 T)."""
    profile = profile_of(planned.nominal.crossing, SHAPED)
    expected = 2.0 * np.sqrt(0.010 * 0.18) / (0.26 * 1.5)
    assert profile.speed_near_floor(0.010) == pytest.approx(expected, rel=0.01)
    assert np.degrees(profile.pitch.min()) == pytest.approx(-2.0, abs=0.01)


def test_the_naive_swing_is_as_low_as_the_margins_allow(robot, obstacle, planned):
    swing = leg_1_swing(planned.nominal.crossing, NAIVE)
    back, front, _, top = obstacle.profile(planned.sequence.front_face, margins=True)
    over = (swing.x + robot.foot.toe > back + 1e-9) & (swing.x - robot.foot.heel < front - 1e-9)
    assert swing.z[over].min() == pytest.approx(top, abs=1e-9)
    share = np.linspace(0.0, 1.0, len(swing.z))
    assert lowest_apex(planned.nominal.crossing, swing.x, share) == pytest.approx(swing.z.max(), rel=1e-3)
    same = leg_1_swing(planned.nominal.crossing, SAME_APEX)
    shaped = leg_1_swing(planned.nominal.crossing, SHAPED)
    assert same.z.max() == pytest.approx(shaped.z.max(), rel=1e-4)
    assert same.z[over].min() < top, "it cuts into the margin"


def test_an_unknown_swing_is_refused(robot, obstacle, planned):
    with pytest.raises(InvalidInput, match="'clever' must be one of shaped, naive"):
        leg_1_swing(planned.nominal.crossing, "clever")


# Whole motions


def test_the_plans_own_feet_give_the_plan(robot, planned):
    again = with_feet(planned, planned.nominal.feet)
    for name in ("q", "waist", "com", "zmp", "zmp_first_stage"):
        np.testing.assert_array_equal(getattr(again, name), getattr(planned.motion, name))


def test_the_shaped_motion_is_the_plan(robot, obstacle, motion):
    assert landing_motion(robot, obstacle, SHAPED).hash() == motion.hash()
    assert landing_motion(robot, obstacle, SHAPED, robot.walk.single_support_over).hash() == motion.hash()


def test_the_naive_motion_lands_where_and_when_the_shaped_one_does(robot, motion, naive, step):
    for side in (1, -1):
        changed = np.abs(naive.foot(side) - motion.foot(side)).max(axis=1) > 1e-12
        swings = np.zeros(len(motion.time), dtype=bool)
        if side == step.side:
            swings[step.lift_off + 1 : step.touch_down] = True
        assert not changed[~swings].any()
    assert np.abs(naive.foot(step.side) - motion.foot(step.side)).max() > 0.03
    np.testing.assert_array_equal(naive.footsteps.rows(), motion.footsteps.rows())


def test_the_naive_motion_is_whole(robot, obstacle, naive):
    """Inverse kinematics and the filter ran anew: it keeps what any plan must keep."""
    require(robot, naive)
    assert max(measure(robot, naive).zmp_rms) < 0.003
    for side in (1, -1):
        leg = robot.leg(side)
        _, places = leg.sole(naive.waist, naive.q[:, leg.columns])
        np.testing.assert_allclose(places, naive.foot(side)[:, :3], atol=1e-4)


def test_a_shorter_swing_keeps_the_key_configuration_and_leg_2(robot, obstacle, planned):
    short = planned_in(robot, obstacle, SHORT)
    assert short.key == planned.key
    times = {kind: short.sequence.step(kind) for kind in (1, 2, 3, 4)}
    assert [(s.touch_down - s.lift_off) * DT for s in times.values()] == pytest.approx([SHORT, SHORT, LONG, SHORT])


# Splines and polynomials


def test_both_curves_go_through_the_control_points_and_rest_at_the_ends(robot, obstacle):
    curves = through_control_points(robot, obstacle, 2)
    assert len(curves.knots) == 6
    np.testing.assert_allclose(curves.knots[:4, 1], [0.0, 0.18, 0.22, 0.18])
    for curve in (curves.spline, curves.polynomial):
        np.testing.assert_allclose(np.interp(curves.knots[:, 0], curves.share, curve), curves.knots[:, 1], atol=1e-5)
        for end in (curve, curve[::-1]):
            assert abs(-3.0 * end[0] + 4.0 * end[1] - end[2]) / (2.0 / 2000.0) < 1e-3, "one-sided, of second order"
    fitted = np.polynomial.Polynomial.fit(curves.share, curves.polynomial, 7)
    np.testing.assert_allclose(fitted(curves.share), curves.polynomial, atol=1e-9)
    assert np.abs(np.polynomial.Polynomial.fit(curves.share, curves.polynomial, 6)(curves.share)
                  - curves.polynomial).max() > 1e-3  # fmt: skip


def test_polynomials_oscillate_and_splines_do_not(robot, obstacle):
    several = [through_control_points(robot, obstacle, count) for count in (2, 3, 5, None)]
    wild = [one.overshoot(one.polynomial) for one in several]
    assert all(b > 5.0 * a for a, b in itertools.pairwise(wild))
    assert all(one.overshoot(one.spline) < 0.012 < one.overshoot(one.polynomial) for one in several)


def test_overshoot_is_measured_from_the_two_points_around():
    share = np.linspace(0.0, 1.0, 101)
    curves = Curves(np.array([[0.0, 0.0], [0.5, 1.0], [1.0, 0.5]]), share, share, share)
    straight = np.interp(share, *curves.knots.T)
    assert curves.overshoot(straight) == pytest.approx(0.0, abs=1e-12)
    bump = straight + 0.2 * np.exp(-(((share - 0.5) / 0.05) ** 2))
    assert curves.overshoot(bump) == pytest.approx(0.2, abs=0.01)
    dip = straight - 0.3 * (np.arange(101) == 96)  # from 0.54 to 0.24, where the points around are at 1 and 0.5
    assert curves.overshoot(dip) == pytest.approx(0.26)


# The force


def series(raw, heights=None):
    """A measured landing from a force that begins 0.5 s before the planned touch-down."""
    time = -0.5 + STEP * (1.0 + np.arange(len(raw)))
    return measured(time, raw, np.zeros(len(raw)) if heights is None else heights, 560.0)


def test_a_force_is_the_mean_of_the_5_ms_that_end_there():
    raw = np.zeros(750)
    raw[460] = 1000.0  # one step of 1 ms, at -39 ms
    found = series(raw)
    assert found.peak == pytest.approx(200.0)
    np.testing.assert_allclose(found.force[459:466], [0.0, 200.0, 200.0, 200.0, 200.0, 200.0, 0.0], atol=1e-9)
    assert found.contact == pytest.approx(-0.039)
    fine = measured(-0.5 + 0.0005 * (1.0 + np.arange(1500)), np.repeat(raw, 2), np.zeros(1500), 560.0)
    assert fine.peak == pytest.approx(found.peak), "the same force in steps half as long"


def test_the_touch_down_has_a_window_of_its_own():
    raw = np.zeros(750)
    raw[450:], raw[490:], raw[620:630] = 300.0, 700.0, 1500.0  # contact at -49 ms; more at -9 ms; most at 121 ms
    found = series(raw)
    assert (found.touch_down, found.peak) == pytest.approx((300.0, 1500.0))
    assert found.peak_time == pytest.approx(0.125), "the mean is full 5 ms after the force is there"


def test_a_brush_is_no_contact_and_none_at_all_gives_no_number():
    raw = np.zeros(750)
    raw[300] = 90.0  # 18 N over 5 ms
    found = series(raw)
    assert all(np.isnan(value) for value in (found.contact, found.touch_down, found.peak, found.peak_time))
    raw[700] = 105.0
    assert series(raw).contact == pytest.approx(0.201)


def test_the_speed_is_that_of_the_descent_before_contact():
    raw, heights = np.zeros(750), np.full(750, 0.105)
    raw[400:] = 500.0
    heights[:400] += 0.25 * STEP * np.arange(400, 0, -1)
    assert series(raw, heights).speed == pytest.approx(0.25)


def test_the_force_is_that_of_simulate(robot, motion):
    """At every sample the mean over its 5 ms, with everything that the loop of simulate has."""
    perturb = {"ground_leg_1": 0.004}
    run = simulate(motion, robot=robot, actuators="limited", sole="compliant", stabilizer=True, perturb=perturb)
    found = land(robot, motion, perturb=perturb)
    landing = motion.samples(1).stop
    wrench = run.series.right_wrench if motion.support[landing - 1] > 0 else run.series.left_wrench
    near = np.arange(landing - 40, landing + 20)
    mine = np.interp(motion.time[near] - motion.time[landing], found.time, found.force)
    np.testing.assert_allclose(mine, wrench[near, 2], atol=1e-6)
    assert found.peak >= run.landing_force_peak["first"] - 1e-6
    assert found.weight == pytest.approx(9.81 * robot.body.mass)


def test_pushes_count_in_a_landing(robot, motion):
    """1,500 N from t = 4 s: simulate falls at 4.2 s, and so does the landing."""
    push = {"push_x": 1500.0, "push_time": 4.0}
    calm, pushed = (land(robot, motion, perturb=perturb) for perturb in ({}, push))
    run = simulate(motion, robot=robot, actuators="limited", sole="compliant", stabilizer=True, perturb=push)
    assert run.fall_time == pytest.approx(4.2, abs=0.1)
    assert pushed.fell
    assert pushed.fell in run.fall_reason
    assert calm.fell == ""
    assert abs(pushed.peak - calm.peak) > 50.0 or np.isnan(pushed.peak)
    assert len(pushed.raw) == len(calm.raw)


# The landing control


def sensed(motion, side, force):
    """Readings of a robot whose one foot bears a force."""
    wrench, none = np.array([0.0, 0.0, force, 0.0, 0.0, 0.0]), np.zeros(6)
    wrenches = (wrench, none) if side > 0 else (none, wrench)
    return Sensed(motion.q[0, 7:], np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3), *wrenches)


def commanded(robot, motion, step, forces):
    """Control, commands (n, nq - 7) and height of the landing sole that they mean, over some samples."""
    control = LandingControl(robot, motion, AsPlanned(motion))
    samples = np.arange(step.lift_off, step.touch_down + 100)
    commands = np.array([control.command(k, sensed(motion, step.side, forces(k))) for k in samples])
    leg = robot.leg(step.side)
    _, places = leg.sole(motion.waist[samples], commands[:, np.array(leg.columns) - 7])
    return control, samples, commands, places[:, 2]


def test_without_contact_the_plan_is_carried_out(robot, motion, step):
    """Neither a light touch nor the load before lift-off counts."""
    early = (step.lift_off + step.touch_down) // 2
    control, samples, commands, _ = commanded(
        robot, motion, step, lambda k: 400.0 if k < early else THRESHOLD if k <= step.touch_down else 600.0
    )
    assert control.stopped is None
    np.testing.assert_array_equal(commands, motion.q[samples, 7:])


def test_contact_stops_the_descent_and_the_plan_gets_its_foot_back(robot, motion, step):
    first = step.touch_down - 20
    control, samples, commands, height = commanded(robot, motion, step, lambda k: 100.0 if k >= first else 0.0)
    plan = motion.foot(step.side)[:, 2]
    assert control.stopped == first
    held = plan[first - 1]
    assert held > 0.010
    during = (samples >= first) & (samples <= step.touch_down)
    np.testing.assert_allclose(height[during], held, atol=1e-9)
    half = np.flatnonzero(samples == step.touch_down + 4)
    np.testing.assert_allclose(height[half], held / 2.0, atol=1e-9)
    back = samples >= step.touch_down + 8
    np.testing.assert_allclose(commands[back], motion.q[samples[back], 7:], atol=1e-12)
    others = np.setdiff1d(np.arange(commands.shape[1]), np.array(robot.leg(step.side).columns) - 7)
    np.testing.assert_array_equal(commands[:, others], motion.q[samples][:, 7:][:, others])


def test_it_also_stops_what_pushes_the_foot_down_beyond_the_plan(robot, motion, step):
    """A stabilizer that lowers the landing foot is held as the plan is."""
    leg, first = robot.leg(step.side), step.touch_down - 10

    class Lowering(AsPlanned):
        def command(self, sample, sensed):
            joints = np.array(super().command(sample, sensed))
            down = 0.001 * max(sample - first, 0)
            sole = motion.foot(step.side)[sample, None] - down * np.eye(7)[2]
            joints[np.array(leg.columns) - 7] = leg.attempt(motion.waist[sample, None], sole)[0][0]
            return joints

    control = LandingControl(robot, motion, Lowering(motion))
    held = motion.foot(step.side)[first - 1, 2]
    for k in range(first - 5, step.touch_down):
        joints = control.command(k, sensed(motion, step.side, 100.0 if k >= first else 0.0))
    _, places = leg.sole(motion.waist[k, None], joints[None, np.array(leg.columns) - 7])
    assert places[0, 2] == pytest.approx(held, abs=1e-9)


# The study and its verdicts


def landed(variation, profile, time, peak, **known):
    """A row by hand."""
    return Landed("hrp2", "0", variation, profile, time, "abc", -0.01, 0.1, peak / 2.0, peak, 0.05, **known)


def by_hand(naive, short, shaped, variation=BASES[0], **known):
    """The three rows of a variation."""
    forces = zip(landing_study.SWINGS, (shaped, naive, short), strict=True)
    return [landed(variation, *swing, peak, **known) for swing, peak in forces]


def forces_by_hand(naive, shaped):
    """Both swings in the same time, as if simulated anew; rigid soles beside them."""
    peaks = {(BASES[0], NAIVE): naive, (BASES[0], SHAPED): shaped, (BASES[1], NAIVE): 1.0, (BASES[1], SHAPED): 1.0}
    return {Point(*key, LONG): SimpleNamespace(peak=peak) for key, peak in peaks.items()}


def test_settings_scale_what_the_robot_says(robot):
    changed = Setting(rubber_stiffness=0.5, rubber_damping=4.0, rubber_tilt=10.0, servo=2.0, time_step=0.5).of(robot)
    assert changed.sole.vertical_stiffness == 0.5 * robot.sole.vertical_stiffness
    assert changed.sole.vertical_damping == 4.0 * robot.sole.vertical_damping
    assert changed.sole.tilt_stiffness == 10.0 * robot.sole.tilt_stiffness
    assert changed.sole.tilt_damping == 10.0 * robot.sole.tilt_damping
    assert changed.servo.leg_stiffness == 2.0 * robot.servo.leg_stiffness
    assert changed.simulation.time_step == 0.5 * robot.simulation.time_step
    assert (Setting().assumptions, RIGID.assumptions, VARIATIONS[FITTED].assumptions) == (0, 1, 2)


def test_verdicts_are_about_equal_times_on_the_published_rubber(robot, obstacle, planned):
    claims = read_claims()
    profiles = [profile_of(planned.nominal.crossing, name) for name in (SHAPED, NAIVE)]
    curves = through_control_points(robot, obstacle)
    rest = by_hand(9.0, PAPER_NAIVE, PAPER_SHAPED, FITTED) + by_hand(900.0, 9.0, 450.0, BASES[1])
    for naive, shaped, expected in (
        (PAPER_NAIVE, PAPER_SHAPED, ["holds", "holds", "holds", "holds"]),
        (700.0, PAPER_SHAPED, ["differs", "holds", "differs", "holds"]),
        (1000.0, 520.0, ["differs", "differs", "holds", "holds"]),
    ):
        rows, anew = by_hand(naive, 9.0, shaped) + rest, {"one": forces_by_hand(naive, shaped)}
        found = landing_tables.measured(robot, rows, anew, profiles, curves)
        values = {name: value["one"] if isinstance(value, dict) else value for name, value, _ in found}
        assert ["holds" if claims[name].holds(value) else "differs" for name, value in values.items()] == expected
    assert "rigid soles 0.50, fitted rubber and a faster naive swing 0.52" in found[2][2]
    steady = dataclasses.replace(curves, polynomial=curves.spline)
    assert not claims["spline-vs-polynomial"].holds(landing_tables.measured(robot, rows, anew, profiles, steady)[3][1])


def test_the_nearest_pairs_come_first_and_say_what_they_assume():
    rows = [row for name in VARIATIONS for row in by_hand(600.0, 700.0, 590.0, name)]
    rows = [row for row in rows if row.variation not in (FITTED, BASES[1])]
    rows += by_hand(640.0, 1190.0, 620.0, FITTED) + by_hand(1190.0, 1400.0, 620.0, BASES[1], fell="it fell")
    best = nearest_pairs(rows, 3).rows
    assert best[0][:6] == (FITTED, "0.78", "3", "1190", "620", "0.52")
    assert BASES[1] not in [line[0] for line in best]
    assert np.isnan(pair(rows, BASES[1])).all()


def test_the_stored_table_is_whole(stored):
    assert [(row.variation, row.profile, row.swing_time) for row in stored] == [
        (point.variation, point.profile, point.swing_time) for point in landing_study.points()
    ]


@pytest.mark.parametrize("swing", [*landing_study.SWINGS, *landing_study.MORE_SWINGS], ids=str)
def test_todays_planner_plans_the_stored_motions(stored, swing):
    for variation in BASES:
        point = Point(variation, *swing)
        assert point.motion.hash() == at(stored, point).motion, "a motion has changed: run make studies"


def test_the_table_says_what_the_notebook_says(stored):
    """Where this fails after `make studies`, the notebook's prose needs another look."""
    for name, setting in VARIATIONS.items():
        naive, shaped = pair(stored, name)
        if setting.sole == "compliant" and setting.stabilizer:
            assert shaped / naive == pytest.approx(1.0, abs=0.1), name
    assert [ratio(stored, BASES[1]) < 0.7, ratio(stored, "rigid, servos 1/2 as stiff") > 1.0] == [True, True]
    fits = {(line[0], line[1]): (line[2], float(line[6].removesuffix(" %"))) for line in nearest_pairs(stored).rows}
    assert fits[BASES[1], f"{LONG:g}"][0] == "1"
    assert fits[FITTED, f"{SHORT:g}"][0] == "3"
    assert next(iter(fits)) == (BASES[1], f"{LONG:g}"), "the nearest of all is the simplest"
    assert 10.0 < fits[FITTED, f"{SHORT:g}"][1] <= 20.0, "nearest by rubber alone, but the naive landing is too soft"
    for swing in landing_study.SWINGS:
        plain, held = (at(stored, Point(name, *swing)) for name in (BASES[0], "rubber, landing control"))
        assert (held.touch_down < plain.touch_down) == (swing[1] == LONG)
        assert held.peak < plain.peak


def ratio(rows, variation):
    """Shaped over naive peak, in the same time."""
    naive, shaped = pair(rows, variation)
    return shaped / naive


def test_agreement_is_about_motion_and_forces(stored):
    point = Point(BASES[0], SHAPED, LONG)
    row = at(stored, point)
    values = dict.fromkeys(("time", "raw", "force"), np.zeros(0)) | {"weight": 560.0, "fell": ""}
    numbers = {name: getattr(row, name) for name in landing_study.MEASURED}
    for more, verdict in ((0.0, YES), (1.0, NEARLY), (100.0, NO)):
        found = landing_study.Landing(**values, **(numbers | {"peak": row.peak + more}))
        assert agreement_of([row], point, found) == verdict
        assert agreement_of([dataclasses.replace(row, motion="0" * 64)], point, found) == NO
    with pytest.raises(KeyError):
        at(stored, Point("on the moon", SHAPED, LONG))


def test_higher_obstacles_have_swings_too(robot):
    motion = landing_motion(robot, Obstacle(0.10, 0.05), NAIVE)
    assert 0.13 < motion.foot(-1)[:, 2].max() < 0.22
    assert pose(np.zeros((1, 3))).shape == (1, 7)
