"""What keeps the robot on its feet: an estimator and a stabilizer, which read only what a robot would read."""
