"""The command line: one click verb a file."""
