"""What Algorithm 1 may use, what its units lay out, and the plan that comes of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepover.motion.motion import Motion
from stepover.planning.algorithm_1.com_waist import ComWaist
from stepover.planning.algorithm_1.feasibility import KeyConfiguration
from stepover.planning.algorithm_1.feet_adaptor import METHODS, Adaptation
from stepover.planning.algorithm_1.step_sequence import Crossing, StepSequence
from stepover.planning.algorithm_1.upper_body import UpperBody
from stepover.planning.trajectories import FeetTrajectories


@dataclass(frozen=True)
class Options:
    """What Algorithm 1 may use.

    Attributes:
        arms: "auto", "on" or "off": UBMG.
        methods: which of FTA's three methods.
        level: of what is added beyond the paper; 0: nothing.
        late: which of FTG's later swings; 0: the authors' control points.
    """

    arms: str = "auto"
    methods: tuple[int, ...] = METHODS
    level: int = 0
    late: int = 0


@dataclass(frozen=True, eq=False)
class Nominal:
    """The nominal trajectories: what steps 2, 3 and 5 lay out, before the filter and FTA correct it.

    Attributes:
        crossing: robot, obstacle and steps.
        feet: trajectories of the feet by FTG.
        first_stage: CoM and waist of CWTG1.
        upper: what UBMG decided.
        waist: (N, 7) CWTG1's, moved as the filter will answer the arms.
    """

    crossing: Crossing
    feet: FeetTrajectories
    first_stage: ComWaist
    upper: UpperBody
    waist: np.ndarray


@dataclass(frozen=True, eq=False)
class Plan:
    """A motion and how it came about.

    Attributes:
        motion: the result.
        key: key configuration.
        nominal: the trajectories before they were corrected.
        adaptation: what FTA did.
        options: what was used.
        filter_passes: how often the dynamic filter ran.
        planning_time: feasibility, trajectories and total [s].
    """

    motion: Motion
    key: KeyConfiguration
    nominal: Nominal
    adaptation: Adaptation
    options: Options
    filter_passes: int
    planning_time: dict[str, float]

    @property
    def sequence(self) -> StepSequence:
        """The steps."""
        return self.nominal.crossing.sequence

    @property
    def adaptations(self) -> dict[str, object]:
        """What FTA and UBMG did, and how often the filter ran, as plain numbers: m, rad, s."""
        upper, feet = self.nominal.upper, self.adaptation
        return {
            "filter_passes": self.filter_passes,
            "beyond_paper_level": self.options.level,
            "late_swing": self.options.late,
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
