"""Pictures and films of the robot, drawn by our own software renderer: no engine, no display."""
