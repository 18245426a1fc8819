"""What robot.toml says, as frozen dataclasses: every field with its unit, every value checked as it is read."""

from __future__ import annotations

import sys
import types
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from stepover.errors import InvalidInput

Section = TypeVar("Section")
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

    Level n uses all of it with zmp_toe[n - 1].
    """

    zmp_toe: tuple[float, ...]
    zmp_heel: float
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


@dataclass(frozen=True)
class Verdict:
    """What a planned motion must keep, or it is refused: degrees, m."""

    knee_margin_deg: float
    zmp_margin: float
    self_look_every: int
    slowings: int


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


@dataclass(frozen=True)
class Simulation:
    """The physics. Times in s, torques in N m, lengths in m, angles in degrees; friction and shares without unit."""

    time_step: float
    solver_iterations: int
    friction: float
    ideal_motor_torque: float
    ideal_motor_correction: float
    loaded_share: float
    landing_window: float
    fall_tilt_deg: float
    fall_drop: float
    after_fall: float


SIGNED = {"contact_x", "contact_y", "front", "rear", "angles_deg", "leg1_pitch_deg"}
"""Keys whose values may be negative; all others must be positive, or zero where ZERO says so."""
ZERO = {
    "arms_start",
    "foothold_clearance",
    "knee_margin_deg",
    "leg1_extra_lift",
    "leg2_descent_drop",
    "leg2_extra_lift",
    "leg2_pitch_per_height_deg",
    "spare",
    "waist_yaw_deg",
}
RISING = (
    ("sample_time", "double_support", "single_support"),
    ("sample_time", "double_support_over", "single_support_over"),
    ("step_length_min", "step_length_max"),
    ("step_length_step", "step_length_max"),
    ("rest", "leg1_rise", "leg1_top", "leg1_descent"),
    ("rest", "leg2_rise", "leg2_descent"),
    ("leg2_pitch_start", "leg2_pitch_full", "leg2_descent"),
    ("arms_start", "arms_back"),
    ("zmp_heel_until", "zmp_ahead_at"),
    ("leg2_rise", "leg2_descent", "leg2_over"),
    ("leg2_pitch_full", "leg2_descent"),
    ("lower_from", "lower_until"),
    ("raise_from", "raise_until"),
)
"""Keys of one table whose values must rise from each to the next."""
SHARES = {
    "rest", "leg1_descent", "leg2_descent", "arms_back", "arms_forth", "shift_peak", "raise_peak", "zmp_toe_at",
    "zmp_ahead_at", "loaded_share",
}  # fmt: skip
"""Keys whose values are shares that must be less than 1."""
RANGES = {"contact_x", "contact_y"}
"""Keys whose values are a lower and an upper end."""


def read_section(kind: type[Section], table: dict[str, Any], where: str) -> Section:
    """Turn one table of robot.toml into its dataclass.

    Raises:
        InvalidInput: a missing or unknown key, a value of the wrong type or sign, not finite, or out of order.
    """
    if not isinstance(table, dict):
        raise InvalidInput(f"{where} must be a table")
    hints = get_type_hints(kind)
    names = [field.name for field in fields(kind)]  # type: ignore[arg-type]
    for key in names:
        if key not in table:
            raise InvalidInput(f"{where} lacks the key {key!r}")
    for key in table:
        if key not in names:
            raise InvalidInput(f"{where} has an unknown key {key!r}; known are {', '.join(names)}")
    values = {key: _value(hints[key], table[key], f"{where}.{key}", key) for key in names}
    _check_order(values, where)
    return kind(**values)


def _check_order(values: dict[str, Any], where: str) -> None:
    """Refuse values of a table that contradict each other."""
    for keys in RISING:
        for low, high in pairwise(key for key in keys if key in values):
            less, more = values[low], values[high]
            if less >= more:
                raise InvalidInput(f"{where}.{low} = {less!r} must be less than {where}.{high} = {more!r}")
    for key in values:
        if key in SHARES and values[key] >= 1.0:
            raise InvalidInput(f"{where}.{key} = {values[key]!r} must be less than 1")
        if key in RANGES and values[key][0] >= values[key][1]:
            raise InvalidInput(f"{where}.{key} = {list(values[key])!r} must be a lower and a higher value")


def _value(hint: Any, raw: Any, where: str, key: str) -> Any:
    """Check one value against its type hint and turn lists into tuples."""
    if get_origin(hint) is tuple:
        inner = get_args(hint)
        if not isinstance(raw, list) or not raw or (Ellipsis not in inner and len(raw) != len(inner)):
            raise InvalidInput(f"{where} = {raw!r} must be a list of {'values' if Ellipsis in inner else len(inner)}")
        return tuple(_value(inner[0], item, where, key) for item in raw)
    if get_origin(hint) is types.MappingProxyType:
        if not isinstance(raw, dict):
            raise InvalidInput(f"{where} must be a table of angles in degrees")
        return types.MappingProxyType({name: _value(float, item, f"{where}.{name}", key) for name, item in raw.items()})
    if hint is str:
        if not isinstance(raw, str) or not raw:
            raise InvalidInput(f"{where} = {raw!r} must be a name")
        return raw
    return _number(hint, raw, where, key)


def _number(hint: Any, raw: Any, where: str, key: str) -> float | int:
    """Check a number: its type, that it is finite, and its sign."""
    good_type = isinstance(raw, int) if hint is int else isinstance(raw, int | float)
    if isinstance(raw, bool) or not good_type or not abs(raw) <= sys.float_info.max:
        raise InvalidInput(f"{where} = {raw!r} must be a finite {'whole ' if hint is int else ''}number")
    if key not in SIGNED and (raw < 0 or (raw == 0 and key not in ZERO)):
        raise InvalidInput(f"{where} = {raw!r} must be {'zero or ' if key in ZERO else ''}positive")
    return hint(raw)
