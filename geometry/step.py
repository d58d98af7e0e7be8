"""Writes a shape as STEP so that the same model always gives the same bytes."""

import argparse
import itertools
import re
import sys
from pathlib import Path

# OCCT writes the time of day into the header; a fixed one makes a rewritten file compare equal.
FIXED_TIME = "2000-01-01T00:00:00"
HEADER_TIME = re.compile(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'")
# Half of a large file would be the edges' curves in the parameters of their faces, which a reader computes from those in space.
WITHOUT_PCURVES = {"transport", "transport-half"}


def write(model, name, folder):
    """Writes a model (lengths in millimetres, as OCCT has it) to `folder/name.step`; returns the path.

    A Workplane with one solid, or an Assembly, or a compound of surfaces, or a list of solids: several regions. STEP has a face between two solids
    twice, once for each; so these are also written as `folder/name.brep`, where it is one face of both.
    """
    import cadquery
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_Writer

    if isinstance(model, cadquery.Assembly):
        return write_assembly(model, name, folder)
    shape = _shape(model, name)
    path = Path(folder) / f"{name}.step"
    # The static settings come into being with the first writer.
    STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.product.name", name)
    cadquery.exporters.export(cadquery.Workplane(shape), str(path), opt={"write_pcurves": name not in WITHOUT_PCURVES})
    if isinstance(model, list):
        shape.exportBrep(str(path.with_suffix(".brep")))
    fix_chance(path, name)
    return path


def write_assembly(assembly, name, folder):
    """Writes the solids of a cadquery `assembly`, with their names and colours and those of their faces, to `folder/name.step`."""
    from cadquery.occ_impl.exporters.assembly import exportStepMeta

    path = Path(folder) / f"{name}.step"
    exportStepMeta(assembly, str(path))
    fix_chance(path, name)
    return path


def fix_chance(path, name):
    """Replaces in a STEP file what depends on when it was written: the time in the header, and what OCCT counts on from file to file."""
    text, times = HEADER_TIME.subn(f"'{FIXED_TIME}'", path.read_text(encoding="ascii"))
    if times != 1:
        sys.exit(f"{path}: expected one time stamp in the header, found {times}: OCCT writes another header now, adapt HEADER_TIME")
    text = re.sub(rf"'{re.escape(name)} \d+(\.\d+)?'", rf"'{name} 1\1'", text)
    numbers = itertools.count(1)
    text = re.sub(r"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\()'\d+'", lambda found: f"{found[1]}'{next(numbers)}'", text)
    path.write_text(_colours_in_order(text), encoding="ascii", newline="\n")


def _colours_in_order(text):
    """Puts the colours of several parts, the last entities of the file, in the order of the parts: OCCT's is that of addresses in memory."""
    kind = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"
    if kind not in text:
        return text
    begin, end = text.rindex("\n#", 0, text.index(kind)) + 1, text.rindex("ENDSEC;")
    groups = []
    for number, body in re.findall(r"#(\d+) = (.*?);\n", text[begin:end], re.DOTALL):
        if body.startswith(kind):
            groups.append([])
        groups[-1].append((int(number), re.sub(r"\n *", "", body)))
    # A group's second entity says of which part it is.
    groups.sort(key=lambda group: int(re.search(r"#(\d+)\)$", group[1][1])[1]))
    entities, first = [entity for group in groups for entity in group], groups and min(group[0][0] for group in groups)
    new = {old: first + i for i, (old, _) in enumerate(entities)}
    renumbered = [re.sub(r"#(\d+)", lambda found: f"#{new.get(int(found[1]), int(found[1]))}", body) for _, body in entities]
    lines = [f"#{first + i} = {body};\n" for i, body in enumerate(renumbered)]
    return text[:begin] + "".join(lines) + text[end:]


def _shape(model, name):
    """The solid of a Workplane, or the compound of a list of solids, all valid; a compound of surfaces as it is."""
    import cadquery

    if isinstance(model, cadquery.Compound):
        return model
    several = isinstance(model, list)
    solids = model if several else model.solids().vals()
    if not solids or (len(solids) > 1 and not several) or not all(solid.isValid() for solid in solids):
        sys.exit(f"{name}: expected {'valid solids' if several else 'one valid solid'}, got {len(solids)}")
    return cadquery.Compound.makeCompound(solids) if several else solids[0]


def main(build, name, writer=write):
    """The command line of a model script: `[-o FOLDER]`, this folder by default."""
    parser = argparse.ArgumentParser(description=f"Writes {name}.step.")
    parser.add_argument("-o", "--output", default=Path(__file__).parent, help="folder to write to (default: this one)")
    path = writer(build(), name, parser.parse_args().output)
    print(f"wrote {path}")
