"""Figures, tables, summaries and the 3-D viewer."""
