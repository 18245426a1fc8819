"""The paper's claims, what the notebooks measured, and the run that compares both."""
