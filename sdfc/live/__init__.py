"""`sdfc watch`: a picture that follows its scene's text, with no more work than each edit needs."""
