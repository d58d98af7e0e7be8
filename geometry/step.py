"""Writes a shape as STEP so that the same model always gives the same bytes."""

import argparse
import re
import sys
from pathlib import Path

# OCCT writes the time of day into the header; a fixed one makes a rewritten file compare equal.
FIXED_TIME = "2000-01-01T00:00:00"
HEADER_TIME = re.compile(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'")


def write(workplane, name, folder):
    """Writes the one solid of `workplane` (lengths in millimetres, as OCCT has it) to `folder/name.step`; returns the path."""
    import cadquery
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_Writer

    solids = workplane.solids().vals()
    if len(solids) != 1 or not solids[0].isValid():
        sys.exit(f"{name}: expected one valid solid, got {len(solids)}")
    path = Path(folder) / f"{name}.step"
    # The static settings come into being with the first writer.
    STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.product.name", name)
    cadquery.exporters.export(cadquery.Workplane(solids[0]), str(path))
    fix_time(path)
    return path


def write_assembly(assembly, name, folder):
    """Writes the solids of a cadquery `assembly`, with their names and colours and those of their faces, to `folder/name.step`."""
    from cadquery.occ_impl.exporters.assembly import exportStepMeta

    path = Path(folder) / f"{name}.step"
    exportStepMeta(assembly, str(path))
    fix_time(path)
    return path


def fix_time(path):
    """Replaces the time stamp in the header of a STEP file."""
    text, times = HEADER_TIME.subn(f"'{FIXED_TIME}'", path.read_text(encoding="ascii"))
    if times != 1:
        sys.exit(f"{path}: expected one time stamp in the header, found {times}: OCCT writes another header now, adapt HEADER_TIME")
    path.write_text(text, encoding="ascii", newline="\n")


def main(build, name, writer=write):
    """The command line of a model script: `[-o FOLDER]`, this folder by default."""
    parser = argparse.ArgumentParser(description=f"Writes {name}.step.")
    parser.add_argument("-o", "--output", default=Path(__file__).parent, help="folder to write to (default: this one)")
    path = writer(build(), name, parser.parse_args().output)
    print(f"wrote {path}")
