"""Keeps what happened: fixes, poses, progress, events and trips of vehicles."""
