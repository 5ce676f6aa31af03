"""Independence is a test: what may import what."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SERVICES = {path.name for path in (ROOT / "services").glob("*/wayline_*")}
IO_MODULES = {
    "asyncio", "can", "fastapi", "http", "io", "logging", "os", "pathlib", "random", "requests",
    "rerun", "socket", "sqlalchemy", "subprocess", "tempfile", "threading", "time", "uvicorn",
    "zenoh",
}  # fmt: skip
SCHEMAS = {"tables.py"}
"""Table definitions name SQLAlchemy's types and touch no database."""


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


@pytest.mark.parametrize("path", sources("services"), ids=lambda path: str(path.relative_to(ROOT)))
def test_no_service_imports_another(path: Path) -> None:
    own = next(part for part in path.parts if part in SERVICES)
    others = SERVICES - {own} | {"wayline_cli"}
    assert not others & {name.split(".")[0] for name in imports(path)}


@pytest.mark.parametrize("path", sources("shared"), ids=lambda path: str(path.relative_to(ROOT)))
def test_shared_code_imports_no_service(path: Path) -> None:
    assert not (SERVICES | {"wayline_cli"}) & {name.split(".")[0] for name in imports(path)}


@pytest.mark.parametrize("service", sorted(SERVICES))
def test_every_service_has_a_pure_core(service: str) -> None:
    (core,) = (ROOT / "services").glob(f"*/{service}/core.py")
    assert is_pure(core)


def test_what_says_pure_does_no_input_or_output() -> None:
    """And imports, within the repository, only what says so too (or a file format's schema)."""
    offenders = {
        f"{path.relative_to(ROOT)} imports {name}"
        for path in sources("shared", "services")
        if is_pure(path)
        for name in imports(path)
        if name.split(".")[0] in IO_MODULES and path.name not in SCHEMAS
    }
    assert not offenders


def test_topics_are_listed_in_one_place_only() -> None:
    """A topic's name stands in messages.py; elsewhere the message class is used."""
    allowed = {"messages.py", "quantity.py", "core.py"}
    offenders = [
        str(path.relative_to(ROOT))
        for path in sources("shared", "services", "tools")
        if path.name not in allowed and '"fusion_status"' in path.read_text(encoding="utf-8")
    ]
    assert not offenders
