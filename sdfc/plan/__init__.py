"""Which technique is legal for each part, and which is chosen."""
