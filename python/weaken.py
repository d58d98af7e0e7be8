"""Makes the unique symbols (STB_GNU_UNIQUE) of shared libraries weak.

The dynamic loader of glibc keeps one of each unique symbol for the whole process, whatever RTLD_LOCAL says: two kernels of OpenCASCADE would
share the statics of each other's functions. A weak symbol is looked up within the libraries that were loaded together, as all others are. Only
the binding in the symbol table changes: no name, no hash, no order. Usage: weaken.py FILE... (those that are ELF for x86-64 are changed in
place); with --check it changes nothing, and fails where there is one.
"""

import struct
import sys
from pathlib import Path

DYNSYM = 11
WEAK, UNIQUE = 2, 10
SECTION = struct.Struct("<IIQQQQIIQQ")
SYMBOL = 24


def unique_symbols(data: bytes | bytearray) -> list[int]:
    """Where in a file the `st_info` of its unique dynamic symbols stand."""
    if data[:6] != b"\x7fELF\x02\x01":
        return []
    (start,) = struct.unpack_from("<Q", data, 40)
    size, count = struct.unpack_from("<HH", data, 58)
    found = []
    for number in range(count):
        _, kind, _, _, offset, length, *_ = SECTION.unpack_from(data, start + number * size)
        if kind == DYNSYM:
            places = range(offset + 4, offset + length, SYMBOL)
            found += [place for place in places if data[place] >> 4 == UNIQUE]
    return found


def main() -> int:
    check = "--check" in sys.argv
    total = 0
    for name in sys.argv[1:]:
        path = Path(name)
        if name == "--check" or not path.is_file():
            continue
        data = bytearray(path.read_bytes())
        found = unique_symbols(data)
        total += len(found)
        if found and not check:
            for place in found:
                data[place] = WEAK << 4 | data[place] & 15
            path.write_bytes(data)
    print(f"{total} unique symbols {'found' if check else 'made weak'}")
    return int(check and total > 0)


if __name__ == "__main__":
    sys.exit(main())
