"""Balance control: an estimator and a stabilizer. Their only input is what a robot's sensors would read."""
