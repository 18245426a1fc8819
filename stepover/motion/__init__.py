"""The motion: the result of every planner and the input of all other rooms."""
