"""Keeps copies of shared libraries apart from others of the same kind in one process, whoever loads them, and how.

1. The symbols that the libraries named by --of define get names of their own, in them and in all files that use them: `_ZN…` becomes `` `9N… ``.
   The hash of GNU's symbol tables, h = 33 h + c, is the same for both: the first character is one more, the second 33 less. So no table
   changes its order, and no bucket its place. A lookup never finds another kernel's symbol, not even one that was loaded with RTLD_GLOBAL.
   Names without `_Z` count too: C functions, and C++ variables outside of namespaces. OpenCASCADE has such variables with constructors and
   destructors (GLOBAL_DS2d): shared by two kernels, they are made and destroyed twice. Where the usual change would give a name that C can
   have, it is made twice or three times. So no name that is ours can be one of a compiler.
2. Unique symbols (STB_GNU_UNIQUE), of which glibc keeps one for the whole process whatever RTLD_LOCAL says, become weak.

Usage: isolate.py --of 'lib[Tt]*' --but libstdc++.so.6 FILE…   changes the files that are ELF for x86-64, in place; what a --but defines keeps
           its name.
       isolate.py --check …             changes nothing; fails where a symbol is unique, or one of --of still has a name as a compiler gives it.
Who puts other libraries of the same interface in the place of these runs it on copies of all of them.
"""

import argparse
import fnmatch
import re
import struct
import sys
from pathlib import Path

DYNAMIC, HASH, DYNSYM = 6, 5, 11
WEAK, UNIQUE = 2, 10
HIDDEN = 2
SECTION = struct.Struct("<IIQQQQIIQQ")
SYMBOL = struct.Struct("<IBBHQQ")
#: Entries of the dynamic section whose value is a string: needed, soname, rpath, runpath.
STRINGS = {1, 14, 15, 29}
#: How a name begins that a compiler gives. What Python looks for in a module keeps its name.
COMPILED = re.compile(rb"(?!PyInit_)[A-Za-z0-9_]{2}")


def own_name(name: bytes) -> bytes:
    """The name that a symbol gets: of the same length and hash, and none that a compiler gives."""
    ways = (bytes([name[0] + times, name[1] - 33 * times]) for times in (1, 2, 3) if name[1] > 33 * times)
    return next(start for start in ways if not COMPILED.match(start)) + name[2:]


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
        """The names of what is defined here, those apart that are our own by now."""
        shown = {at for place, at, _, here in self.symbols if here and self.data[place + 5] & 3 != HIDDEN}
        return {name for at in shown if COMPILED.match(name := self.text(at))}

    def used(self) -> set[bytes]:
        """The names of what is looked for elsewhere."""
        return {self.text(at) for _, at, _, here in self.symbols if not here}

    def sharing(self) -> set[bytes]:
        """Names whose string is the end of another one, or has another one that begins at its second character: linkers do so. To rename
        one would change both."""
        places = {at for _, at, _, _ in self.symbols}
        first: dict[int, int] = {}
        for at in places | self.others:
            end = self.data.index(0, at)
            first[end] = min(at, first.get(end, at))
        return {
            self.text(at) for at in places if first[self.data.index(0, at)] < at or at + 1 in places | self.others
        }

    def hide(self, names: set[bytes]) -> int:
        """Hides what is defined here by these names, which no other file uses: uses here then find it without a lookup."""
        found = [place for place, at, _, here in self.symbols if here and self.text(at) in names]
        for place in found:
            self.data[place + 5] = self.data[place + 5] & ~3 | HIDDEN
        return len(found)

    def rename(self, names: set[bytes]) -> int:
        """Renames all symbols of these names."""
        chosen = {at for _, at, _, _ in self.symbols if self.text(at) in names}
        if shared := names & self.sharing():
            raise SystemExit(f"{self.path}: {sorted(shared)[0]!r} shares its string with another one")
        if chosen and self.has_old_hash:
            raise SystemExit(f"{self.path}: has a table of the old hash (DT_HASH), which would no longer hold")
        for at in chosen:
            self.data[at : at + 2] = own_name(self.text(at))[:2]
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
    parser.add_argument("--of", action="append", default=[])
    parser.add_argument("--but", action="append", type=Path, default=[])
    parser.add_argument("files", nargs="*", type=Path)
    asked = parser.parse_args()
    elf = [path for path in asked.files if path.is_file() and path.open("rb").read(6) == b"\x7fELF\x02\x01"]
    libraries = [Library(path) for path in elf]
    own = [library for library in libraries if any(fnmatch.fnmatch(library.path.name, pattern) for pattern in asked.of)]
    names = set().union(*(library.defined() for library in own))
    # What the C++ library has, too (instances of its templates), is everybody's.
    for path in asked.but:
        names -= Library(path).defined()
    if asked.check:
        total = sum(len(library.unique()) for library in libraries)
        print(f"{total} unique symbols and {len(names)} names of others in {len(libraries)} files")
        for name in sorted(names)[:10]:
            print(f"  {name.decode()}")
        return int(total > 0 or len(names) > 0 or not libraries)
    if len({own_name(name) for name in names}) < len(names):
        raise SystemExit("two names would become the same")
    used = set().union(*(library.used() for library in libraries))
    alone = (names & set().union(*(library.sharing() for library in libraries))) - used
    hidden = sum(library.hide(alone) for library in own)
    renamed = sum(library.rename(names - alone) for library in libraries)
    weakened = sum(library.weaken() for library in libraries)
    for library in libraries:
        library.path.write_bytes(library.data)
    print(f"{len(names)} symbols of {len(own)} libraries renamed in {renamed} places, {hidden} hidden, {weakened} unique ones made weak")
    return int(not names)


if __name__ == "__main__":
    sys.exit(main())
