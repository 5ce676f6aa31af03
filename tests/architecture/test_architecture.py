"""Independence is a test: what may import what."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SERVICES = {path.name for path in (ROOT / "services").glob("*/wayline_*")}
TOOLS = {path.name for path in (ROOT / "tools").glob("wayline_*")}
IO_MODULES = {
    "asyncio", "can", "fastapi", "http", "io", "logging", "os", "pathlib", "random", "requests",
    "rerun", "socket", "sqlalchemy", "subprocess", "tempfile", "threading", "time", "uvicorn",
    "zenoh",
}  # fmt: skip
SCHEMAS = {"tables.py"}
"""Table definitions name SQLAlchemy's types and touch no database."""

NOT_PURE = {
    "wayline": "the package itself holds nothing but the version",
}
"""What a pure module may import though it does not say that it is one, and why."""


def sources(*folders: str) -> list[Path]:
    return sorted(
        path
        for folder in folders
        for path in (ROOT / folder).rglob("*.py")
        if "node_modules" not in path.parts
    )


def imports(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not names_only(node):
            yield node.module


def names_only(node: ast.ImportFrom) -> bool:
    """Whether no file is touched: a PurePath is a text with parts."""
    return node.module == "pathlib" and {alias.name for alias in node.names} == {"PurePath"}


def is_pure(path: Path) -> bool:
    docstring = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return docstring.startswith("Pure:")


def modules_imported(path: Path) -> Iterator[str]:
    """Modules of the repository; of `from package import module` the module, not the package."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in MODULES)
        elif isinstance(node, ast.ImportFrom) and node.module in MODULES:
            names = (f"{node.module}.{alias.name}" for alias in node.names)
            yield from (name if name in MODULES else node.module for name in names)


def module_name(path: Path) -> str:
    """`wayline_eta.core`: what follows the folder that a package lies in."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    within = parts[2:] if parts[0] == "services" else parts[1:]
    return ".".join(within).removesuffix(".__init__")


MODULES = {module_name(path): path for path in sources("shared", "services", "tools")}
PURE = {name: path for name, path in MODULES.items() if is_pure(path)}


@pytest.mark.parametrize("path", sources("services"), ids=lambda path: str(path.relative_to(ROOT)))
def test_no_service_imports_another_or_a_tool(path: Path) -> None:
    own = next(part for part in path.parts if part in SERVICES)
    others = (SERVICES | TOOLS) - {own}
    assert not others & {name.split(".")[0] for name in imports(path)}


@pytest.mark.parametrize("path", sources("shared"), ids=lambda path: str(path.relative_to(ROOT)))
def test_shared_code_imports_no_service_and_no_tool(path: Path) -> None:
    assert not (SERVICES | TOOLS) & {name.split(".")[0] for name in imports(path)}


@pytest.mark.parametrize("service", sorted(SERVICES))
def test_every_service_thinks_in_a_pure_core_or_shows_by_a_pure_view_model(service: str) -> None:
    """One of the two: a view model beside a core would answer the core's questions again."""
    (folder,) = (ROOT / "services").glob(f"*/{service}")
    minds = [folder / name for name in ("core.py", "view_model.py") if (folder / name).is_file()]
    assert [is_pure(mind) for mind in minds] == [True]


def test_what_says_pure_does_no_input_or_output() -> None:
    offenders = {
        f"{name} imports {imported}"
        for name, path in PURE.items()
        for imported in imports(path)
        if imported.split(".")[0] in IO_MODULES and path.name not in SCHEMAS
    }
    assert not offenders


def test_what_says_pure_imports_only_what_says_so_too() -> None:
    """Within the repository; what it imports elsewhere is the other test's business."""
    offenders = {
        f"{name} imports {imported}"
        for name, path in PURE.items()
        for imported in modules_imported(path)
        if imported not in PURE and imported not in NOT_PURE
    }
    assert not offenders


def test_every_exception_is_still_one() -> None:
    needed = {imported for path in PURE.values() for imported in modules_imported(path)}
    assert set(NOT_PURE) <= needed - set(PURE)


def test_one_matcher_says_where_a_vehicle_is_on_a_line() -> None:
    """Nothing else in the services that follow lines projects positions on them, but these."""
    allowed = {
        "avl_filter.py": "the published filter's own matching",
        "core.py": "which route is nearest to a first fix of the published filter",
        "roads.py": "lines beside lines",
    }
    services = [ROOT / "services" / name for name in ("eta", "slope-map")]
    projecting = {
        path.name
        for path in sources("services/eta", "services/slope-map")
        if re.search(r"\.(project|project_legs)\(", path.read_text(encoding="utf-8"))
    }
    assert projecting == set(allowed)
    for service in services:
        importing = {name for path in service.rglob("*.py") for name in imports(path)}
        assert "wayline.matching.matcher" in importing


def test_topics_are_listed_in_one_place_only() -> None:
    """A topic's name stands in messages.py; elsewhere the message class is used."""
    allowed = {"messages.py", "quantity.py", "core.py"}
    offenders = [
        str(path.relative_to(ROOT))
        for path in sources("shared", "services", "tools")
        if path.name not in allowed and '"fusion_status"' in path.read_text(encoding="utf-8")
    ]
    assert not offenders
