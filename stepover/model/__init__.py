"""Models: obstacle, robot, leg kinematics, multi-body dynamics, support polygon."""
