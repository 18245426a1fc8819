"""Floor and obstacles in a PyBullet client, and the contact points of the robot with them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stepover.model.obstacle import LATERAL_HALF_EXTENT
from stepover.simulation.engine import FLOOR, NO_CONTACTS, NO_FOOT, Contacts
from stepover.simulation.pybullet.client import pybullet
from stepover.simulation.pybullet.robot import Body

Point = tuple
"""A contact point of PyBullet's. By index: 2 the body that is touched, 3 the robot's link, 5 and 6 the place on the
robot and on what is touched, 7 the normal, 8 the distance, 9 the normal force, 10 to 13 friction and its directions."""


class Surroundings:
    """Everything in a client but the robot.

    Attributes:
        floor: PyBullet's number of the endless floor.
        obstacles: PyBullet's numbers of the obstacles.
    """

    def __init__(self, client: int, obstacles: Sequence[np.ndarray]) -> None:
        """Build floor and obstacles, from a motion's rows."""
        self._client = client
        self.floor = self._plane()
        self.obstacles = [self._beam(*row[:3]) for row in obstacles]
        self._numbers = {self.floor: FLOOR} | {body: k for k, body in enumerate(self.obstacles)}
        self._own_floors: list[int] = []

    @property
    def bodies(self) -> list[int]:
        """PyBullet's numbers of all of them."""
        return list(self._numbers)

    def part_floor(self, robot: Body) -> list[int]:
        """Give each foot a floor of its own, which nothing else touches: the new bodies.

        A foot in the air does not notice when its floor moves, so that each foothold may have its own height without
        edges to its neighbours.
        """
        for foot in (0, 1):
            own = self._plane()
            self._own_floors.append(own)
            self._numbers[own] = FLOOR
            for link in robot.links:
                mine = robot.feet.get(link) == foot
                pybullet.setCollisionFilterPair(own, robot.number, -1, link, int(mine), self._client)
                if mine:
                    pybullet.setCollisionFilterPair(self.floor, robot.number, -1, link, 0, self._client)
        return self._own_floors

    @property
    def parted(self) -> bool:
        """Whether each foot has a floor of its own."""
        return bool(self._own_floors)

    def raise_floor(self, foot: int, height: float) -> None:
        """Put a foot's own floor at a height [m]."""
        where = (0.0, 0.0, height), (0.0, 0.0, 0.0, 1.0)
        pybullet.resetBasePositionAndOrientation(self._own_floors[foot], *where, self._client)

    def points(self, robot: Body) -> tuple[list[Point], list[Point]]:
        """Contact points of the last step that bear on the floor, and those that touch an obstacle."""
        on_floor, on_obstacles = [], []
        for point in pybullet.getContactPoints(robot.number, physicsClientId=self._client):
            if self._numbers[point[2]] != FLOOR:
                if point[8] <= 0.0:
                    on_obstacles.append(point)
            elif point[9] > 0.0:
                on_floor.append(point)
        return on_floor, on_obstacles

    def contacts(self, points: Sequence[tuple[int, Point]], robot: Body) -> Contacts:
        """Contact points as the library has them, each given with its time step."""
        if not points:
            return NO_CONTACTS
        feet = robot.feet
        numbers = np.array([
            (*p[6], *p[7], *p[11], *p[13], p[9], p[10], p[12], -p[8], p[3] + 1, feet.get(p[3], NO_FOOT),
             self._numbers[p[2]], step)
            for step, p in points
        ])  # fmt: skip
        normal, first, second = numbers[:, 3:6], numbers[:, 6:9], numbers[:, 9:12]
        force = numbers[:, 12:13] * normal + numbers[:, 13:14] * first + numbers[:, 14:15] * second
        link, foot, touched, step = numbers[:, 16:].T.astype(int)
        return Contacts(step, link, foot, touched, numbers[:, :3], force, numbers[:, 15])

    def _still(self, shape: int, position: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> int:
        """A body that never moves."""
        return int(pybullet.createMultiBody(0.0, shape, basePosition=position, physicsClientId=self._client))

    def _beam(self, front: float, width: float, height: float) -> int:
        """A bare obstacle, as a box on the floor."""
        half = [width / 2.0, LATERAL_HALF_EXTENT, height / 2.0]
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=self._client)
        return self._still(box, (front + half[0], 0.0, half[2]))

    def _plane(self) -> int:
        """An endless floor."""
        return self._still(pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=self._client))
