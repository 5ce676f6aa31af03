"""What `wayline doctor can` knows: profiles that fit a bus, what arrives, a mapping to paste."""
