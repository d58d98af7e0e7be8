"""python/isolate.py: two libraries of the same names in one process keep apart, whatever the first of them shares."""

import importlib.util
import os
import re
import subprocess
import sys
import tempfile
import unittest
from itertools import product
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "python" / "isolate.py"
SPEC = importlib.util.spec_from_file_location("isolate", SCRIPT)
isolate = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(isolate)

# What an OpenCASCADE has: a variable outside of namespaces with constructor and destructor, a C function, a C++ function. `Tail` is the end of
# another string of the library, which its linker lets it be.
SOURCE = """
int constructions;
struct Once { Once() { ++constructions; } };
Once GlobalObject;
int NameOfTail = NUMBER, Tail = NUMBER;
extern "C" int of_c() { return NUMBER; }
int of_cpp() { return NUMBER; }
extern "C" __attribute__((visibility("default"))) int PyInit_seen() {
    return constructions * 1000 + NameOfTail + Tail + of_c() + of_cpp() + (&GlobalObject == nullptr);
}
"""
ASKED = "import ctypes, sys; first, second = (ctypes.CDLL(p, mode=m) for p, m in zip(sys.argv[1:], (ctypes.RTLD_GLOBAL, 0))); " \
    "print(first.PyInit_seen(), second.PyInit_seen())"


def gnu_hash(name: bytes) -> int:
    value = 5381
    for byte in name:
        value = (33 * value + byte) % 2**32
    return value


class Names(unittest.TestCase):
    def test_a_name_of_our_own_has_the_same_hash_and_is_none_of_a_compiler(self):
        letters = [byte for byte in range(128) if re.match(rb"\w", bytes([byte]))]
        for pair in product(letters, letters):
            name = bytes(pair) + b"rest"
            own = isolate.own_name(name)
            self.assertEqual((len(own), gnu_hash(own)), (len(name), gnu_hash(name)))
            self.assertFalse(isolate.COMPILED.match(own) or 0 in own, own)
        self.assertEqual(isolate.own_name(b"_ZN4Name"), b"`9N4Name")


@unittest.skipUnless(sys.platform == "linux" and os.uname().machine == "x86_64", "shared libraries of Linux on x86-64")
class Libraries(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.paths = []
        for number in (1, 2):
            source, path = Path(folder.name, f"{number}.cpp"), Path(folder.name, f"libTK{number}.so")
            source.write_text(SOURCE.replace("NUMBER", str(number)))
            subprocess.run(["g++", "-O1", "-shared", "-fPIC", "-Wl,--hash-style=gnu", source, "-o", path], check=True)
            self.paths.append(path)

    def isolated(self, *options):
        return subprocess.run([sys.executable, SCRIPT, *options, "--of", "libTK*", self.paths[1]], capture_output=True, text=True)

    def test_two_names_that_would_become_the_same_are_refused(self):
        self.assertEqual(isolate.own_name(b"cBx"), isolate.own_name(b"bcx"))
        source = self.paths[1].with_suffix(".cpp")
        source.write_text('extern "C" int cBx() { return 1; } extern "C" int bcx() { return 2; }')
        subprocess.run(["g++", "-shared", "-fPIC", source, "-o", self.paths[1]], check=True)
        before = self.paths[1].read_bytes()
        self.assertIn("become the same", self.isolated().stderr)
        self.assertEqual(self.paths[1].read_bytes(), before)

    def seen(self):
        done = subprocess.run([sys.executable, "-c", ASKED, *self.paths], capture_output=True, text=True, check=True)
        return [int(word) for word in done.stdout.split()]

    def test_nothing_of_the_second_is_the_firsts(self):
        # As they are, the second takes the first's variables and functions, and makes its variable again.
        self.assertEqual(self.seen()[1], 2004)
        refused = self.isolated("--check")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("GlobalObject", refused.stdout)
        made = self.isolated()
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(self.isolated("--check").returncode, 0)
        self.assertEqual(self.seen(), [1004, 1008])


if __name__ == "__main__":
    unittest.main()
