"""The physics: the robot in PyBullet, with its obstacle."""
