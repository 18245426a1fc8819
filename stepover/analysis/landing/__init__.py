"""How hard the leading foot lands, and what softens it. Sec. II-C and III-B."""
