"""What the doctor says of certificates, tokens and addresses."""

import datetime as dt
from pathlib import Path

import pytest
import trustme

from wayline.http_settings import HttpSettings
from wayline.settings import BusSettings, Settings
from wayline_cli.check import Check, Mark
from wayline_cli.check_doors import TOKEN_LENGTH_MIN, check_doors

NOW = dt.datetime(2026, 5, 1, tzinfo=dt.UTC)
LONG = "x" * TOKEN_LENGTH_MIN


def found(settings: Settings, subject: str) -> Check:
    [check] = [check for check in check_doors(settings, NOW) if check.subject == subject]
    return check


def bus_with(path: Path) -> Settings:
    return Settings(bus=BusSettings(tls_cert=str(path)))


@pytest.mark.parametrize(
    ("days", "mark", "said"),
    [
        (90, Mark.FINE, "good until 2026-07-30"),
        (20, Mark.NOTE, "good until 2026-05-21"),
        (-1, Mark.WRONG, "good from 2026-04-20 to 2026-04-30 only"),
        (400, Mark.WRONG, "good from"),
    ],
)
def test_a_certificate_is_told_by_its_end(tmp_path: Path, days: int, mark: Mark, said: str) -> None:
    ends = NOW + dt.timedelta(days=days)
    begins = ends - dt.timedelta(days=10 if days in (-1, 400) else 200)
    issued = trustme.CA().issue_cert("router", not_before=begins, not_after=ends)
    path = tmp_path / "vehicle.pem"
    issued.cert_chain_pems[0].write_to_path(str(path))
    check = found(bus_with(path), "certificate bus.tls_cert")
    assert check.mark is mark
    assert said in check.finding


@pytest.mark.parametrize(("text", "said"), [("no PEM", "holds no PEM"), (None, "cannot be read")])
def test_what_is_no_certificate_is_wrong(tmp_path: Path, text: str | None, said: str) -> None:
    path = tmp_path / "vehicle.pem"
    if text is not None:
        path.write_text(text)
    check = found(bus_with(path), "certificate bus.tls_cert")
    assert (check.mark, said in check.finding) == (Mark.WRONG, True)


def test_a_token_that_could_be_guessed_is_noted() -> None:
    short = Settings(http=HttpSettings(tokens=(LONG, "secret")))
    assert found(short, "tokens").mark is Mark.NOTE
    assert found(Settings(http=HttpSettings(tokens=(LONG,))), "tokens").mark is Mark.FINE


@pytest.mark.parametrize("host", ["0.0.0.0", "::"])
def test_an_address_that_everybody_reaches_is_noted(host: str) -> None:
    assert found(Settings(http=HttpSettings(host=host)), "address").mark is Mark.NOTE


def test_a_service_for_its_own_machine_gets_no_line() -> None:
    assert check_doors(Settings(), NOW) == []
