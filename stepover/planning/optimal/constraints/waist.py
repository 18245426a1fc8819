"""Lean: roll and pitch of the waist stay small, so that sensors and upper body stay near upright."""

from __future__ import annotations

import numpy as np

from stepover.planning.optimal.constraints.group import Group, Local, one_hot
from stepover.planning.optimal.instants import Instants

ANGLE = 0.2
"""Violation [rad] that counts as 1."""


def lean(seen: Instants) -> Group:
    """Pitch and roll of the waist, both ways."""
    angles, most = seen.now[:, 4:6], np.radians(seen.scene.parameters.lean_deg)
    values = (np.hstack([angles, -angles]) - most) / ANGLE

    def gradient(rows: np.ndarray, columns: np.ndarray) -> Local:
        sign = np.where(columns < 2, 1.0, -1.0) / ANGLE
        return Local(channels=sign[:, None] * one_hot(4 + columns % 2, seen.now.shape[1]))

    return Group("lean", values, ["waist pitch", "waist roll"] * 2, ANGLE, "rad", gradient)
