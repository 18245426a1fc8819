"""Tools for a checkout, which are not part of the installed package: the site and the benchmark report."""
