"""`python -m sdfc`."""

from sdfc.cli import main

main()
