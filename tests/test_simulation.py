"""The physics: what it measures, what it explains, and that it is the same each time."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from stepover.errors import InvalidInput
from stepover.model import pose
from stepover.model.robot import Robot
from stepover.motion.motion import Motion
from stepover.simulation.engine import Scene
from stepover.simulation.measurements import Run, Series
from stepover.simulation.pybullet.world import World, pybullet
from stepover.simulation.run import simulate

PROMISED = [
    "fell", "fall_time", "fall_reason", "obstacle_contacts", "clearance_min", "clearance_link", "zmp_rms",
    "landing_force_peak", "waist_error_max", "torque_ratio_max", "speed_ratio_max", "torque_saturated_samples",
    "actuators", "sole", "stabilizer", "duration", "realtime_factor", "state_hash",
]  # fmt: skip


@pytest.fixture(scope="module")
def run(motion: Motion, robot: Robot) -> Run:
    """The 15 cm case in the physics."""
    return simulate(motion, robot=robot)


@pytest.fixture(scope="module")
def standing(motion: Motion) -> Motion:
    """The first 0.6 s of the motion, in which it stands still."""
    return shortened(motion, 0, 120)


def shortened(motion: Motion, first: int, last: int) -> Motion:
    """Some samples of a motion."""
    arrays = {f.name: getattr(motion, f.name) for f in fields(motion)}
    along = {name for name, value in arrays.items() if np.shape(value)[:1] == np.shape(motion.time)}
    return replace(motion, **{name: arrays[name][first:last] for name in along})


def test_robot_crosses_as_planned(run: Run) -> None:
    assert run.crossed
    assert run.explanation == ""
    assert run.clearance_min >= 0.025
    assert run.waist_error_max <= 0.010
    assert run.duration == pytest.approx(run.motion.time[-1] - run.motion.time[0])
    assert np.isnan(run.series.obstacle_depth).all()


def test_clearance_series_is_a_bound_of_the_exact_one(run: Run) -> None:
    assert run.series.clearance.min() <= run.clearance_min + 1e-9
    assert run.series.clearance.min() >= run.clearance_min - 0.01


def test_measured_feet_are_where_they_were_planned(run: Run) -> None:
    series, motion = run.series, run.motion
    for measured, planned in ((series.left_foot, motion.left_foot), (series.right_foot, motion.right_foot)):
        assert np.abs(measured[:, :3] - planned[:, :3]).max() < 0.01


def test_zmp_is_near_the_plan_and_inside_the_soles(run: Run, motion: Motion) -> None:
    error = np.abs(run.series.zmp - motion.zmp_reference)
    assert np.nanmedian(error, axis=0).max() < 0.005
    assert np.sqrt(np.nanmean(error**2, axis=0)) == pytest.approx(run.zmp_rms)
    assert max(run.zmp_rms) < 0.03
    assert np.nanpercentile(run.series.zmp_margin, 1) > 0.01


def test_floor_bears_the_weight_while_standing(run: Run, robot: Robot) -> None:
    still = slice(100, 240)
    forces = run.series.left_wrench[still, 2] + run.series.right_wrench[still, 2]
    assert forces.mean() == pytest.approx(robot.body.mass * 9.81, rel=1e-3)


def test_friction_forces_push_the_centre_of_mass(run: Run, robot: Robot) -> None:
    forces = (run.series.left_wrench + run.series.right_wrench)[1:, :3]
    impulse = np.cumsum(forces - [0.0, 0.0, robot.body.mass * 9.81], axis=0) * run.motion.dt
    speed = np.gradient(run.series.com, run.motion.dt, axis=0)[1:]
    smooth = slice(150, 1000)
    assert np.abs(impulse[smooth, :2] / robot.body.mass - speed[smooth, :2]).max() < 0.02
    assert np.ptp(speed[smooth, 1]) > 0.1


def test_landing_forces_are_at_least_the_weight_that_is_taken_over(run: Run, robot: Robot) -> None:
    for force in run.landing_force_peak.values():
        assert 0.9 * robot.body.mass * 9.81 < force < 3.0 * robot.body.mass * 9.81


def test_limits_are_compared_with_the_urdf(run: Run, robot: Robot) -> None:
    torques = np.abs(run.series.torque) / robot.body.effort_limits
    assert run.torque_ratio_max == pytest.approx(torques.max())
    assert sum(run.torque_saturated_samples.values()) == (torques >= 1.0).sum()
    speeds = np.abs(run.series.dq) / robot.body.speed_limits
    assert run.speed_ratio_max == pytest.approx(speeds.max())
    assert sum(run.speed_violation_samples.values()) == (speeds > 1.0).sum() > 0


def test_two_runs_are_equal_to_the_bit(run: Run, motion: Motion, robot: Robot) -> None:
    again = simulate(motion, robot=robot)
    assert again.state_hash == run.state_hash
    assert all(np.array_equal(getattr(again.series, f.name), getattr(run.series, f.name), True) for f in fields(Series))


def test_json_is_what_the_interface_promises(run: Run) -> None:
    numbers = run.to_json()
    assert list(numbers) == ["crossed", *PROMISED, "speed_violation_samples", "perturb", "engine"]
    assert json.loads(json.dumps(numbers, allow_nan=False)) == numbers
    assert numbers["crossed"] is True
    spoilt = replace(run, zmp_rms=[float("nan"), 0.0], landing_force_peak={"first": float("nan"), "second": 1.0})
    assert spoilt.to_json()["zmp_rms"] == [None, 0.0]
    assert spoilt.to_json()["landing_force_peak"]["first"] is None


def test_world_knows_the_robot(robot: Robot, motion: Motion) -> None:
    q = motion.q[700].copy()
    q[3:7] = pose.Rotation.from_euler("zyx", [0.7, 0.2, -0.3]).as_quat()
    with World(Scene(robot, (motion.obstacle,))) as world:
        body = world.robot
        masses = [pybullet.getDynamicsInfo(body.number, link, world.client)[0] for link in body.links]
        assert sum(masses) == pytest.approx(robot.body.mass, rel=1e-9)
        world.reset(q)
        np.testing.assert_allclose(world.base_pose(), q[:7], atol=1e-12)
        angles, speeds = world.joints()
        np.testing.assert_allclose(angles, q[7:], atol=1e-12)
        assert not speeds.any()
        placed = robot.body.placements(q[None])
        for name, index in zip(robot.body.joint_names, body.joints, strict=True):
            frame = pybullet.getLinkState(body.number, index, 0, 1, world.client)[4]
            np.testing.assert_allclose(frame, placed.positions[0, robot.body.index(name)], atol=1e-6)
        centres = [pybullet.getBasePositionAndOrientation(body.number, world.client)[0]]
        centres += [pybullet.getLinkState(body.number, i, 0, 1, world.client)[0] for i in list(body.links)[1:]]
        np.testing.assert_allclose(np.average(centres, axis=0, weights=masses), robot.body.com(placed)[0], atol=1e-6)


def test_a_higher_obstacle_is_hit_and_explained(motion: Motion, robot: Robot) -> None:
    rows = motion.obstacles.copy()
    rows[0, 2] += 0.05
    over = motion.samples(1)
    run = simulate(shortened(replace(motion, obstacles=rows), 0, over.stop), robot=robot)
    assert not run.crossed
    assert run.obstacle_contacts > 0
    assert run.clearance_min < 0.0
    assert run.contact_reason is not None
    for part in ("RLEG_LINK5", "mm deep", "the left foot bears", "phase 1", "ZMP margin"):
        assert part in run.contact_reason
    touched = np.flatnonzero(np.isfinite(run.series.obstacle_depth))[0]
    assert f"t = {run.series.time[touched]:.3f} s" in run.contact_reason


def test_what_is_no_motion_and_no_robot_is_refused(motion: Motion) -> None:
    with pytest.raises(InvalidInput, match="motion must be of type Motion, not str: give what plan"):
        simulate("motion.npz")  # type: ignore[arg-type]
    with pytest.raises(InvalidInput, match="robot must be of type Robot, not str"):
        simulate(motion, robot="hrp2")  # type: ignore[arg-type]


def test_obstacle_can_be_left_out(motion: Motion, robot: Robot) -> None:
    front = replace(motion, obstacles=np.array([[-0.05, 0.1, 0.3, 0.0, 0.0, 1.0, 0.0]]))
    run = simulate(shortened(front, 0, 10), robot=robot, obstacle=False)
    assert run.crossed
    assert run.clearance_min < 0.0


def test_a_mirrored_sway_falls_and_explains(motion: Motion, robot: Robot) -> None:
    waist = motion.q.copy()
    waist[:, 1] *= -1.0
    feet = replace_legs(robot, motion, waist)
    run = simulate(feet, robot=robot)
    assert run.fell
    assert not run.crossed
    assert run.fall_time is not None
    assert run.fall_time < 3.5
    assert run.fall_reason is not None
    assert run.fall_reason.startswith(f"fell at t = {run.fall_time:.3f} s: ")
    for part in ("by the plan the left foot bears", "walking", "last ZMP margin"):
        assert part in run.fall_reason
    assert run.series.time[-1] == pytest.approx(run.fall_time + robot.simulation.after_fall)
    assert run.to_json()["landing_force_peak"] == {"first": None, "second": None}


def replace_legs(robot: Robot, motion: Motion, q: np.ndarray) -> Motion:
    """The motion with another waist, the feet where they were."""
    short = shortened(motion, 0, 700)
    q = q[:700].copy()
    for side in (1, -1):
        leg = robot.leg(side)
        q[:, leg.columns] = leg.attempt(q[:, :7], short.foot(side))[0]
    return replace(short, q=q, waist=q[:, :7])


@pytest.mark.parametrize(
    "option", [{"actuators": "magic"}, {"sole": "soft"}, {"stabilizer": "yes"}, {"perturb": {"gravity": 0.0}}]
)
def test_unknown_options_are_refused(standing: Motion, option: dict) -> None:
    with pytest.raises(InvalidInput, match="available"):
        simulate(standing, **option)


def test_foreign_motions_are_refused(standing: Motion, robot: Robot) -> None:
    with pytest.raises(InvalidInput, match="joints"):
        simulate(replace(standing, joint_names=standing.joint_names[::-1]), robot=robot)
    with pytest.raises(InvalidInput, match="multiple"):
        simulate(replace(standing, time=standing.time * 1.1), robot=robot)


def test_progress_ends_at_one(standing: Motion, robot: Robot) -> None:
    shares: list[float] = []
    simulate(standing, robot=robot, progress=shares.append)
    assert shares[-1] == 1.0
    assert shares == sorted(shares)


def test_nothing_is_printed(tmp_path: Path, standing: Motion) -> None:
    standing.save(tmp_path / "m.npz")
    code = f"""
from stepover import Motion, simulate
motion = Motion.load({str(tmp_path / "m.npz")!r})
simulate(motion)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")
