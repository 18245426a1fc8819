"""What a planner is, and what every planner shares: checks of a finished motion, the nearest obstacle that works."""
