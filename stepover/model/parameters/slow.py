"""Parameters for motions that keep the joints' speed limits: HRP-2's values that differ from the defaults.

They are estimated by a search over these values for an obstacle of 25 cm. Other robots scale them like the defaults.
"""

from __future__ import annotations

from typing import Any

SLOW: dict[str, dict[str, Any]] = {
    "walk": {
        "single_support_over": 1.645,
        "single_support_leg_2": 2.34,
        "double_support_over": 0.025,  # a longer one is beyond the reach of the lead knee
    },
    "feasibility": {  # a lower waist and a longer step: bent knees turn more slowly
        "knee_margin_deg": 54.0,
        "step_length_max": 0.64,
        "step_length_more": 0.01,
        "waist_height_min": 0.53,
    },
    "stepping_over": {"leg1_rise": 0.378, "leg1_descent": 0.776, "leg1_extra_lift": 0.08},
    "adaptor": {"shift_step": 0.0135, "shift_peak": 0.322, "raise_max": 0.12, "raise_peak": 0.257},
    "late_swing": {
        "leg2_rise": 0.293,
        "leg2_descent": 0.598,
        "leg2_descent_drop": 0.0,
        "leg2_pitch_start": 0.005,
        "leg2_pitch_full": 0.415,
        "leg2_pitch_per_height_deg": 164.0,
    },
    "beyond_paper": {
        "zmp_toe": (0.098,),  # nearer to the toe, and to the heel: the CoM passes more slowly
        "zmp_heel": 0.074,
        "zmp_heel_from": 0.0065,  # after the ZMP's overshoot at lift-off, which has the least margin
        "zmp_ahead": 0.048,
        "zmp_toe_at": 0.463,
        "zmp_heel_until": 0.275,
        "zmp_ahead_at": 0.634,
        "waist_delay": 0.30,  # still coming down where the trailing knee straightens
    },
}
"""Tables and fields as Robot has them, in the same units."""
