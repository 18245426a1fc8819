"""The motion: what every planner returns and everything else reads."""
