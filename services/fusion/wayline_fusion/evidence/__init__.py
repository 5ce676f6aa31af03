"""What is learned of the sensors from how they agree."""
