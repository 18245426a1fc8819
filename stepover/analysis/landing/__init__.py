"""The landing force of the leading foot, and how to reduce it. Sec. II-C and III-B."""
