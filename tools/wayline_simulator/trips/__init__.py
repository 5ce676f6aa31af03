"""Many trips of a few vehicles that carry a receiver and nothing else, as papers/003 had them."""
