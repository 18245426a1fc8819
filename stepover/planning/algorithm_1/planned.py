"""What the planner leaves behind: a motion, what it was allowed to use, and what its units handed to each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.com_waist import ComWaist
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.algorithm_1.feet_adaptor import METHODS, Adaptation
from stepover.planning.algorithm_1.feet_trajectories import FeetTrajectories
from stepover.planning.algorithm_1.step_sequence import StepSequence
from stepover.planning.algorithm_1.upper_body import UpperBody


@dataclass(frozen=True)
class Effort:
    """What the planner may use.

    Attributes:
        arms: "auto", "on" or "off": UBMG.
        methods: which of FTA's three methods.
        level: of what is added beyond the paper; 0: nothing.
    """

    arms: str = "auto"
    methods: tuple[int, ...] = METHODS
    level: int = 0


@dataclass(frozen=True, eq=False)
class Plan:
    """A motion and how it came about.

    Attributes:
        motion: the result.
        key: key configuration.
        sequence: the steps.
        feet: trajectories of the feet by FTG, before they were adapted.
        first_stage: CoM and waist of CWTG1.
        upper: what UBMG decided.
        adaptation: what FTA did.
        effort: what was used.
        filter_passes: how often the dynamic filter ran.
        planning_time: feasibility, trajectories and total [s].
    """

    motion: Motion
    key: KeyConfiguration
    sequence: StepSequence
    feet: FeetTrajectories
    first_stage: ComWaist
    upper: UpperBody
    adaptation: Adaptation
    effort: Effort
    filter_passes: int
    planning_time: dict[str, float]

    @property
    def adaptations(self) -> dict[str, object]:
        """What FTA and UBMG did, and how often the filter ran, as plain numbers: m, rad, s."""
        upper, feet = self.upper, self.adaptation
        return {
            "filter_passes": self.filter_passes,
            "beyond_paper_level": self.effort.level,
            "ubmg": {
                "acted": upper.arm_swing > 0.0,
                "arm_swing": upper.arm_swing,
                "waist_shift_max": float(np.abs(upper.waist_shift[:, 0]).max()),
                "knee_spare_before": upper.knee_before,
                "knee_spare_after": upper.knee_after,
                "p_ref2_min": float(-upper.zmp_change[:, 0].max()),
                "p_ref2_max": float(-upper.zmp_change[:, 0].min()),
            },
            "fta": {
                "acted": feet.acted,
                "leg": "leg 2" if feet.acted else None,
                "foot_back": feet.shift,
                "waist_raised": feet.raised,
                "ankle_pushed": feet.pushed,
                "start": feet.start,
                "end": feet.end,
            },
        }
