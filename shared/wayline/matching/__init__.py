"""Pure: which place of a network of lines a vehicle is at: candidates, costs and the likeliest."""
