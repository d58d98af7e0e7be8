"""Writes the models of build123d, or those named, in one process: importing build123d takes longer than most models do.

    write_all.py [-o FOLDER] [NAME ...]

They come to FOLDER/build123d (default: this folder).
"""

import argparse
import importlib
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
FAMILIES = ("lofts", "sketches", "sweeps")


def models():
    """{name: function that builds it}."""
    found = {}
    for family in FAMILIES:
        for name, build in importlib.import_module(family).MODELS.items():
            if name in found:
                sys.exit(f"{family}.py: there is a model {name} already")
            found[name] = build
    return found


def write(part, name, folder):
    """Writes the one solid of a part (lengths in millimetres, as OCCT has it) to `folder/name.step`, always with the same bytes."""
    from build123d import export_step

    sys.path.append(str(HERE.parent))
    import step

    solids = part.solids()
    if len(solids) != 1 or not solids[0].is_valid:
        sys.exit(f"{name}: expected one valid solid, got {len(solids)}")
    path = folder / f"{name}.step"
    solid = solids[0]
    solid.label = name
    if not export_step(solid, path):
        sys.exit(f"{path} was not written")
    step.fix_chance(path, name)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=HERE.parent, metavar="FOLDER")
    parser.add_argument("names", nargs="*", metavar="NAME", help="default: all")
    options, known = parser.parse_args(), models()
    unknown = [name for name in options.names if name not in known]
    if unknown:
        parser.error(f"no model {', '.join(unknown)}; there are {', '.join(known)}")
    folder = options.output / "build123d"
    folder.mkdir(parents=True, exist_ok=True)
    for name in options.names or known:
        print(f"wrote {write(known[name](), name, folder)}", flush=True)


if __name__ == "__main__":
    main()
