"""Families of cases by what makes them hard. A module here defines FAMILIES; the table finds it."""
