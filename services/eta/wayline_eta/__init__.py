"""Projects poses on routes and predicts arrivals."""
