"""Pure: a receiver's bytes into sentences, whatever else comes among them.

Receivers mix binary messages in (UBX, SiRF, RTCM, Garmin, CASIC) and links tear sentences apart, so
a sentence is found by how it starts, and all else is skipped. Binary messages are not framed by
their own length: one corrupt length would hold back the sentences of seconds.
Latin-1 keeps every byte one character, so that checksums can still be told right from wrong.
"""

import re

SENTENCE = re.compile(
    r"[$!](?=[A-Z0-9]{2}[A-Z0-9.]*[,*])"  # the start, only where an address field follows
    r"[^$!*\r\n]*"  # up to a checksum or the next one; a $ alone is no start
    r"(?:[$!](?![A-Z0-9]{2}[A-Z0-9.]*[,*])[^$!*\r\n]*)*"
    r"(?:\*[0-9A-Fa-f]{2}|\*)?"
)
UP_TO_END = re.compile(r".*(?:[\r\n]|\*[0-9A-Fa-f]{2})", re.DOTALL)
"""All that cannot go on: up to the last line end or checksum."""
UNFINISHED_MAX = 1024
"""Longer than any sentence; binary messages without a line end must not fill memory."""


def split_sentences(text: str) -> list[str]:
    """The sentences within one or several lines, noise around them cut off.

    Links tear sentences, so each begins at the last `$` or `!` that starts one: of
    `$GPRM$GPRMC,...` only the second remains. A piece long enough to be known by its address is
    handed on, for its reader to count as torn.
    """
    return [found.rstrip() for found in SENTENCE.findall(text)]


class SentenceSplitter:
    """Bytes of one connection in, in whatever pieces they come, sentences out.

    A sentence is handed out with the last digit of its checksum, or at its line's end if it has
    none: nothing waits for what comes after. A new connection needs a new splitter, as a datagram
    does, which ends with its last byte (`end`).
    """

    def __init__(self) -> None:
        self._unfinished = ""

    def feed(self, chunk: bytes) -> list[str]:
        """The sentences that a chunk completes."""
        text = self._unfinished + chunk.decode("latin-1")
        ended = UP_TO_END.match(text)
        if ended is None:
            self._unfinished = text[-UNFINISHED_MAX:]
            return []
        self._unfinished = text[ended.end() :][-UNFINISHED_MAX:]
        return split_sentences(ended[0])

    def end(self) -> list[str]:
        """What the last bytes held, now that no more will come."""
        return self.feed(b"\n")
