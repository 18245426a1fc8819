"""A course: several obstacles along the path, in their order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stepover.errors import InvalidInput, require_type
from stepover.model.obstacle import Obstacle


@dataclass(frozen=True)
class Course:
    """Obstacles along the path, the nearest first.

    Attributes:
        obstacles: the obstacles, stored as a tuple. If there are several, each needs a distance.

    Raises:
        InvalidInput: no obstacle, a missing distance, a wrong order, or obstacles without a gap between them.
    """

    obstacles: Sequence[Obstacle]

    def __post_init__(self) -> None:
        """Reject obstacles that cannot stand one behind the other."""
        if isinstance(self.obstacles, Obstacle | str) or not isinstance(self.obstacles, Sequence):
            raise InvalidInput("a course needs a list of obstacles: Course([Obstacle(...), Obstacle(...)])")
        object.__setattr__(self, "obstacles", tuple(self.obstacles))
        if not self.obstacles:
            raise InvalidInput("a course needs at least one obstacle")
        for number, obstacle in enumerate(self.obstacles, start=1):
            require_type(f"obstacle {number} of the course", obstacle, Obstacle, "Obstacle(height, width)")
            if obstacle.distance is None and len(self.obstacles) > 1:
                raise InvalidInput(f"obstacle {number} of the course needs a distance")
        for number, (one, following) in enumerate(pairwise(self.obstacles), start=1):
            gap = float(following.distance or 0.0) - _back(one)
            if gap <= 0.0:
                raise InvalidInput(
                    f"obstacles {number} and {number + 1} of the course must have a gap between them, in the order in "
                    f"which the robot meets them; here it is {gap:.3f} m"
                )


def _back(obstacle: Obstacle) -> float:
    """Where the path leaves an obstacle [m]: the far side on the line y = 0."""
    return float(obstacle.distance or 0.0) + obstacle.width / float(np.cos(obstacle.yaw))
