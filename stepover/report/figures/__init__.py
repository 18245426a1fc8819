"""Every figure: a function from values to a matplotlib figure, all in one style. Only here is pyplot imported."""

from stepover.report.figures.planned import lateral_direction, preview_forms, walking_direction
from stepover.report.figures.posture import key_configuration
from stepover.report.figures.simulated import clearance, contact_forces, failure, planned_and_simulated, strip
from stepover.report.figures.style import save

__all__ = [
    "clearance",
    "contact_forces",
    "failure",
    "key_configuration",
    "lateral_direction",
    "planned_and_simulated",
    "preview_forms",
    "save",
    "strip",
    "walking_direction",
]
