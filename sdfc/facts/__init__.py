"""What can be proved of a shape; one analysis a file."""
