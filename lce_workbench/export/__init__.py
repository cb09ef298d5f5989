"""How masks and tables leave: one file per format, one visible table."""
