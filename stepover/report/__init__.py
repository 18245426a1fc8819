"""What a reader looks at: figures, claims, the reproduction run."""
