"""Parameters of the quasi-static baseline, as a frozen dataclass. The defaults are HRP-2's."""

from __future__ import annotations

from dataclasses import dataclass

from stepover.model.parameters.entry import parameter


@dataclass(frozen=True)
class QuasiStatic:
    """The quasi-static baseline (Sec. II-A): slow motion with the CoM over a foot. Shares are of a leg's path."""

    clearance: float = parameter(0.010, "m", "margin around the bare obstacle if no path keeps the full margins")
    com_ahead: float = parameter(
        0.100, "m", "largest distance of the CoM ahead of the rear ankle: 26 mm from the patch's edge", scale="toe"
    )
    com_behind: float = parameter(
        0.070, "m", "largest distance of the CoM behind the front ankle: 26 mm from the patch's edge", scale="heel"
    )
    com_parts: int = parameter(2, "count", "number of equal parts of both that are tried, after zero")
    step_length_step: float = parameter(0.01, "m", "resolution of the search over X_ads")
    waist_height_step: float = parameter(0.01, "m", "resolution of the search over Z_hds")
    places: int = parameter(4, "count", "number of places tried for the obstacle between the feet")
    place_max: float = parameter(
        0.30, "share", "part of the slack between the feet, from the front heel, that contains these places"
    )
    tries: int = parameter(6, "count", "number of pairs of postures whose paths are tried")
    knee_spare_deg: float = parameter(2.0, "deg", "bend of the knees beyond the limit of the checks")
    spare: float = parameter(
        0.002, "m", "extra distance from the margins, for postures between the tested ones", sign="not negative"
    )
    search_rounds: int = parameter(3, "count", "rounds of the CoM's iteration while searching")
    rounds: int = parameter(6, "count", "rounds of the CoM's iteration in the motion")
    look: int = parameter(41, "count", "postures tested along a segment while searching")
    raises: tuple[float, ...] = parameter(
        (0.08, 0.06, 0.10, 0.04, 0.02),
        "m",
        "raises of the waist in the middle of the double support, tried in this order",
        scale="leg",
    )
    leg1_rise: float = parameter(
        0.30, "share", "point where leg 1 is as high as the obstacle, with its toe before it", below=("leg1_descent",)
    )
    leg1_descent: float = parameter(0.70, "share", "point where leg 1 is above its landing point")
    leg1_extra_lift: float = parameter(0.02, "m", "height above the obstacle with its margin", sign="not negative")
    lower_from: float = parameter(
        0.25, "share", "part of leg 1's path at which the waist starts to move down", below=("lower_until",)
    )
    lower_until: float = parameter(0.90, "share", "part of leg 1's path at which the waist is lowest")
    leg2_rise: float = parameter(
        0.42, "share", "point where leg 2 is as high as the obstacle, with its toe before it", below=("leg2_descent",)
    )
    leg2_descent: float = parameter(
        0.56, "share", "point where leg 2 starts to move down behind the obstacle", below=("leg2_over",)
    )
    leg2_over: float = parameter(0.67, "share", "point where leg 2 is flat above its landing point")
    leg2_extra_lift: float = parameter(0.03, "m", "height above the obstacle with its margin", sign="not negative")
    leg2_pitch_start: float = parameter(
        0.08, "share", "point where the toe-down pitch begins", below=("leg2_pitch_full",)
    )
    leg2_pitch_full: float = parameter(0.30, "share", "point of the full toe-down pitch", below=("leg2_descent",))
    leg2_pitches_deg: tuple[float, ...] = parameter((12.0, 24.0, 36.0), "deg", "toe-down pitches tried")
    leg2_backs: tuple[float, ...] = parameter(
        (0.05, 0.09, 0.01), "m", "distances before the obstacle at which the toe rises, tried in this order"
    )
    raise_from: float = parameter(
        0.02, "share", "part of leg 2's path at which the waist starts to rise", below=("raise_until",)
    )
    raise_until: float = parameter(0.50, "share", "part of leg 2's path at which the waist is highest")
    swing_time: float = parameter(
        10.0, "s", "duration of a slow swing whose ZMP is measured, to set a swing's duration"
    )
    swing_samples: int = parameter(400, "count", "samples of that swing")
