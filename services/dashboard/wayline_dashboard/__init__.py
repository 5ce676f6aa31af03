"""Shows vehicles live."""
