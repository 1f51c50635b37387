"""Packs a folder into a .tar.gz or .zip whose bytes depend on its content alone, and writes the checksum beside it."""

import gzip
import hashlib
import os
import sys
import tarfile
import zipfile
from pathlib import Path

# The earliest time that ZIP knows.
EPOCH = (1980, 1, 1, 0, 0, 0)


def members(folder: Path) -> list[tuple[Path, str, int]]:
    """Files, their names in the archive and their modes."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    modes = (0o755 if os.access(path, os.X_OK) else 0o644 for path in files)
    return [(path, path.relative_to(folder.parent).as_posix(), mode) for path, mode in zip(files, modes, strict=True)]


def zipped(folder: Path, archive: Path) -> None:
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as out:
        for path, name, mode in members(folder):
            entry = zipfile.ZipInfo(name, EPOCH)
            entry.external_attr = mode << 16
            out.writestr(entry, path.read_bytes(), zipfile.ZIP_DEFLATED)


def tarred(folder: Path, archive: Path) -> None:
    with (
        archive.open("wb") as file,
        gzip.GzipFile("", "wb", fileobj=file, mtime=0) as packed,
        tarfile.open(fileobj=packed, mode="w") as out,
    ):
        for path, name, mode in members(folder):
            entry = tarfile.TarInfo(name)
            entry.size, entry.mode = path.stat().st_size, mode
            with path.open("rb") as content:
                out.addfile(entry, content)


folder, archive = map(Path, sys.argv[1:])
(zipped if archive.suffix == ".zip" else tarred)(folder, archive)
digest = hashlib.sha256(archive.read_bytes()).hexdigest()
# As sha256sum -c reads it.
Path(f"{archive}.sha256").write_bytes(f"{digest}  {archive.name}\n".encode())
print(archive)
