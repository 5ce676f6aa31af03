"""Pure: messages to and from the JSON of the bus."""

import msgspec

from wayline.messages import PAYLOAD_MAX_BYTES, TOPICS, Message

ENCODING = "application/json"

_encoder = msgspec.json.Encoder()
_decoders = {topic: msgspec.json.Decoder(message) for topic, message in TOPICS.items()}


def encode(message: Message) -> bytes:
    """JSON of one message; unknown values are null."""
    return _encoder.encode(message)


def decode(topic: str, payload: bytes) -> Message:
    """A message of a topic. Raises msgspec.DecodeError for what does not fit it."""
    if len(payload) > PAYLOAD_MAX_BYTES:
        raise msgspec.DecodeError(f"{len(payload)} bytes are more than {PAYLOAD_MAX_BYTES}")
    try:
        return _decoders[topic].decode(payload)
    except (RecursionError, UnicodeDecodeError) as error:
        # msgspec lets these two through: brackets without end, and text that is not UTF-8
        raise msgspec.DecodeError(str(error)) from None
