"""Parameters of Algorithm 1 and of the checks of a finished motion, as frozen dataclasses.

The defaults are HRP-2's. Step lengths, lifts and waist heights scale with the leg. Offsets of the ZMP scale with the
part of the sole ahead of the ankle or behind it. Other values do not scale: shares and times; distances that keep an
obstacle's margin or make up for coarse sampling; and the resolution of a search.
"""

from __future__ import annotations

from dataclasses import dataclass

from stepover.model.parameters.entry import MODEL, parameter


def samples(duration: float, dt: float) -> int:
    """Number of samples of dt [s] in a duration [s]: a whole number, at least one."""
    return max(round(duration / dt), 1)


@dataclass(frozen=True)
class Walk:
    """Steps and their timing (Sec. V)."""

    sample_time: float = parameter(
        0.005,
        "s",
        "time between samples of the plan",
        source="P [13]",
        least=2e-4,
        below=("double_support", "double_support_over"),
    )
    step_length: float = parameter(0.20, "m", "length of a normal step", source="P II-C", scale="leg")
    step_length_min: float = parameter(
        0.10, "m", "shortest stretched step before the obstacle", scale="leg", below=("step_length_max",)
    )
    step_length_max: float = parameter(0.25, "m", "longest stretched step before the obstacle", scale="leg")
    single_support: float = parameter(0.78, "s", "single support of a normal step", source="P V")
    double_support: float = parameter(
        0.02, "s", "double support of a normal step", source="P V", below=("single_support",)
    )
    single_support_over: float = parameter(
        1.5, "s", "single support of leg 1 and of the steps before and after the obstacle", source="P V"
    )
    single_support_leg_2: float = parameter(1.5, "s", "single support of leg 2's swing", source="P V")
    double_support_over: float = parameter(
        0.04, "s", "double support of the steps over the obstacle", source="P V", below=("single_support_over",)
    )
    standing: float = parameter(
        1.6, "s", "time at rest before the first and after the last step: the preview window", source="D [13]"
    )
    lift: float = parameter(0.06, "m", "lift of the foot in a normal step", scale="leg")


@dataclass(frozen=True)
class Feasibility:
    """Search of the key configuration (Sec. III-A)."""

    delta_ds: float = parameter(0.5, "", "X_hds / X_ads, Eq. (22)", source="P III-A", most=1.0)
    knee_margin_deg: float = parameter(
        15.0,
        "deg",
        "least angle of the knee from straight in the key configuration",
        source="P S2",
        scale="knee",
        sign="not negative",
    )
    step_length_max: float = parameter(0.60, "m", "longest X_ads tried", source="P S2", scale="leg")
    step_length_more: float = parameter(
        0.06, "m", "longer X_ads tried if the legs do not reach along the path: up to this much more", scale="leg"
    )
    step_length_more_step: float = parameter(0.01, "m", "resolution of these longer steps")
    step_length_step: float = parameter(0.005, "m", "resolution of the search over X_ads", below=("step_length_max",))
    waist_height_min: float = parameter(0.50, "m", "lowest Z_hds tried", scale="waist")
    waist_height_step: float = parameter(0.005, "m", "resolution of the search over Z_hds")
    foothold_clearance: float = parameter(
        0.004, "m", "distance of toe and heel from the margins: the upper edges of a pitched foot reach further",
        sign="not negative",
    )  # fmt: skip
    spare: float = parameter(
        0.003,
        "m",
        "extra distance from the margins, since the waist moves on in the double support",
        sign="not negative",
    )
    waist_yaw_deg: float = parameter(
        25.0, "deg", "turn of the waist that brings the leading hip ahead (III-C3)", source="P S2", sign="not negative"
    )


@dataclass(frozen=True)
class SteppingOver:
    """Shape of the feet trajectories (Sec. III-B). Shares are of the single support."""

    rest: float = parameter(
        0.05, "share", "time at the beginning and the end in which x, y and yaw rest", source="P S2",
        below=("leg1_rise", "leg2_rise"),
    )  # fmt: skip
    leg1_rise: float = parameter(
        0.40, "share", "toe at the front margin, foot as high as the obstacle with its margin", source="P S2",
        below=("leg1_top",),
    )  # fmt: skip
    leg1_top: float = parameter(0.57, "share", "time of the highest point", source="P S2", below=("leg1_descent",))
    leg1_descent: float = parameter(
        0.74, "share", "time when the foot is above its landing point, at the obstacle's height", source="P S2"
    )
    leg1_extra_lift: float = parameter(
        0.04, "m", "height of the highest point above the obstacle with its margin", source="P S2", sign="not negative"
    )
    leg1_pitch_deg: float = parameter(-2.0, "deg", "pitch at landing: heel first", source="P S2", sign="any")
    landing_points: int = parameter(10, "count", "control points of the low-speed landing", source="P S2")
    leg2_rise: float = parameter(
        0.20, "share", "time when the toe is before the front margin", source="P S2", below=("leg2_descent",)
    )
    leg2_descent: float = parameter(0.60, "share", "time when the heel is behind the rear margin", source="P S2")
    leg2_descent_drop: float = parameter(
        0.0, "share", "part of the toe's drop by which the foot has come down by then", sign="not negative"
    )
    leg2_held: int = parameter(4, "count", "control points that hold the foot's height between rise and descent")
    leg2_pitch_start: float = parameter(
        0.05, "share", "time when the toe-down pitch begins", below=("leg2_pitch_full",)
    )
    leg2_pitch_full: float = parameter(
        0.25, "share", "time of the full toe-down pitch: the shank is past the obstacle's edge", below=("leg2_descent",)
    )
    leg2_pitch_per_height_deg: float = parameter(
        120.0, "deg/m", "toe-down pitch per height of the obstacle with its margin", source="P S2", sign="not negative"
    )
    leg2_extra_lift: float = parameter(
        0.01, "m", "height of the toe above the obstacle with its margin", source="P S2", sign="not negative"
    )
    landing_step: float = parameter(
        0.20, "m", "distance by which leg 2 lands ahead of leg 1", source="P S2", scale="leg"
    )


@dataclass(frozen=True)
class Preview:
    """Preview control and the dynamic filter (Sec. III-C2)."""

    window: float = parameter(
        1.6, "s", "time for which the ZMP reference is known in advance", source="P S1", most=10.0
    )
    zmp_weight: float = parameter(1.0, "", "weight Q of the ZMP error", source="P S1")
    jerk_weight: float = parameter(1e-6, "", "weight R of the jerk", source="P S1")
    com_height: float = parameter(
        0.814, "m", "z_c: height of the centre of mass above the floor in half-sitting", source="P S1", scale=MODEL
    )
    filter_passes_max: int = parameter(
        4, "count", "largest number of passes of the filter, Eq. (19); one pass if nothing is adapted"
    )
    filter_fade: float = parameter(0.5, "s", "time over which the filter fades in at the start")


@dataclass(frozen=True)
class Adaptor:
    """Feet trajectory adaptor (Sec. III-E). Shares are of leg 2's swing.

    Its distances depend on how deep a leg is inside the obstacle's margin, so they do not scale.
    """

    spare: float = parameter(
        0.0015, "m", "extra distance from the margin, since the filter moves the waist later", sign="not negative"
    )
    look_every: float = parameter(
        0.025, "s", "time between the postures tested in the search; the final checks test all", most=0.2
    )
    shift_step: float = parameter(0.027, "m", "method (1): step of the search")
    shift_max: float = parameter(0.405, "m", "method (1): largest shift")
    shift_peak: float = parameter(0.22, "share", "method (1): time of the largest shift, a knot of its spline")
    raise_step: float = parameter(0.01, "m", "method (2): step of the search")
    raise_max: float = parameter(0.08, "m", "method (2): largest raise of the waist")
    raise_peak: float = parameter(0.40, "share", "method (2): time of the largest raise, a knot of its spline")
    push_max: float = parameter(0.01, "m", "method (3): deepest penetration that it corrects")
    push_step: float = parameter(0.01, "m", "method (3): largest dS of a round; dS is small (III-E3)")
    push_total: float = parameter(0.06, "m", "method (3): largest displacement of the ankle")
    push_rounds: int = parameter(12, "count", "method (3): largest number of rounds")
    push_width: float = parameter(0.20, "share", "time over which a push is spread")
    push_taper: float = parameter(0.10, "share", "time in which a push grows after lift-off and fades before landing")
    damping: float = parameter(0.02, "m", "damping of the inverse of J_s")


@dataclass(frozen=True)
class LateSwing:
    """Later control points of FTG, for obstacles over which the knees do not reach with those of SteppingOver.

    Leg 1 comes down later, and faster: so FTG takes the earliest descent that reaches. Leg 2's six values replace those
    of SteppingOver.
    """

    leg1_descent: tuple[float, ...] = parameter(
        (0.78, 0.84),
        "share",
        "times when leg 1's foot is above its landing point, at the obstacle's height, in the order of their trial; "
        "the highest point is later in proportion",
    )
    leg2_rise: float = parameter(0.25, "share", "time when the toe is before the front margin", below=("leg2_descent",))
    leg2_descent: float = parameter(0.67, "share", "time when the heel is behind the rear margin")
    leg2_descent_drop: float = parameter(
        0.50, "share", "part of the toe's drop by which the foot has come down by then", sign="not negative"
    )
    leg2_pitch_start: float = parameter(
        0.088, "share", "time when the toe-down pitch begins", below=("leg2_pitch_full",)
    )
    leg2_pitch_full: float = parameter(0.297, "share", "time of the full toe-down pitch", below=("leg2_descent",))
    leg2_pitch_per_height_deg: float = parameter(
        144.0, "deg/m", "toe-down pitch per height of the obstacle with its margin", sign="not negative"
    )


@dataclass(frozen=True)
class BeyondPaper:
    """Methods added beyond the paper, for obstacles that its own methods cannot cross.

    Level n uses all of them, with zmp_toe[n - 1].
    """

    zmp_toe: tuple[float, ...] = parameter(
        (0.062, 0.080), "m", "ZMP reference ahead of the ankle at the end of phase 1: level 1, level 2", scale="toe"
    )
    zmp_heel: float = parameter(0.062, "m", "ZMP reference behind the ankle when phase 3 begins", scale="heel")
    zmp_heel_from: float = parameter(
        0.0, "share", "part of leg 2's swing from which zmp_heel holds; 0: from lift-off", sign="not negative",
        below=("zmp_heel_until",),
    )  # fmt: skip
    zmp_ahead: float = parameter(0.010, "m", "ZMP reference ahead of the ankle later in phase 3", scale="toe")
    zmp_toe_at: float = parameter(0.50, "share", "part of leg 1's swing at which zmp_toe is reached")
    zmp_heel_until: float = parameter(
        0.26, "share", "part of leg 2's swing until which zmp_heel holds", below=("zmp_ahead_at",)
    )
    zmp_ahead_at: float = parameter(0.65, "share", "part of leg 2's swing at which zmp_ahead is reached")
    waist_delay: float = parameter(
        0.0, "s", "delay of the waist's lowest point after the double support", sign="not negative"
    )


@dataclass(frozen=True)
class Checks:
    """Limits for every finished motion. A motion that exceeds one is rejected."""

    knee_margin_deg: float = parameter(
        5.0, "deg", "least angle of the knee from straight along the whole motion", scale="knee", sign="not negative"
    )
    zmp_margin: float = parameter(
        0.015, "m", "least distance of the ZMP from the support polygon's edge: safe on any sole"
    )
    self_look_every: float = parameter(
        0.020, "s", "time between the postures tested for collisions of the robot with itself", most=0.2
    )
