"""Text fields become numbers with units; what is no such field is refused or unknown."""

import datetime as dt

import pytest

from wayline_gps_ingest import fields


@pytest.mark.parametrize(
    ("text", "hemisphere", "expected_deg"),
    [
        ("5916.4824", "N", 59.27470666666667),  # papers/004 table A.1
        ("4124.8963", "S", -41.41493833333333),
        ("0000.0000", "N", 0.0),
        ("4530", "N", 45.5),
        ("9000.000", "S", -90.0),
        ("4860.0000", "N", 49.0),  # 48 degrees 59.99999, rounded by its receiver
    ],
)
def test_latitude_is_degrees_and_minutes(text: str, hemisphere: str, expected_deg: float) -> None:
    latitude_deg = fields.latitude_deg(text, hemisphere)
    assert latitude_deg == pytest.approx(expected_deg, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "hemisphere"),
    [("4860.001", "N"), ("9000.001", "N"), ("48x7.0", "N"), ("4807.0", ""), ("-4807.0", "N")],
)
def test_a_latitude_that_cannot_be_one_is_refused(text: str, hemisphere: str) -> None:
    with pytest.raises(fields.BadFieldError):
        fields.latitude_deg(text, hemisphere)


def test_an_empty_position_is_unknown() -> None:
    assert fields.longitude_deg("", "") is None


@pytest.mark.parametrize(
    ("text", "expected_ns"),
    [
        ("000000", 0),
        ("163409.348", 59_649_348_000_000),
        ("235959.999999999", 86_399_999_999_999),
        ("120000.", 43_200_000_000_000),
        ("235960", 86_400_000_000_000),  # a leap second
    ],
)
def test_time_of_day_keeps_every_decimal(text: str, expected_ns: int) -> None:
    assert fields.time_of_day_ns(text) == expected_ns


@pytest.mark.parametrize("text", ["240000", "126000", "120061", "12000", "12:00:00", "12000a.0"])
def test_a_time_that_cannot_be_one_is_refused(text: str) -> None:
    with pytest.raises(fields.BadFieldError):
        fields.time_of_day_ns(text)


@pytest.mark.parametrize(
    ("day", "month", "year", "expected"),
    [
        ("06", "12", "04", dt.date(2004, 12, 6)),
        ("23", "03", "94", dt.date(1994, 3, 23)),
        ("1", "8", "2027", dt.date(2027, 8, 1)),
    ],
)
def test_years_of_two_digits_start_with_gps_time(
    day: str, month: str, year: str, expected: dt.date
) -> None:
    assert fields.date_of(day, month, year) == expected


@pytest.mark.parametrize(
    "parts", [("31", "02", "24"), ("xx", "02", "24"), ("01", "02", ""), ("01", "02", "9999")]
)
def test_a_date_that_cannot_be_one_is_refused(parts: tuple[str, str, str]) -> None:
    with pytest.raises(fields.BadFieldError):
        fields.date_of(*parts)


@pytest.mark.parametrize("text", ["", "0NaN", "nan", "-inf", "1.2.3", "1e200", "-9999999999"])
def test_a_number_that_is_none_is_unknown(text: str) -> None:
    assert fields.number(text) is None


def test_a_deviation_of_zero_is_unknown() -> None:
    assert fields.positive("0.0") is None
    assert fields.positive("0.7") == 0.7


@pytest.mark.parametrize("text", ["0", "99.99", "99.00"])
def test_a_dilution_that_receivers_write_for_unknown_is_unknown(text: str) -> None:
    assert fields.dilution(text) is None
    assert fields.dilution("98.9") == 98.9


def test_a_date_of_zeros_is_unknown() -> None:
    assert fields.date_of("00", "00", "00") is None


def test_course_of_a_full_circle_is_north() -> None:
    assert fields.bearing_deg("360.0") == 0.0
    assert fields.bearing_deg("-1.0") is None
