"""What the robot must keep: one module a group, each a function from what is seen to values and gradients."""
