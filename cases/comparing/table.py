"""Prints the comparison."""

import textwrap

from .published import beside

# title, width; a column more needs a value in `_values`
COLUMNS = [("case", 11), ("code", 16), ("vertices", 8), ("per C", 6), ("unit edges", 10), ("length", 12), ("ratio least/mean", 16),
           ("CPU s", 8), ("vertices/s", 10), ("MiB", 6), ("B/vertex", 8)]


def header():
    """The titles of the columns."""
    return _line([title for title, _ in COLUMNS])


def row(case, code, result):
    """A line for an adapter's result."""
    if "failed" in result:
        return _line([case, code]) + f"  failed: {result['failed'].splitlines()[0]}"
    marks = "" if not result["findings"] else f"  NOT VALID ({len(result['findings'])} findings)"
    return _line([case, code, *_values(result), f"{result['vertices_per_second']:.0f}", f"{result['peak_bytes'] / 2**20:.0f}",
                  f"{result['bytes_per_vertex']:.0f}"]) + marks


def published_rows(case, notes):
    """Lines for the codes that were not run; each new source is put into `notes`, its number into the line."""
    lines = []
    for known in beside(case):
        if known.source not in notes:
            notes.append(known.source)
        mark = f"*{notes.index(known.source) + 1}"
        more = ["" if value is None else f"{value:.0f}" for value in (known.vertices_per_second, known.peak_mib)]
        lines.append(_line([f"  {mark}", known.code, *_values(vars(known)), *more]))
    return lines


def notes_text(notes):
    """The sources of the lines with a star."""
    lines = ["Lines with a star were not run here:"] if notes else []
    for number, note in enumerate(notes, 1):
        lines += textwrap.wrap(f"*{number} {note}", 100, subsequent_indent="   ")
    return "\n".join(lines)


def ratio_line(ratios):
    """Ours over mmg3d's."""
    return (f"{'':<12}geo-adapt / mmg3d: time {ratios['time_ratio']:.2f}, memory {ratios['memory_ratio']:.2f}, "
            f"vertices a second {ratios['rate_ratio']:.2f}")


def _values(result):
    """The columns that a published line has as well."""

    def text(name, form, factor=1.0):
        return "" if result.get(name) is None else form.format(factor * result[name])

    def both(form, first, second):
        least, most = text(first, form), text(second, form)
        return f"{least} / {most}" if most else least

    return [text("vertices", "{:.0f}"), text("vertices_per_complexity", "{:.2f}"), text("unit_edges", "{:.2f} %", 100),
            both("{:.2f}", "length_least", "length_most"), both("{:.3f}", "ratio_least", "ratio_mean"), text("cpu_seconds", "{:.1f}")]


def _line(values):
    """Two columns to the left, the others to the right."""
    cells = [f"{value:<{width}}" if at < 2 else f"{value:>{width}}" for at, (value, (_, width)) in enumerate(zip(values, COLUMNS))]
    return "  ".join(cells).rstrip()
