"""Writes the pages of the Python package from its docstrings and types, which griffe reads without importing it.

Usage: python_pages.py PACKAGE PAGES, where PACKAGE is the folder python/geo_adapt and PAGES the src folder of the book. A page a module goes into
PAGES/reference; PAGES/SUMMARY.md gets a line for each below that of reference/python.md.
"""

import re
import sys
from itertools import groupby
from pathlib import Path

import griffe

# Modules that users name, though the package itself does not import all of them; the others are known by what the package takes from them.
NAMED = ["metric", "examples", "errors", "program", "accessor"]
# In the order of a reader's way.
ORDER = ["mesh", "model", "work", "adapting", "metric", "tensors", "looping", "server", "server_metric", "served", "jobs", "errors", "examples", "program", "accessor"]
WIDTH = 100


class Pages:
    """The package, and on which page each of its public names is."""

    def __init__(self, package: griffe.Module) -> None:
        self.package = package
        taken = {package[name].target_path for name in package.exports or () if package[name].is_alias}
        self.members: dict[str, list[griffe.Object]] = {}
        for module in ORDER:
            found = [thing for name, thing in package[module].members.items() if self._is_public(package[module], name, taken)]
            found = [thing.final_target if thing.is_alias else thing for thing in found]
            # What is called comes before what only holds values.
            self.members[module] = sorted(found, key=lambda thing: not (thing.is_function or has(thing, "parameters")))
        self.places = {thing.name: module for module, things in self.members.items() for thing in things}

    @staticmethod
    def _is_public(module: griffe.Module, name: str, taken: set[str]) -> bool:
        thing = module.members[name]
        if module.name not in NAMED:
            return f"{module.path}.{name}" in taken
        if module.exports is not None:
            return name in module.exports
        # What it imports is not its own.
        return not name.startswith("_") and not thing.is_alias

    def missing(self) -> set[str]:
        """What the package exports and no page has."""
        return set(self.package.exports or ()) - set(self.places) - set(NAMED)

    def title(self, module: str) -> str:
        """A page is called by its module where users name that, else by what is on it."""
        if module == "accessor":
            return "geo_adapt.accessor, for pyvista"
        if module in NAMED:
            return f"geo_adapt.{module}"
        return ", ".join(thing.name for thing in self.members[module])

    def name(self, thing: griffe.Object) -> str:
        """As users write it."""
        module = self.places[thing.name]
        return f"geo_adapt.{module}.{thing.name}" if module in NAMED else f"geo_adapt.{thing.name}"

    def page(self, module: str) -> str:
        """The page of a module."""
        parts = [f"# {self.title(module)}", *self.docstring(self.package[module])]
        for thing in self.members[module]:
            parts += [f"## {thing.name} {{#{thing.name}}}", *self.thing(thing, self.name(thing))]
        return "\n\n".join(part for part in parts if part) + "\n"

    def thing(self, thing: griffe.Object, name: str) -> list[str]:
        """A class with its methods, a function, or a value."""
        if thing.is_attribute:
            return [code(f"{name}: {thing.annotation}" if thing.annotation else name), *self.docstring(thing)]
        if thing.is_function:
            return [code(signature(thing, name)), *self.docstring(thing)]
        parts = [self.of_class(thing, name), *self.docstring(thing)]
        for method, about in thing.members.items():
            is_shown = about.is_function or "property" in about.labels
            if about.is_alias or not is_shown or method.startswith("_") or not about.docstring:
                continue
            parts += [f"### {thing.name}.{method} {{#{thing.name}.{method}}}", *self.method(about, f"{thing.name}.{method}")]
        return parts

    def of_class(self, thing: griffe.Class, name: str) -> str:
        """How an object of the class is made, or what it is a kind of."""
        bases = [str(base) for base in thing.bases if str(base) != "NamedTuple"]
        start = thing.members.get("__init__")
        if start is not None and has(thing, "parameters"):
            return code(signature(start, name))
        return code(f"class {name}({', '.join(bases)})" if bases else f"class {name}")

    def method(self, about: griffe.Object, name: str) -> list[str]:
        if about.is_attribute:
            return [code(f"{name}: {about.annotation}"), *self.docstring(about)]
        shown = signature(about, name, is_bound="staticmethod" not in about.labels)
        return [code(shown), *self.docstring(about)]

    def docstring(self, thing: griffe.Object) -> list[str]:
        """The docstring's sections, as Markdown."""
        parts: list[str] = []
        for section in sections(thing):
            kind = section.kind.value
            if kind == "text":
                parts += examples_apart(section.value, self.linked)
            elif kind == "examples":
                parts.append("**Examples**")
                for of, text in section.value:
                    parts.append(code(text) if of.value == "examples" else self.linked(text))
            elif kind == "admonition":
                parts += [f"**{section.title}**", self.linked(section.value.description)]
            else:
                title = {"returns": "Returns", "raises": "Raises", "warns": "Warns"}.get(kind, kind.capitalize())
                parts += [f"**{title}**", self.items(section.value)]
        return parts

    def items(self, items: list) -> str:
        """A line for each item; those that a docstring names together stay together."""
        lines = []
        for (annotation, description), group in groupby(items, key=lambda item: (item.annotation, item.description)):
            together = ", ".join(item.name for item in group if getattr(item, "name", ""))
            names = ", ".join(f"`{name}`" for name in together.split(", ") if name)
            kind = f"*{self.linked(str(annotation), in_code=False)}*" if annotation else ""
            head = " : ".join(part for part in (names, kind) if part)
            text = self.linked(description.strip()).replace("\n", "\n  ")
            lines.append(f"- {head}" + (f"  \n  {text}" if text else ""))
        return "\n".join(lines)

    def linked(self, text: str, in_code: bool = True) -> str:
        """Text in which public names lead to their places."""
        mark = r"(?<!`)`([A-Za-z_.]+)`(?!`)" if in_code else r"\b([A-Z]\w+)\b"

        def link(match: re.Match[str]) -> str:
            name = match[1].removeprefix("geo_adapt.")
            parts = name.split(".")
            if len(parts) == 2 and self.places.get(parts[1]) == parts[0]:
                parts = parts[1:]
            if parts[0] not in self.places:
                return match[0]
            return f"[{match[0]}](python-{self.places[parts[0]]}.md#{'.'.join(parts)})"

        return re.sub(mark, link, text).replace("``", "`")


def sections(thing: griffe.Object) -> list:
    """The sections of a docstring. It is parsed without its place, so that types stay as they are written."""
    if not thing.docstring:
        return []
    return griffe.Docstring(thing.docstring.value).parse("numpy", warnings=False)


def has(thing: griffe.Object, kind: str) -> bool:
    """Whether the docstring has such a section."""
    return any(section.kind.value == kind for section in sections(thing))


def examples_apart(text: str, linked) -> list[str]:
    """Paragraphs of a text, those that are examples as code."""
    return [code(part) if part.startswith(">>>") else linked(part) for part in re.split(r"\n\n+", text)]


def code(text: str) -> str:
    return f"```python\n{text}\n```"


def signature(function: griffe.Function, name: str, is_bound: bool | None = None) -> str:
    """The call with its types, on a line where it has room."""
    given = list(function.parameters)
    if is_bound or function.name == "__init__":
        given = given[1:]
    words: list[str] = []
    for one in given:
        star = {"variadic positional": "*", "variadic keyword": "**"}.get(one.kind.value, "")
        if one.kind.value == "keyword-only" and not any(word.startswith("*") for word in words):
            words.append("*")
        default = "" if one.default is None or star else f" = {one.default}"
        words.append(f"{star}{one.name}" + (f": {one.annotation}" if one.annotation else "") + default)
    back = "" if function.name == "__init__" or function.returns is None else f" -> {function.returns}"
    line = f"{name}({', '.join(words)}){back}"
    if len(line) <= WIDTH:
        return line
    return "\n".join([f"{name}(", *(f"    {word}," for word in words), f"){back}"])


def main() -> None:
    source, target = Path(sys.argv[1]), Path(sys.argv[2])
    package = griffe.load(source.name, search_paths=[source.parent], allow_inspection=False, resolve_aliases=True)
    pages = Pages(package)
    if pages.missing():
        sys.exit(f"error: no page of the book has these names of the package: {', '.join(sorted(pages.missing()))}")
    lines = []
    for module in ORDER:
        (target / "reference" / f"python-{module}.md").write_text(pages.page(module), encoding="utf-8")
        lines.append(f"  - [{pages.title(module)}](reference/python-{module}.md)")
    summary = target / "SUMMARY.md"
    above = re.search(r"^- \[.*\]\(reference/python\.md\)$", summary.read_text(encoding="utf-8"), re.M)
    if above is None:
        sys.exit(f"error: {summary}: has no line for reference/python.md")
    summary.write_text(summary.read_text(encoding="utf-8").replace(above[0], "\n".join([above[0], *lines])), encoding="utf-8")


if __name__ == "__main__":
    main()
