"""How often a source usually reports."""

from builders import at
from wayline.cadence import Cadence


def after(*seconds: float) -> Cadence:
    cadence = Cadence()
    for each in seconds:
        cadence = cadence.noticed(at(each))
    return cadence


def test_a_source_reports_once_a_second_until_it_has_reported_twice() -> None:
    assert after().usual_s == after(0.0).usual_s == 1.0
    assert after(0.0, 30.0).usual_s == 30.0


def test_outages_do_not_change_what_is_usual() -> None:
    assert after(0.0, 1.0, 2.0, 62.0, 63.0, 64.0, 124.0, 125.0).usual_s == 1.0


def test_another_interval_is_usual_after_a_few_reports() -> None:
    once_a_second = [float(second) for second in range(60)]
    assert after(*once_a_second, *(60.0 + 30.0 * n for n in range(6))).usual_s == 30.0


def test_a_report_that_is_late_tells_nothing() -> None:
    assert after(0.0, 30.0, 29.0, 60.0).usual_s == 30.0
