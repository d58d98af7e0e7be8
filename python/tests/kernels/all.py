"""Runs one.py for every order of the packages named, each in a process of its own; then with all symbols shared, ours last and first."""

import itertools
import subprocess
import sys
from pathlib import Path


def main() -> int:
    names = sys.argv[1:]
    script = Path(__file__).with_name("one.py")
    ways = [list(order) for order in itertools.permutations(names)]
    others = [name for name in names if name != "geo_adapt"]
    ways += [["--global", *others, "geo_adapt"], ["--global", "geo_adapt", *others]]
    failed = 0
    for way in ways:
        done = subprocess.run([sys.executable, script, *way], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            failed += 1
            print(f"FAILED {' '.join(way)}: exit code {done.returncode}\n{done.stderr[-600:]}", flush=True)
    print(f"{len(ways) - failed} passed, {failed} failed")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
