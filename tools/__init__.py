"""What serves a checkout only and is not part of the installed package: the site and the benchmark."""
