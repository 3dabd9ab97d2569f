"""`make campaign OF=readers`: damaged input that coverage guides (atheris), from the examples on.

    PYTHONPATH=tests:tests/models python -m fuzz.guided case out/fuzz/corpus -max_total_time=60

The arguments after the reader and the folder are libFuzzer's own flags. A case file and an archive
are the fuzzer's bytes themselves. For a state, a scene, and the entries of an archive (whose
checksums bytes alone would hardly meet) and of a store, the bytes choose the damage. The fuzzer
stops at the first finding and leaves its bytes in a file: `crash-...`, also for one that took more
processor time than `fuzz.readers.MOST_SECONDS`; `timeout-...` for one that takes more than a
minute; `oom-...` for one that takes more than 2 GB. This reads them again:

    PYTHONPATH=tests:tests/models python -m fuzz.guided case out/fuzz/corpus crash-...
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import atheris

with atheris.instrument_imports(include=["pendcore", "tomllib"], enable_loader_override=False):
    import pendcore  # noqa: F401  (instrumented before the readers import it)

from fuzz.choices import Thing
from fuzz.readers import READERS, finding, read_archive, read_case, whole_archives, whole_cases

CHOICES = [bytes(range(i, i + 64)) for i in range(0, 192, 16)]
SEEDS: dict[str, list[bytes]] = {
    "case": [text.encode() for text in whole_cases()],
    "archive": [*whole_archives(), *CHOICES],
    "state": CHOICES,
    "scene": CHOICES,
    "store": CHOICES,
}


class FromBytes:
    """Choices that the fuzzer's bytes make."""

    def __init__(self, data: bytes) -> None:
        self._data: Any = atheris.FuzzedDataProvider(data)

    def real(self, low: float, high: float) -> float:
        return float(self._data.ConsumeFloatInRange(low, high))

    def integer(self, low: int, high: int) -> int:
        return int(self._data.ConsumeIntInRange(low, high))

    def one_of(self, things: Sequence[Thing]) -> Thing:
        return things[self.integer(0, len(things) - 1)]


def main() -> None:
    """Feed one reader until it fails or the flags end it."""
    reader, folder, *flags = sys.argv[1:]
    corpus = Path(folder, reader)
    corpus.mkdir(parents=True, exist_ok=True)
    for i, seed in enumerate(SEEDS[reader]):
        (corpus / f"seed{i}").write_bytes(seed)

    def one(data: bytes) -> None:
        def read() -> None:
            if reader == "case":
                read_case(data.decode(errors="surrogateescape"))
            elif reader == "archive" and data.startswith(b"PK"):
                read_archive(data)
            else:
                READERS[reader](FromBytes(data))

        found = finding(read)
        if found is not None:
            raise AssertionError(found)

    inputs = [flag for flag in flags if not flag.startswith("-")] or [str(corpus)]
    own = [flag for flag in flags if flag.startswith("-")]
    atheris.Setup([sys.argv[0], "-timeout=60", *own, *inputs], one)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
