"""Studies of the optimising planner. They take half an hour of two cores: `make frontier` runs them."""
