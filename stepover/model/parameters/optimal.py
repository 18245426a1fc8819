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
        0.60, "share", "the same after leg 1 has landed: there the stabilizer needs most", least=0.1
    )
    landed: float = parameter(0.35, "s", "how long after that")
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

    # Weights of the cost.
    weight_zmp: float = parameter(3.3, "1/m", "distance of the ZMP from the middle of the sole")
    weight_zmp_over: float = parameter(1.0, "1/m", "the same ahead and behind, around the double support over it")
    weight_zmp_around: float = parameter(0.25, "s", "how long before and after")
    weight_yaw: float = parameter(0.005, "1/(N m)", "moment about the vertical")
