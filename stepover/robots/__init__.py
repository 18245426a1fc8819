"""From a URDF and a robot.toml to a checked robot."""
