"""Parameters of a robot, of the planners and of the physics, as frozen dataclasses."""
