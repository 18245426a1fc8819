"""Algorithm 1 of the paper, a module per unit, under the paper's names."""
