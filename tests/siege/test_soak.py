"""What holds more and more is told apart from what only breathes; the short form of a soak."""

from pathlib import Path

import pytest

from siege.soak import Sample, growth, soaked


def flat(memory_bytes: int, files: int) -> bool:
    """Whether a process that grows by so much a sample counts as flat."""
    held = [Sample(100_000_000 + memory_bytes * at, 20 + files * at) for at in range(100)]
    return growth(held).is_flat


def test_a_process_that_keeps_what_it_was_told_is_not_flat() -> None:
    assert flat(0, 0)
    assert flat(10_000, 0)
    assert not flat(100_000, 0)
    assert not flat(0, 1)


def test_memory_that_is_taken_once_is_flat() -> None:
    """Caches fill in the first quarter."""
    held = [Sample(50_000_000 if at < 20 else 90_000_000, 20) for at in range(100)]
    assert growth(held).is_flat


def test_at_twenty_times_speed_no_service_keeps_files_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Memory is still being filled in so short a time; `scripts/siege soak` weighs it."""
    monkeypatch.setattr("siege.soak.MEMORY_GROWTH", 1.0)
    grown = soaked(tmp_path, 2.0, 20.0)
    assert grown.keys() >= {"router", "fusion", "dashboard"}
    assert [name for name, each in grown.items() if not each.is_flat] == []
