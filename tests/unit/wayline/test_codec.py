"""What comes over the bus is a message within its bounds, or one kind of error."""

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lasting import examples
from poison import NOT_UTF8, PAYLOADS, damaged, messages
from wayline.codec import decode, encode
from wayline.messages import TOPICS


@pytest.mark.parametrize("topic", TOPICS)
@pytest.mark.parametrize("what", PAYLOADS)
def test_poison_is_an_error_of_decoding_whatever_the_topic(topic: str, what: str) -> None:
    with pytest.raises(msgspec.DecodeError):
        decode(topic, PAYLOADS[what])


@pytest.mark.parametrize("topic", NOT_UTF8)
def test_text_that_is_not_utf8_is_an_error_of_decoding(topic: str) -> None:
    with pytest.raises(msgspec.DecodeError):
        decode(topic, NOT_UTF8[topic])


@pytest.mark.parametrize("topic", TOPICS)
@settings(max_examples=examples(40), deadline=None)
@given(data=st.data())
def test_a_damaged_payload_is_a_message_or_an_error_of_decoding(
    topic: str, data: st.DataObject
) -> None:
    payload = data.draw(damaged(topic))
    try:
        message = decode(topic, payload)
    except msgspec.DecodeError:
        return
    assert decode(topic, encode(message)) == message


@pytest.mark.parametrize("topic", TOPICS)
@settings(max_examples=examples(20), deadline=None)
@given(data=st.data())
def test_what_lies_within_the_bounds_comes_as_it_was_sent(topic: str, data: st.DataObject) -> None:
    message = data.draw(messages(topic))
    assert decode(topic, encode(message)) == message


@pytest.mark.parametrize(
    ("topic", "field"),
    [("pose", '"east_std_m":1e200'), ("pose", '"speed_mps":201'), ("gps_fix", '"alt_m":1e10')],
)
def test_what_lies_beyond_the_bounds_is_refused(topic: str, field: str) -> None:
    needed = {"pose": '"mode":"gps"', "gps_fix": '"valid":false'}[topic]
    with pytest.raises(msgspec.ValidationError):
        decode(topic, f'{{"t_ns":1700000000000000000,{needed},{field}}}'.encode())
