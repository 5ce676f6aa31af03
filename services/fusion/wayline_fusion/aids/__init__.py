"""What each kind of measurement may do to the state, a file an aid."""
