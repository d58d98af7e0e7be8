"""Writes all models, or those named, in one process: importing cadquery takes longer than most models do.

    write_all.py [-o FOLDER] [NAME ...]

Those of the scripts in this folder come to FOLDER (default: here), those of aircraft/, faults/ and zoo/ to folders of that name in it.
"""

import argparse
import importlib
import sys
from pathlib import Path

import step

HERE = Path(__file__).resolve().parent
NO_MODELS = {"step", "write_all"}


def models():
    """{name: (function that builds it, its folder under the output)}."""
    found = {}
    for script in sorted(HERE.glob("*.py")):
        if script.stem not in NO_MODELS:
            found[script.stem.replace("_", "-")] = (importlib.import_module(script.stem).build, "")
    for folder in ("aircraft", "faults"):
        for script in sorted((HERE / folder).glob("[!_]*.py")):
            found[script.stem.replace("_", "-")] = (importlib.import_module(f"{folder}.{script.stem}").build, folder)
    for script in sorted((HERE / "zoo").glob("*.py")):
        for name, build in getattr(importlib.import_module(f"zoo.{script.stem}"), "MODELS", {}).items():
            if name in found:
                sys.exit(f"{script}: there is a model {name} already")
            found[name] = (build, "zoo")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=HERE, metavar="FOLDER")
    parser.add_argument("names", nargs="*", metavar="NAME", help="default: all")
    options, known = parser.parse_args(), models()
    unknown = [name for name in options.names if name not in known]
    if unknown:
        parser.error(f"no model {', '.join(unknown)}; there are {', '.join(known)}")
    for name in options.names or known:
        build, place = known[name]
        (options.output / place).mkdir(parents=True, exist_ok=True)
        print(f"wrote {step.write(build(), name, options.output / place)}", flush=True)


if __name__ == "__main__":
    main()
