"""Parameters of the optimising planner, as a frozen dataclass. The defaults are HRP-2's; a share is of a limit."""

from __future__ import annotations

from dataclasses import dataclass

from stepover.model.parameters.entry import parameter


@dataclass(frozen=True)
class Optimal:
    """Reserves, resolution and weights of the optimising planner: the same for all obstacles."""

    # Reserves: what a servo, rubber soles and the stabilizer may use up.
    speed_share: float = parameter(0.80, "share", "largest joint speed: the stabilizer adds to it", least=0.1)
    torque_share: float = parameter(0.85, "share", "largest joint torque: a landing adds to it", least=0.1)
    torque_share_landed: float = parameter(
        0.52, "share", "the same after leg 1 has landed: there the stabilizer needs most", least=0.1
    )
    landed: float = parameter(0.45, "s", "how long after that")
    torque_share_upper: float = parameter(
        0.50, "share", "largest torque of chest and arms: what hangs on them must not swing", least=0.1
    )
    zmp_margin: float = parameter(0.0175, "m", "least distance of the ZMP from the support polygon's edge")
    zmp_margin_landing: float = parameter(0.040, "m", "the same while a foot touches down")
    landing_speed: float = parameter(
        0.27, "m/s", "largest vertical speed of a sole 10 mm above the floor: as Algorithm 1 at 25 cm"
    )
    clearance: float = parameter(0.005, "m", "distance from the obstacle's margins", sign="not negative")
    knee_deg: float = parameter(10.0, "deg", "least angle of the knee from straight", scale="knee")
    knee_stance_deg: float = parameter(
        25.0, "deg", "the same of a leg that bears: nearer to straight, the stabilizer cannot lower it", scale="knee"
    )
    knee_stance_around: float = parameter(0.12, "s", "how long before and after it bears a leg counts as bearing")
    joint_margin_deg: float = parameter(0.5, "deg", "least distance of a joint from its limit")
    lean_deg: float = parameter(25.0, "deg", "largest roll and pitch of the waist")
    own_distance: float = parameter(0.010, "m", "least distance between legs, and of arms from trunk and legs")
    trunk_distance: float = parameter(0.005, "m", "least distance of the thighs from trunk and chest")
    friction: float = parameter(0.4, "", "largest horizontal over vertical force: half of what rubber holds")
    yaw_moment: float = parameter(15.0, "N m", "largest moment about the vertical through the ZMP", scale="mass")
    force_min: float = parameter(0.6, "", "least vertical force over the weight")
    force_max: float = parameter(1.35, "", "largest vertical force over the weight")
    force_max_landed: float = parameter(
        1.10, "", "the same after leg 1 has landed: on rubber the force swings over by half as much again"
    )
    sole_lift: float = parameter(0.012, "m", "least height of a swinging sole, 0.16 s from its ends")

    # Base motion.
    step_length: float = parameter(0.56, "m", "X_ads of the base motion; wide obstacles need more", scale="leg")
    waist_height: float = parameter(0.58, "m", "Z_hds of the base motion", scale="waist")
    base_height: float = parameter(0.15, "m", "obstacle that the base motion's feet clear, at most", scale="leg")
    chain_height: float = parameter(0.40, "m", "height at which a chain of obstacles begins", scale="leg")
    chain_width: float = parameter(0.05, "m", "width at which it begins")

    # Resolution.
    look_every: float = parameter(0.02, "s", "time between the samples at which constraints are kept")
    look_near: float = parameter(0.02, "s", "around lift-off and touch-down, all samples: so long before and after")
    knots_travel: float = parameter(0.06, "s", "time between the knots of the waist's x and y")
    knots_height: float = parameter(0.10, "s", "the same of the waist's z")
    knots_turn: float = parameter(0.12, "s", "the same of the waist's rotations")
    knots_foot: float = parameter(0.10, "s", "the same of a swinging foot")
    knots_upper: float = parameter(0.15, "s", "the same of chest and arms")

    # Durations of the single supports over the obstacle, where others than the robot's own are asked for.
    duration_least: float = parameter(0.70, "s", "shortest one: a little less than the paper's normal step takes")
    duration_most: float = parameter(1.50, "s", "longest one: the paper's")
    duration_step: float = parameter(0.05, "s", "to so much the shortest one that works is found")

    # Search.
    height_step: float = parameter(0.05, "m", "the height grows by so much from one solved problem to the next")
    width_step: float = parameter(0.07, "m", "the width grows by so much")
    iterations: int = parameter(40, "count", "largest number of iterations for one problem")
    penalty: float = parameter(3.0, "", "cost of a violated constraint, scaled by its own unit")
    trust: float = parameter(0.10, "", "first size of the trust region, in units of each variable's own")
    tolerance: float = parameter(5e-3, "", "largest scaled violation that counts as kept")
    rounds: int = parameter(6, "count", "how often samples between the looked-at ones may be added")

    # Weights of the cost. Lengths count in units of the leg, moments in units of the mass.
    weight_zmp: float = parameter(3.3, "1/m", "distance of the ZMP from the middle of the sole", scale="1/leg")
    weight_zmp_over: float = parameter(
        1.0, "1/m", "the same ahead and behind, around the double support over the obstacle", scale="1/leg"
    )
    weight_zmp_around: float = parameter(0.25, "s", "how long before and after")
    weight_yaw: float = parameter(0.005, "1/(N m)", "moment about the vertical", scale="1/mass")
    weight_waist_travel: float = parameter(0.015, "s^2/m", "acceleration of the waist in x and y", scale="1/leg")
    weight_waist_height: float = parameter(0.024, "s^2/m", "the same in z", scale="1/leg")
    weight_waist_yaw: float = parameter(0.006, "s^2", "acceleration of its yaw")
    weight_waist_tilt: float = parameter(0.009, "s^2", "the same of its roll and pitch")
    weight_sole_travel: float = parameter(0.006, "s^2/m", "acceleration of a sole in x and z", scale="1/leg")
    weight_sole_aside: float = parameter(0.015, "s^2/m", "the same in y: a swing aside costs more", scale="1/leg")
    weight_sole_turn: float = parameter(0.006, "s^2", "acceleration of its yaw and roll")
    weight_sole_pitch: float = parameter(0.0036, "s^2", "the same of its pitch, which clears the obstacle")
    weight_trunk: float = parameter(0.006, "s^2", "acceleration of the trunk's joints, and of the elbows")
    weight_shoulders: float = parameter(0.003, "s^2", "the same of the shoulders' pitch")
    stay_waist_height: float = parameter(0.09, "1/m", "deviation of the waist's z from the base motion", scale="1/leg")
    stay_waist_tilt: float = parameter(0.15, "", "the same of its roll and pitch")
    stay_sole_aside: float = parameter(0.09, "1/m", "the same of a sole's y", scale="1/leg")
    stay_sole_turn: float = parameter(0.09, "", "the same of its yaw and roll")
    stay_trunk: float = parameter(0.09, "", "the same of the trunk's joints, and of the elbows")
    stay_chest_yaw: float = parameter(0.03, "", "the same of the chest about the vertical, which is free to follow")
    stay_shoulders: float = parameter(0.045, "", "the same of the shoulders' pitch")
    weight_variable: float = parameter(0.003, "", "each variable itself, so that all are determined")
