"""What exists: obstacle, robot, leg kinematics, multi-body dynamics, support polygon."""
