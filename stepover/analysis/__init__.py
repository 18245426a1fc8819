"""Computations of the notebooks: the numbers behind the paper's claims, without plots."""
