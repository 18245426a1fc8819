"""A robot as plain values, and as the text that libraries load."""
