"""Studies of the physics engines themselves: their settings, and how far the two agree."""
