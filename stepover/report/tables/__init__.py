"""Tables of results, as the notebooks show them."""
