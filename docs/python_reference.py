#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the reference of the Python package as Markdown: signatures of its stubs, docstrings of
the module.

python_reference.py      the package must be importable (PYTHONPATH)
"""
import ast
import importlib
import inspect
import pathlib
import re

HEAD = """# Python reference

{doc}

Signatures are those of the type stubs; `help(swivel.Planner.plan)` says the same.
Examples: [embedding](docs/guide/embedding.md#python).

| in signatures | stands for |
|---|---|
{aliases}
"""
# Headings, by the first name below each.
HEADINGS = {
    "Sphere": "Problems", "LeastMargin": "Answers", "Kinematics": "Planning",
    "WorkcellCertificate": "Certificates",
    "Placement": "Many plans of one problem", "TrajectoryRow": "Functions that plan in one call"
}


def meaning(thing):
    """The docstring without the signatures that pybind11 writes before it."""
    text = inspect.getdoc(thing) or ""
    paragraphs = [
        part
        for part in text.split("\n\n")
        if not re.match(r"(\d+\. )?\w+\([^\n]*\) -> [^\n]+$", part)
        and not part.endswith("Overloaded function.")
    ]
    return "\n\n".join(paragraphs).strip()


def signature(node):
    """As a caller writes it."""
    arguments = re.sub(r"^self(, )?", "", ast.unparse(node.args))
    returns = ast.unparse(node.returns) if node.returns else "None"
    return f"{node.name}({arguments})" + ("" if returns == "None" else f" -> {returns}")


def is_setter(node):
    return any(
        isinstance(one, ast.Attribute) and one.attr == "setter" for one in node.decorator_list
    )


def is_property(node):
    return any(isinstance(one, ast.Name) and one.id == "property" for one in node.decorator_list)


def in_cell(text):
    return text.replace("|", "\\|")


def aliases(body):
    for node in body:
        if isinstance(node, ast.AnnAssign) and ast.unparse(node.annotation) == "TypeAlias":
            yield f"| `{node.target.id}` | `{in_cell(ast.unparse(node.value))}` |"


def members(node, thing):
    settable = {
        item.name for item in node.body if isinstance(item, ast.FunctionDef) and is_setter(item)
    }
    values, functions = [], []
    for item in node.body:
        if isinstance(item, ast.AnnAssign):
            values.append(
                (
                    item.target.id,
                    ast.unparse(item.annotation).replace("ClassVar[%s]" % node.name, "constant"),
                    getattr(thing, item.target.id, None),
                )
            )
        elif isinstance(item, ast.FunctionDef) and is_property(item):
            values.append(
                (
                    item.name,
                    ast.unparse(item.returns) + ("" if item.name in settable else ", read only"),
                    getattr(thing, item.name, None),
                )
            )
        elif isinstance(item, ast.FunctionDef) and not is_setter(item):
            functions.append((item, getattr(thing, item.name, None)))
    for item, function in functions:
        name = signature(item).replace("__init__", node.name, 1)
        yield f"```py\n{name}\n```\n"
        # What a constructor says is what its class says, where it has no words of its own.
        if meaning(function) and not (item.name.startswith("__") and item.name != "__init__"):
            yield meaning(function) + "\n"
    if values:
        yield "| member | type | |\n|---|---|---|"
        for name, kind, value in values:
            kind = in_cell(kind)
            words = " ".join(meaning(value).split()) if isinstance(value, property) else ""
            yield f"| `{name}` | `{kind}` | {words} |"
        yield ""


def main():
    package = importlib.import_module("swivel")
    body = ast.parse(pathlib.Path(package.__file__).with_suffix(".pyi").read_text()).body
    print(HEAD.format(doc=inspect.getdoc(package), aliases="\n".join(aliases(body))))
    for node in body:
        if getattr(node, "name", "") in HEADINGS:
            print(f"## {HEADINGS.pop(node.name)}\n")
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            thing = getattr(package, node.name)
            print(f"### {node.name}\n")
        if isinstance(node, ast.ClassDef):
            bases = [ast.unparse(base) for base in node.bases]
            if bases:
                print("Is a " + " and a ".join(f"`{base}`" for base in bases) + " as well.\n")
            print(meaning(thing) + "\n")
            print("\n".join(members(node, thing)))
        elif isinstance(node, ast.FunctionDef):
            print(f"```py\n{signature(node)}\n```\n\n{meaning(thing)}\n")
    if HEADINGS:
        raise SystemExit(f"HEADINGS: the package has no {', '.join(HEADINGS)}")


main()
