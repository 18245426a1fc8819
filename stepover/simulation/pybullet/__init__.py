"""PyBullet as the physics engine. The only door to it."""
