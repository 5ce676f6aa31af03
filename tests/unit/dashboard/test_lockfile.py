import json
from pathlib import Path

LOCKFILE = Path(__file__).parents[3] / "services" / "dashboard" / "web" / "package-lock.json"


def test_the_lockfile_carries_no_addresses() -> None:
    text = LOCKFILE.read_text()
    assert "://" not in text, "run `npm run lock` in services/dashboard/web"


def test_every_package_is_pinned_by_its_hash() -> None:
    packages = json.loads(LOCKFILE.read_text())["packages"]
    assert len(packages) > 20
    unpinned = [name for name, entry in packages.items() if name and "integrity" not in entry]
    assert unpinned == []
