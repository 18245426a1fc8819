"""Long tables: many runs in parallel, seeded, resumable."""
