"""deploy/wayline.toml says everything that can be set, and says it right."""

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from wayline.settings import Settings, load_settings
from wayline.tuning import Tuning

DEPLOY = Path(__file__).parents[3] / "deploy"
EXAMPLES = {"vehicle": {"gear_ratios", "engine_reference_torque_nm"}, "rerun": {"record"}}
"""Options that are shown with a value though they have none by default."""


def commented() -> str:
    return (DEPLOY / "wayline.toml").read_text(encoding="utf-8")


def uncommented() -> str:
    """The file with every option taken out of its comment."""
    return re.sub(r"^#(?=\S)", "", commented(), flags=re.MULTILINE)


def structs(kind: msgspec.inspect.Type) -> Iterator[msgspec.inspect.StructType]:
    """Every Struct within a type."""
    match kind:
        case msgspec.inspect.StructType():
            yield kind
            for field in kind.fields:
                yield from structs(field.type)
        case msgspec.inspect.UnionType():
            for each in kind.types:
                yield from structs(each)
        case msgspec.inspect.VarTupleType():
            yield from structs(kind.item_type)
        case msgspec.inspect.DictType():
            yield from structs(kind.value_type)


OPTIONS = sorted(
    {
        (struct.cls.__name__, field.encode_name)
        for struct in structs(msgspec.inspect.type_info(Settings))
        for field in struct.fields
    }
)


@pytest.mark.parametrize("name", ["wayline.toml", "server.toml", "dashboard.toml"])
def test_the_file_loads_as_it_stands(name: str) -> None:
    assert load_settings(DEPLOY / name, {}).served()


@pytest.mark.parametrize(("table", "option"), OPTIONS, ids=lambda text: text)
def test_every_option_is_there(table: str, option: str) -> None:
    assert re.search(rf"\b{option} = |^#?\[+(can\.)?{option}\]", uncommented(), re.MULTILINE)


def test_every_option_loads_when_it_is_set() -> None:
    settings = msgspec.convert(tomllib.loads(uncommented()), Settings)
    assert settings.can[0].signals
    assert settings.bus.user == settings.vehicle_id


@pytest.mark.parametrize("table", ["tuning", "vehicle", "rerun"])
def test_the_defaults_that_are_shown_are_the_defaults(table: str) -> None:
    shown = getattr(msgspec.convert(tomllib.loads(uncommented()), Settings), table)
    default = getattr(Settings(), table)
    different = {
        field
        for field in shown.__struct_fields__
        if getattr(shown, field) != getattr(default, field)
    }
    assert different == EXAMPLES.get(table, set())


def test_every_parameter_of_the_estimators_has_its_reason() -> None:
    lines = commented().partition("[tuning]")[2].splitlines()
    for option in Tuning.__struct_fields__:
        (place,) = [n for n, line in enumerate(lines) if line.startswith(f"#{option} = ")]
        assert re.match(r"# \S", lines[place - 1])


def test_what_compose_and_the_image_name_is_there() -> None:
    compose = (DEPLOY / "compose.yaml").read_text(encoding="utf-8")
    mounted = re.findall(r"- (\./[^:]+):", compose)
    dockerfile = (DEPLOY / "Dockerfile").read_text(encoding="utf-8")
    copied = re.findall(r"^COPY (?!--from)(.+) \S+$", dockerfile, re.MULTILINE)
    assert len(mounted) == 5
    assert all((DEPLOY / name).is_file() for name in mounted)
    assert all((DEPLOY.parent / name).exists() for line in copied for name in line.split())
