"""Runs one.py for every order of the packages named, each in a process of its own, and with all symbols of the others shared (RTLD_GLOBAL).

An order in which the others crash without geo_adapt, too, is told apart: netgen before build123d does.
"""

import itertools
import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).with_name("one.py")


def run(way: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, SCRIPT, *way], capture_output=True, text=True, check=False)


def main() -> int:
    names = sys.argv[1:]
    own, other = names[:2]
    ways = [list(order) for order in itertools.permutations(names)]
    ways += [["--global", own, other], ["--global", other, own]]
    alone: dict[tuple[str, ...], bool] = {}
    passed, failed, theirs = 0, 0, 0
    for way in ways:
        done = run(way)
        if done.returncode == 0:
            passed += 1
            continue
        rest = tuple(name for name in way if name != own)
        if rest not in alone:
            alone[rest] = run(list(rest)).returncode == 0
        if alone[rest]:
            failed += 1
            print(f"FAILED {' '.join(way)}: exit code {done.returncode}\n{done.stderr[-600:]}", flush=True)
        else:
            theirs += 1
    crashing = [" ".join(rest) for rest, is_fine in alone.items() if not is_fine]
    print(f"{theirs} orders crash without {own}, too: {'; '.join(crashing)}" if theirs else f"no order crashes without {own}")
    print(f"{passed} passed, {failed} failed")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
