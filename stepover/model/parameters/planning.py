"""What robot.toml says of the robot and to the planner, as frozen dataclasses: every field with its unit."""

from __future__ import annotations

import types
from dataclasses import dataclass

Pair = tuple[float, float]


@dataclass(frozen=True)
class Legs:
    """The joints of the legs, from the hip to the sole, and the knees among them."""

    right: tuple[str, ...]
    left: tuple[str, ...]
    knee: tuple[str, ...]


@dataclass(frozen=True)
class Foot:
    """The right foot, seen from the ankle; the left one mirrors y. All in m."""

    ankle_height: float
    sole_length: float
    heel: float
    toe: float
    contact_x: Pair
    contact_y: Pair


@dataclass(frozen=True)
class Outline:
    """The leg of Fig. 1 in the knee's frame: (x ahead, z up along the shank), in m."""

    front: tuple[Pair, ...]
    rear: tuple[Pair, ...]


@dataclass(frozen=True)
class Posture:
    """Half-sitting: where every motion begins and ends. Lengths in m, angles in degrees."""

    waist_height: float
    feet_apart: float
    angles_deg: types.MappingProxyType[str, float]


@dataclass(frozen=True)
class UpperBody:
    """Joints of the upper body that the planner moves, and how (Sec. III-D). Times as shares of a swing."""

    chest_yaw: str
    shoulders: tuple[str, ...]
    arm_swing_max_deg: float
    arm_swing_sizes: int
    arms_start: float
    arms_back: float
    arms_forth: float
    knee_spare_deg: float


@dataclass(frozen=True)
class Walk:
    """Timing in s, lengths in m (Sec. V)."""

    sample_time: float
    step_length: float
    step_length_min: float
    step_length_max: float
    single_support: float
    double_support: float
    single_support_over: float
    single_support_leg_2: float
    double_support_over: float
    standing: float
    lift: float


@dataclass(frozen=True)
class Feasibility:
    """Search of the key configuration (Sec. III-A). Lengths in m, angles in degrees, delta_ds a factor."""

    delta_ds: float
    knee_margin_deg: float
    step_length_max: float
    step_length_more: float
    step_length_more_step: float
    step_length_step: float
    waist_height_min: float
    waist_height_step: float
    foothold_clearance: float
    spare: float
    waist_yaw_deg: float


@dataclass(frozen=True)
class SteppingOver:
    """Shape of the feet trajectories (Sec. III-B). Times as shares of the single support, lengths in m."""

    rest: float
    leg1_rise: float
    leg1_top: float
    leg1_descent: float
    leg1_extra_lift: float
    leg1_pitch_deg: float
    landing_points: int
    leg2_rise: float
    leg2_descent: float
    leg2_descent_drop: float
    leg2_held: int
    leg2_pitch_start: float
    leg2_pitch_full: float
    leg2_pitch_per_height_deg: float
    leg2_extra_lift: float
    landing_step: float


@dataclass(frozen=True)
class Preview:
    """Preview control (Sec. III-C2): window in samples, weights without unit, com_height in m, filter_fade in s."""

    window: int
    zmp_weight: float
    jerk_weight: float
    com_height: float
    filter_passes_max: int
    filter_fade: float


@dataclass(frozen=True)
class Adaptor:
    """Feet trajectory adaptor (Sec. III-E). Lengths in m, times as shares of the single support."""

    spare: float
    look_every: int
    shift_step: float
    shift_max: float
    shift_peak: float
    raise_step: float
    raise_max: float
    raise_peak: float
    push_max: float
    push_step: float
    push_total: float
    push_rounds: int
    push_width: float
    push_taper: float
    damping: float


@dataclass(frozen=True)
class Beyond:
    """What is added beyond the paper where its own methods do not reach; lengths in m, times as shares.

    Level n uses all of it with zmp_toe[n - 1]. waist_delay is in s.
    """

    zmp_toe: tuple[float, ...]
    zmp_heel: float
    zmp_heel_from: float
    zmp_ahead: float
    zmp_toe_at: float
    zmp_heel_until: float
    zmp_ahead_at: float
    leg2_rise: float
    leg2_descent: float
    leg2_descent_drop: float
    leg2_pitch_start: float
    leg2_pitch_full: float
    leg2_pitch_per_height_deg: float
    waist_delay: float


@dataclass(frozen=True)
class Verdict:
    """What a planned motion must keep, or it is refused: degrees, m."""

    knee_margin_deg: float
    zmp_margin: float
    self_look_every: int


@dataclass(frozen=True)
class QuasiStatic:
    """The quasi-static baseline (Sec. II-A): lengths in m, times in s, angles in degrees, shares of a leg's way."""

    clearance: float
    com_ahead: float
    com_behind: float
    com_parts: int
    step_length_step: float
    waist_height_step: float
    places: int
    place_max: float
    tries: int
    knee_spare_deg: float
    spare: float
    search_rounds: int
    rounds: int
    look: int
    raises: tuple[float, ...]
    leg1_rise: float
    leg1_descent: float
    leg1_extra_lift: float
    lower_from: float
    lower_until: float
    leg2_rise: float
    leg2_descent: float
    leg2_over: float
    leg2_extra_lift: float
    leg2_pitch_start: float
    leg2_pitch_full: float
    leg2_pitches_deg: tuple[float, ...]
    leg2_backs: tuple[float, ...]
    raise_from: float
    raise_until: float
    swing_time: float
    swing_samples: int
