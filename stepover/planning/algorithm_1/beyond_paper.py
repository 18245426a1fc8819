"""What is added beyond the paper, where its own methods do not keep the margins: tried last.

`plan(..., extras=False)` does without.

The ZMP reference moves inside the sole: towards the rear foot's toe before leg 1 lands, so that the waist comes
ahead and the lead knee does not over-stretch; towards the front foot's heel after leg 2 has lifted off, so that
the trailing knee does not, and ahead again while the trailing leg passes. Leg 2 swings late, see `swing_shape`. Where
speed limits are to be kept, the waist is lowest only after the double
support: still coming down, it takes speed from the straightening trailing knee.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from stepover.model.robot import Robot
from stepover.motion.footsteps import LEG_1, LEG_2
from stepover.planning.algorithm_1.step_sequence import StepSequence


def waist_delay(robot: Robot, level: int) -> float:
    """How much later than the double support the waist is lowest [s]: 0 at level 0."""
    return robot.beyond_paper.waist_delay if level > 0 else 0.0


def extra_zmp(robot: Robot, sequence: StepSequence, level: int) -> StepSequence:
    """The sequence with its ZMP reference moved inside the soles, as far as the level says; as it is at level 0."""
    if level == 0:
        return sequence
    extra, first, second = robot.beyond_paper, sequence.step(LEG_1), sequence.step(LEG_2)
    toe, swing = extra.zmp_toe[level - 1], second.touch_down - second.lift_off
    knots = [
        (first.lift_off, 0.0),
        (first.lift_off + extra.zmp_toe_at * (first.touch_down - first.lift_off), toe),
        (first.touch_down, toe),
        (second.lift_off + extra.zmp_heel_from * swing, -extra.zmp_heel),
        (second.lift_off + extra.zmp_heel_until * swing, -extra.zmp_heel),
        (second.lift_off + extra.zmp_ahead_at * swing, extra.zmp_ahead),
        (second.touch_down, 0.0),
    ]
    samples, offsets = np.array(knots).T
    zmp = sequence.zmp.copy()
    zmp[:, 0] += np.interp(np.arange(len(zmp)), samples, offsets)
    return dataclasses.replace(sequence, zmp=zmp)
