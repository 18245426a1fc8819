"""Studies: tables of many runs, computed in parallel. They are seeded and can be resumed."""
