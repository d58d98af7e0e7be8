"""Keeps copies of shared libraries apart from others of the same kind in one process, whoever loads them, and how.

1. The symbols that the libraries named by --of define get names of their own, in them and in all files that use them: `_ZN…` becomes `` `9N… ``.
   The hash of GNU's symbol tables, h = 33 h + c, is the same for both: the first character is one more, the second 33 less. So no table
   changes its order, and no bucket its place. A lookup never finds another kernel's symbol, not even one that was loaded with RTLD_GLOBAL.
2. Unique symbols (STB_GNU_UNIQUE), of which glibc keeps one for the whole process whatever RTLD_LOCAL says, become weak.

Usage: isolate.py --of 'lib[Tt]*' --but libstdc++.so.6 FILE…   changes the files that are ELF for x86-64, in place; what a --but defines keeps
           its name.
       isolate.py --check FILE…         changes nothing; fails where a symbol is unique.
Who puts other libraries of the same interface in the place of these runs it on copies of all of them.
"""

import argparse
import fnmatch
import struct
import sys
from pathlib import Path

DYNAMIC, HASH, DYNSYM = 6, 5, 11
WEAK, UNIQUE = 2, 10
SECTION = struct.Struct("<IIQQQQIIQQ")
SYMBOL = struct.Struct("<IBBHQQ")
#: Entries of the dynamic section whose value is a string: needed, soname, rpath, runpath.
STRINGS = {1, 14, 15, 29}


class Library:
    """The dynamic symbols of a file: (place, name's place in the file, info, whether it is defined here)."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.data = bytearray(path.read_bytes())
        (start,) = struct.unpack_from("<Q", self.data, 40)
        size, count = struct.unpack_from("<HH", self.data, 58)
        sections = [SECTION.unpack_from(self.data, start + number * size) for number in range(count)]
        table = next((section for section in sections if section[1] == DYNSYM), None)
        self.symbols: list[tuple[int, int, int, bool]] = []
        self.others: set[int] = set()
        self.has_old_hash = any(section[1] == HASH for section in sections)
        if table is None:
            return
        names = sections[table[6]][4]
        for place in range(table[4], table[4] + table[5], SYMBOL.size):
            name, info, _, section, _, _ = SYMBOL.unpack_from(self.data, place)
            self.symbols.append((place, names + name, info, section != 0))
        for _, kind, _, _, offset, length, link, *_ in sections:
            if kind == DYNAMIC:
                for place in range(offset, offset + length, 16):
                    tag, value = struct.unpack_from("<QQ", self.data, place)
                    if tag in STRINGS:
                        self.others.add(sections[link][4] + value)

    def text(self, place: int) -> bytes:
        """The string at a place."""
        return bytes(self.data[place : self.data.index(0, place)])

    def defined(self) -> set[bytes]:
        """The mangled names of what is defined here."""
        return {name for _, at, _, here in self.symbols if here and (name := self.text(at)).startswith(b"_Z")}

    def rename(self, names: set[bytes]) -> int:
        """Renames all symbols of these names."""
        places = {at for _, at, _, _ in self.symbols}
        chosen = {at for at in places if self.text(at) in names}
        # Linkers let a string be the end of another one: then both would change.
        ends: dict[int, int] = {}
        for at in places | self.others:
            end = self.data.index(0, at)
            ends[end] = min(at, ends.get(end, at))
        for at in chosen:
            end = self.data.index(0, at)
            if ends[end] < at or at + 1 in places | self.others:
                raise SystemExit(f"{self.path}: {self.text(at)!r} shares its string with another one")
        if chosen and self.has_old_hash:
            raise SystemExit(f"{self.path}: has a table of the old hash (DT_HASH), which would no longer hold")
        for at in chosen:
            self.data[at : at + 2] = bytes([ord("_") + 1, ord("Z") - 33])
        return len(chosen)

    def unique(self) -> list[int]:
        """Where unique symbols stand."""
        return [place for place, _, info, _ in self.symbols if info >> 4 == UNIQUE]

    def weaken(self) -> int:
        """Makes the unique symbols weak."""
        found = self.unique()
        for place in found:
            self.data[place + 4] = WEAK << 4 | self.data[place + 4] & 15
        return len(found)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--of", default="")
    parser.add_argument("--but", action="append", type=Path, default=[])
    parser.add_argument("files", nargs="*", type=Path)
    asked = parser.parse_args()
    elf = [path for path in asked.files if path.is_file() and path.open("rb").read(6) == b"\x7fELF\x02\x01"]
    libraries = [Library(path) for path in elf]
    if asked.check:
        total = sum(len(library.unique()) for library in libraries)
        print(f"{total} unique symbols in {len(libraries)} files")
        return int(total > 0 or not libraries)
    own = [library for library in libraries if fnmatch.fnmatch(library.path.name, asked.of)]
    names = set().union(*(library.defined() for library in own))
    # What the C++ library has, too (instances of its templates), is everybody's.
    for path in asked.but:
        names -= Library(path).defined()
    renamed = sum(library.rename(names) for library in libraries)
    weakened = sum(library.weaken() for library in libraries)
    for library in libraries:
        library.path.write_bytes(library.data)
    print(f"{len(names)} symbols of {len(own)} libraries renamed in {renamed} places, {weakened} unique ones made weak")
    return int(not names)


if __name__ == "__main__":
    sys.exit(main())
