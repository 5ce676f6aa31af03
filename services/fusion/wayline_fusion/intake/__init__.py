"""What comes in: readings that can be, as events at their own time."""
