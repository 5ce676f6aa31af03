"""How far a trip went and how well that is known: by GPS alone, or by wheels that it measures."""
