"""Kinds of steps: what a planner calls each step of a crossing, as stored in a motion's footsteps."""

NORMAL, BEFORE, LEG_1, LEG_2, AFTER = range(5)
"""Normal walking; the step before the obstacle; the leading and the trailing leg over it; the step after it."""
