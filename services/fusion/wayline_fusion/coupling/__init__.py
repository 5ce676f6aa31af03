"""What a receiver is told of the vehicle, so that its loops need not find out (papers/001)."""
