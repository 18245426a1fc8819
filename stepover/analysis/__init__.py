"""What the notebooks compute about the paper: claims in numbers, without plots."""
