"""All figures, in one style. Each is a function from values to a matplotlib figure. Only this room imports pyplot."""

from stepover.report.figures.adapted import arms_and_lead_knee, before_and_after, stick_diagram
from stepover.report.figures.blocks import block_diagram
from stepover.report.figures.crossing import crossing, refused
from stepover.report.figures.feasibility import areas_by_height, domains_overlaid, feasibility_domains, key_domains
from stepover.report.figures.landing import (
    landing_forces,
    landing_sensitivity,
    leg_1_landing,
    spline_and_polynomial,
)
from stepover.report.figures.limits import clearance_by_units, highest_with_and_without_yaw, obstacle_plane
from stepover.report.figures.optimal import frontier, limits_used
from stepover.report.figures.planned import lateral_direction, preview_forms, walking_direction
from stepover.report.figures.posture import key_configuration
from stepover.report.figures.robustness import breaking, robustness
from stepover.report.figures.simulated import (
    clearance,
    contact_forces,
    failure,
    planned_and_simulated,
    strip,
    two_engines,
)
from stepover.report.figures.strategies import (
    duration_over_epsilon,
    strategies_by_height,
    ways_from_above,
    ways_over_time,
)
from stepover.report.figures.style import save
from stepover.report.figures.trials import estimated, heights_with_servos, stabilized
from stepover.report.figures.units import cart, leg_joints, swings, upper_body

__all__ = [
    "areas_by_height",
    "arms_and_lead_knee",
    "before_and_after",
    "block_diagram",
    "breaking",
    "cart",
    "clearance",
    "clearance_by_units",
    "contact_forces",
    "crossing",
    "domains_overlaid",
    "duration_over_epsilon",
    "estimated",
    "failure",
    "feasibility_domains",
    "frontier",
    "heights_with_servos",
    "highest_with_and_without_yaw",
    "key_configuration",
    "key_domains",
    "landing_forces",
    "landing_sensitivity",
    "lateral_direction",
    "leg_1_landing",
    "leg_joints",
    "limits_used",
    "obstacle_plane",
    "planned_and_simulated",
    "preview_forms",
    "refused",
    "robustness",
    "save",
    "spline_and_polynomial",
    "stabilized",
    "stick_diagram",
    "strategies_by_height",
    "strip",
    "swings",
    "two_engines",
    "upper_body",
    "walking_direction",
    "ways_from_above",
    "ways_over_time",
]
