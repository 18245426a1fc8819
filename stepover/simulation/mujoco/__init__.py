"""MuJoCo as a physics engine. The only door to it."""
