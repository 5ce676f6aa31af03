"""The access control that a fleet's router file carries."""

import json
from pathlib import Path
from typing import Any

import pytest
import zenoh

from wayline.errors import InputError
from wayline.messages import MESSAGES, Health
from wayline_cli.access import SERVER_SOURCES, VEHICLE_SOURCES, access_control
from wayline_cli.access_file import main, rewrite

SERVER = Path(__file__).parents[3] / "deploy/zenoh/server.json5"


@pytest.fixture
def router_file(tmp_path: Path) -> Path:
    """A copy of the server's file, as an operator begins."""
    path = tmp_path / "server.json5"
    path.write_text(SERVER.read_text(encoding="utf-8"), encoding="utf-8")
    return path


def table(path: Path) -> Any:
    return json.loads(zenoh.Config.from_file(str(path)).get_json("access_control"))


def rules(vehicle_ids: list[str]) -> dict[str, object]:
    return {rule["id"]: rule for rule in access_control(vehicle_ids)["rules"]}


def test_the_committed_file_is_what_the_command_writes(router_file: Path) -> None:
    committed = router_file.read_text(encoding="utf-8")
    assert main([str(router_file), "bus-1", "bus-2"]) == 0
    assert router_file.read_text(encoding="utf-8") == committed


def test_a_fleet_grows_and_shrinks_in_place(router_file: Path) -> None:
    committed = router_file.read_text(encoding="utf-8")
    rewrite(router_file, ["tram-7", "bus-1", "bus-2"])
    users = {subject["usernames"][0] for subject in access_control(["tram-7"])["subjects"]}
    assert users == {"_services", "_dashboard", "tram-7"}
    assert '"tram-7 says"' in json.dumps(table(router_file))
    rewrite(router_file, ["bus-1", "bus-2"])
    assert router_file.read_text(encoding="utf-8") == committed


def test_every_policy_names_rules_and_subjects_that_are_there() -> None:
    control = access_control(["a", "b"])
    ids = {rule["id"] for rule in control["rules"]}
    subjects = {subject["id"] for subject in control["subjects"]}
    assert {rule for policy in control["policies"] for rule in policy["rules"]} == ids
    assert {subject for policy in control["policies"] for subject in policy["subjects"]} == subjects
    assert len(ids) == len(control["rules"])


def test_with_certificates_a_vehicle_is_who_its_certificate_says(router_file: Path) -> None:
    assert main(["--certificates", str(router_file), "bus-1"]) == 0
    subjects = {subject["id"]: subject for subject in table(router_file)["subjects"]}
    assert subjects["bus-1"]["cert_common_names"] == ["bus-1"]
    assert not subjects["_services"].get("cert_common_names")


def test_every_topic_has_one_side_that_may_publish_it() -> None:
    sides = [
        {message for messages in sources.values() for message in messages}
        for sources in (VEHICLE_SOURCES, SERVER_SOURCES)
    ]
    assert sides[0] | sides[1] | {Health} == set(MESSAGES)
    assert not sides[0] & sides[1]


def test_another_vehicle_changes_nothing_for_the_first() -> None:
    assert rules(["a"]).items() <= rules(["a", "b"]).items()


@pytest.mark.parametrize(
    ("vehicle_ids", "what"),
    [
        (["Bus 1"], "vehicle 'Bus 1': is no vehicle id; use"),
        (["_services"], "vehicle '_services': is no vehicle id"),
        (["*"], "vehicle '*': is no vehicle id"),
        (["a", "b", "a"], "vehicle 'a': is there 2 times; name each"),
    ],
)
def test_other_names_are_refused(
    router_file: Path,
    vehicle_ids: list[str],
    what: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = router_file.read_text(encoding="utf-8")
    assert main([str(router_file), *vehicle_ids]) == 2
    assert what in capsys.readouterr().err
    assert router_file.read_text(encoding="utf-8") == before


def test_a_file_without_the_marking_lines_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "other.json5"
    path.write_text("{ mode: 'router' }", encoding="utf-8")
    with pytest.raises(InputError, match="begin with a copy of"):
        rewrite(path, ["a"])
    with pytest.raises(InputError, match="no such file"):
        rewrite(tmp_path / "missing.json5", ["a"])
    assert path.read_text(encoding="utf-8") == "{ mode: 'router' }"
