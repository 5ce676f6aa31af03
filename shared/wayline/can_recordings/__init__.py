"""Reads CAN recordings: which format a file is, and its frames in spite of damage."""

import logging

# what is damaged is counted and shown in the summary, not logged line by line
logging.getLogger("can.io").setLevel(logging.ERROR)
