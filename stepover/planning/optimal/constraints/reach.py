"""Reach: the distance of the ankle from the hip stays below that of a knee bent by some angle.

A length is smooth where the knee's angle is not: at the stretched leg. A leg that bears, or soon will, keeps its knee
more bent, or a stabilizer could not lower it.
"""

from __future__ import annotations

import numpy as np

from stepover.planning.optimal.channels import SIDES, hip_to_ankle
from stepover.planning.optimal.constraints.group import Group, Local
from stepover.planning.optimal.instants import Instants
from stepover.planning.optimal.scene import Scene

LENGTH = 0.02
"""Violation [m] that counts as 1."""


def reach(seen: Instants) -> Group:
    """Hip to ankle, left and right."""
    knees = [seen.scene.robot.leg(side).joints[3] for side in SIDES]

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        return Local(channels=seen.by_channels[1][rows, columns] / LENGTH)

    return Group("reach", (seen.distance - longest(seen.scene)) / LENGTH, knees, LENGTH, "m", gradient)


def longest(scene: Scene) -> np.ndarray:
    """Largest distance of the ankle from the hip (n, 2), left and right [m]."""
    p, support = scene.parameters, scene.base.sequence.support
    around = 2 * round(p.knee_stance_around / scene.dt) + 1
    found = np.full((len(scene.samples), 2), scene.channels.longest)
    bent = hip_to_ankle(scene.robot.leg(1), np.radians(p.knee_stance_deg))
    for k, side in enumerate(SIDES):
        bears = np.convolve(support * side >= 0, np.ones(around), "same") > 0.5
        found[bears[scene.samples], k] = bent
    return found
