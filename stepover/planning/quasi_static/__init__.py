"""The quasi-static baseline that the paper compares with. Sec. II-A."""
