"""What is kept of a vehicle over a restart."""
