"""Pure: messages to and from the JSON of the bus."""

import msgspec

from wayline.messages import TOPICS, Message

ENCODING = "application/json"

_encoder = msgspec.json.Encoder()
_decoders = {topic: msgspec.json.Decoder(message) for topic, message in TOPICS.items()}


def encode(message: Message) -> bytes:
    """JSON of one message; unknown values are null."""
    return _encoder.encode(message)


def decode(topic: str, payload: bytes) -> Message:
    """A message of a topic. Raises msgspec.DecodeError for JSON that does not fit it."""
    return _decoders[topic].decode(payload)
