"""Parameters of the quasi-static baseline, as a frozen dataclass. The defaults are HRP-2's."""

from __future__ import annotations

from dataclasses import dataclass

from stepover.model.parameters.entry import parameter


@dataclass(frozen=True)
class QuasiStatic:
    """The quasi-static baseline (Sec. II-A): the CoM over a foot, everything slow. Shares are of a leg's path."""

    clearance: float = parameter(0.010, "m", "around the bare obstacle, where no path keeps the margins")
    com_ahead: float = parameter(
        0.100, "m", "CoM ahead of the rear ankle at most: 26 mm from the patch's edge", scale="toe"
    )
    com_behind: float = parameter(
        0.070, "m", "CoM behind the front ankle at most: 26 mm from the patch's edge", scale="heel"
    )
    com_parts: int = parameter(2, "count", "equal parts of both that are tried, none first")
    step_length_step: float = parameter(0.01, "m", "resolution of the search over X_ads")
    waist_height_step: float = parameter(0.01, "m", "resolution of the search over Z_hds")
    places: int = parameter(4, "count", "places of the obstacle between the feet that are tried")
    place_max: float = parameter(0.30, "share", "of the slack between the feet, from the front heel, for these places")
    tries: int = parameter(6, "count", "pairs of postures whose paths are looked at")
    knee_spare_deg: float = parameter(2.0, "deg", "bend of the knees beyond what the checks ask for")
    spare: float = parameter(
        0.002, "m", "distance beyond the margins, for what lies between the looks", sign="not negative"
    )
    search_rounds: int = parameter(3, "count", "rounds of the CoM's iteration while searching")
    rounds: int = parameter(6, "count", "rounds of the CoM's iteration in the motion")
    look: int = parameter(41, "count", "postures along a segment while searching")
    raises: tuple[float, ...] = parameter(
        (0.08, 0.06, 0.10, 0.04, 0.02), "m", "waist higher amid the double support, tried in this order", scale="leg"
    )
    leg1_rise: float = parameter(
        0.30, "share", "leg 1 is above the obstacle, its toe before it", below=("leg1_descent",)
    )
    leg1_descent: float = parameter(0.70, "share", "leg 1 is above its landing point")
    leg1_extra_lift: float = parameter(0.02, "m", "above the obstacle with its margin", sign="not negative")
    lower_from: float = parameter(
        0.25, "share", "of leg 1's path at which the waist starts down", below=("lower_until",)
    )
    lower_until: float = parameter(0.90, "share", "of leg 1's path at which the waist has come down")
    leg2_rise: float = parameter(
        0.42, "share", "leg 2 is above the obstacle, its toe before it", below=("leg2_descent",)
    )
    leg2_descent: float = parameter(0.56, "share", "leg 2 starts down behind the obstacle", below=("leg2_over",))
    leg2_over: float = parameter(0.67, "share", "leg 2 is above its landing point, flat")
    leg2_extra_lift: float = parameter(0.03, "m", "above the obstacle with its margin", sign="not negative")
    leg2_pitch_start: float = parameter(0.08, "share", "toe-down pitch begins", below=("leg2_pitch_full",))
    leg2_pitch_full: float = parameter(0.30, "share", "toe-down pitch reached", below=("leg2_descent",))
    leg2_pitches_deg: tuple[float, ...] = parameter((12.0, 24.0, 36.0), "deg", "toe-down pitches that are tried")
    leg2_backs: tuple[float, ...] = parameter(
        (0.05, 0.09, 0.01), "m", "how far before the obstacle the toe rises, tried in this order"
    )
    raise_from: float = parameter(0.02, "share", "of leg 2's path at which the waist starts up", below=("raise_until",))
    raise_until: float = parameter(0.50, "share", "of leg 2's path at which the waist has come up")
    swing_time: float = parameter(10.0, "s", "slow swing whose ZMP is measured, to set a swing's duration")
    swing_samples: int = parameter(400, "count", "samples of that swing")
