#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the type stubs of the package, for editors and type checkers.

stubs.py FOLDER      writes FOLDER/swivel/__init__.pyi from the package in FOLDER

Signatures are those that pybind11 writes into docstrings, and those of the package's Python files.
Exit code 1 and one line where a signature has a type that is not known here, and where a table
below has an entry that nothing needs.
"""
import ast
import inspect
import re
import sys
from pathlib import Path

HEAD = """# Made by python/stubs.py. The module has the docstrings, as in help(swivel.Planner.plan).
# Members of type `... | Any` are None only if they were not asked for, or if the status says that
# there is none. Members of enums equal their names as str() gives them: plan.status == "solved".
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar, Literal, SupportsIndex, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

__version__: str
__all__: list[str]
"""
ALIASES = {
    "_Array": "NDArray[np.float64]",
    "_File": "str | os.PathLike[str]",
    "_Pose": "ArrayLike",  # (4, 4) or [x y z qw qx qy qz], m; of bodies also [x y z]
    "_Check": "Callable[[_Array], ArrayLike]",
    "_MotionCheck": "Callable[[_Array, _Array], ArrayLike]",
    "_Progress": "Callable[[str, int, int], Any]",
    "_Rows": "Answer | Motion | Trajectory | Sequence[Part] | Mapping[str, Trajectory]"
             " | Mapping[str, Motion] | _File",
    "_Criterion": 'Literal["clearance", "cost", "margin", "slide", "speed"]',
    # A coordinate of placements: a number, (from, to, step), or (from, to) for samples.
    "_Range": "float | tuple[float, float] | tuple[float, float, float]",
}
NAMES = set("None ... bool float int str slice Any ArrayLike DTypeLike SupportsIndex".split())
GENERIC = set("Callable Iterable Iterator Literal Mapping NDArray Sequence dict list tuple".split())
# What pybind11 writes: the type of an argument, which may be wider, and that of a result.
WORDS = {
    "PoseLike": ("_Pose", "_Array"),
    "WaypointsLike": ("ArrayLike", "_Array"),
    "os.PathLike": ("_File", "_File"),
    "List[float[2]]": ("tuple[float, float]", "list[float]"),
    "List[float[6]]": ("ArrayLike", "list[float]"),
    "List[str[2]]": ("tuple[str, str]", "list[str]"),
}
# What neither says: signatures, bases, types of arguments, and members
# whose type is `... | Any`.
SIGNATURES = {
    "TrajectoryRow.__getitem__": (
        "(self, key: SupportsIndex) -> float", "(self, key: slice) -> tuple[float, ...]",
        "(self, key: str) -> float"
    ),
    "Trajectory.__getitem__": (
        "(self, k: SupportsIndex) -> TrajectoryRow", "(self, k: slice) -> Trajectory"
    ),
}
BASES = {"TrajectoryRow": ["tuple[float, ...]"]}
ARGUMENTS = {"Placements.best by": "_Criterion | Sequence[_Criterion]"}
MAYBE = set(
    """Answer.cost Answer.diagnosis Answer.refinement Answer.motion Answer.bound Answer.bound_any
    Answer.bound_orders Answer.gap Answer.least_cost Arm.diagnosis Arm.refinement Arm.least_cost
    Run.least_cost Run.cost Run.diagnosis
    Placement.cost Placement.clearance Placement.clearance_margin Placement.joint_margin
    Placement.slide_margin Placement.tool_speed Placement.failed_s Episode.cost Episode.failed_s
    Episode.tool_path_error_mm_mean Episode.tool_path_error_mm_max Planned.cost
    Planned.failed_s""".split()
)
SPECIAL = {f"__{name}__" for name in "init len iter getitem contains bool array getattr".split()}
ENUM = [
    "@property", "def name(self) -> str: ...", "@property", "def value(self) -> int: ...",
    "def __eq__(self, other: object) -> bool: ...", "def __hash__(self) -> int: ..."
]


class Stubs:
    """The stubs of a package; `public`: its names and what they are."""

    def __init__(self, public):
        self.public = public
        self.enums = {name for name, thing in public.items() if hasattr(thing, "__members__")}
        self.aliases = ALIASES | {
            f"_{name}": f"{name} | Literal[{', '.join(map(repr, map(str, members.values())))}]"
            for name, members in sorted((one, public[one].__members__) for one in self.enums)
        }
        self.used = set()  # keys of the tables
        self.where = ""  # name of what is read

    def refuse(self, why):
        raise SystemExit(f"stubs: {self.where}: {why}")

    def has(self, table, key):
        if key in table:
            self.used.add(key)
        return key in table

    def parsed(self, text, mode="eval"):
        try:
            return ast.parse(text, mode=mode).body
        except SyntaxError:
            return self.refuse(f"{text} is not Python: allowed are types that are bound before")

    def parts(self, node):
        """Returns the types of which a type is the union."""
        name = ast.unparse(node.value) if isinstance(node, ast.Subscript) else ""
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            return self.parts(self.parsed(node.value))
        if isinstance(node, ast.BinOp):
            return self.parts(node.left) + self.parts(node.right)
        if name in ("Optional", "Union"):
            items = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            none = [ast.Constant(None)] if name == "Optional" else []
            return [part for item in items for part in self.parts(item)] + none
        return [node]

    def type(self, node, argument):
        """Returns a type in the words of stubs: of an argument, or of a result."""
        parts = list(dict.fromkeys(self.part(part, argument) for part in self.parts(node)))
        if "str" in parts and self.enums & set(parts):  # a member of an enum, or its name
            parts.remove("str")
            parts = [f"_{part}" if part in self.enums else part for part in parts]
        return " | ".join(sorted(parts, key="None".__eq__))

    def part(self, node, argument):
        text = ast.unparse(node).replace("swivel._swivel.", "")
        if self.has(WORDS, text):
            return WORDS[text][0 if argument else 1]
        if text in NAMES | self.aliases.keys() | self.public.keys():
            return text
        if isinstance(node, ast.List):
            return f"[{', '.join(self.type(item, argument) for item in node.elts)}]"
        name = ast.unparse(node.value) if isinstance(node, ast.Subscript) else ""
        if name == "numpy.ndarray":
            number = re.sub(r"numpy\.ndarray\[(?:numpy\.)?(\w+).*", r"np.\1", text)
            array = f"NDArray[{number}]" if number != "np.bool" else "NDArray[np.bool_]"
            return "ArrayLike" if argument else array.replace("NDArray[np.float64]", "_Array")
        name = {"Tuple": "tuple", "List": "list", "Dict": "dict"}.get(name, name)
        if name not in GENERIC:
            self.refuse(f"the type {text}: allowed are those of python/stubs.py, and classes")
        if name in ("Literal", "NDArray"):
            return text
        items = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if name == "list" and re.search(r"\[\d+\]\]$", text):  # of so many items
            items = [items[0].value]
        name = {"list": "Sequence", "dict": "Mapping"}.get(name, name) if argument else name
        return f"{name}[{', '.join(self.type(item, argument) for item in items)}]"

    def texts(self, function):
        """Returns the signatures of a function, from the bracket on."""
        if self.has(SIGNATURES, self.where):
            return SIGNATURES[self.where]
        if inspect.isfunction(function) and not hasattr(function, "__wrapped__"):
            return [str(inspect.signature(function))]
        doc = function.__doc__ or ""
        start = r"^\d+\. \w+" if "Overloaded function." in doc else r"\A\w*"
        found = re.findall(start + r"(\(.*\) -> .*)$", doc, re.MULTILINE)
        # pybind11 from 2.12 on writes Annotated[list[float], FixedSize(7)] for List[float[7]].
        fixed = r"Annotated\[list\[(\w+)\], FixedSize\((\d+)\)\]"
        return [re.sub(fixed, r"List[\1[\2]]", text) for text in found] or self.refuse(
            "its docstring has no signature in one line"
        )

    def signature(self, text):
        """Returns a signature with its types translated."""
        (node,) = self.parsed(f"def f{text}: ...", "exec")
        every, defaults = node.args.posonlyargs + node.args.args, node.args.defaults
        pairs = [*zip(every, [None] * (len(every) - len(defaults)) + defaults)]
        pairs += [*zip(node.args.kwonlyargs, node.args.kw_defaults)]
        pairs += [(one, None) for one in (node.args.vararg, node.args.kwarg) if one]
        for one, default in pairs:
            told, key, one.annotation = one.annotation, f"{self.where} {one.arg}", None
            if one.arg == "self":
                continue
            told = self.parsed(ARGUMENTS[key]) if self.has(ARGUMENTS, key) else told
            words = self.type(told, True) if told else self.refuse(f"{one.arg} has no type")
            if default and ast.unparse(default) == "None" and not isinstance(told, ast.Constant):
                words = words.removesuffix(" | None") + " | None"
            one.annotation = ast.Name(words)
        returns = self.type(node.returns, False) if node.returns else self.refuse("returns no type")
        node.returns = ast.Name(returns)
        return node

    def function(self, name, function, static=False):
        """Returns the lines of a function and its overloads."""
        lines = []
        for text in self.texts(function):
            node = self.signature(text)
            line = f"({ast.unparse(node.args)}) -> {node.returns.id}"
            lines.append(f"def {name}{line}: ...")
        before = ["@staticmethod"] * static + ["@overload"] * (len(lines) > 1)
        return [part for line in lines for part in [*before, line]]

    def setter(self, value):
        return self.signature(self.texts(value.fset)[0]).args.args[1].annotation.id

    def property(self, name, value):
        told = self.signature(self.texts(value.fget)[0]).returns.id
        if self.has(MAYBE, self.where):
            told = told.removesuffix(" | None") + " | Any"
        lines = ["@property", f"def {name}(self) -> {told}: ..."]
        given = self.setter(value) if value.fset else None
        if given and given.replace("Sequence[", "list[") == told:
            return [f"{name}: {given}"]
        setter = [f"@{name}.setter", f"def {name}(self, value: {given}) -> None: ..."]
        return lines + (setter if given else [])

    def keywords(self, kind):
        """Returns the constructor of a struct: a keyword for each member, as C++ initializes it."""
        told = []
        for name in [one for one in vars(kind) if isinstance(vars(kind)[one], property)]:
            default = getattr(kind(), name)
            default = str(default) if hasattr(default, "__members__") else default
            told.append(f"{name}: {self.setter(vars(kind)[name])}={default!r}")
        return [f"def __init__(self, *, {', '.join(told)}) -> None: ..."]

    def member(self, kind, name, value):
        if isinstance(value, type(object.__init__)):
            return []  # no constructor
        if isinstance(value, property):
            return self.property(name, value)
        static = isinstance(value, staticmethod)
        function = value.__func__ if static else value
        if self.texts(function)[0].endswith("**kwargs) -> None"):
            return self.keywords(kind)
        return self.function(name, function, static)

    def kind(self, name, kind):
        """Returns the lines of a class."""
        bases = [one.__name__ for one in kind.__bases__ if not one.__name__.startswith("pybind11")]
        bases = BASES[name] if self.has(BASES, name) else bases
        constants = [f"{one}: ClassVar[{name}]" for one in getattr(kind, "__members__", ())]
        lines = constants + ENUM if constants else []
        for one, value in vars(kind).items() if not constants else ():
            self.where = f"{name}.{one}"
            if one in SPECIAL or not one.startswith("_"):
                lines += self.member(kind, one, value)
        head = f"class {name}({', '.join(bases)}):" if bases else f"class {name}:"
        return [head, *(f"    {line}" for line in lines or ["..."])]

    def text(self):
        """Returns the stubs."""
        lines = []
        for name, thing in self.public.items():
            self.where = name
            read = self.kind if isinstance(thing, type) else self.function
            lines += [*read(name, thing), ""]
        text, self.where = "\n".join(lines), "python/stubs.py"
        self.used |= {name for name in self.aliases if re.search(rf"\b{name}\b", text)}
        tables = set().union(WORDS, SIGNATURES, BASES, ARGUMENTS, MAYBE, ALIASES)
        for key in sorted(tables - self.used):
            self.refuse(f"nothing needs the entry {key}")
        aliases = [f"{k}: TypeAlias = {told}" for k, told in self.aliases.items() if k in self.used]
        return "\n".join([HEAD, *aliases, "", text])


def main(folder):
    sys.path.insert(0, folder)
    sys.dont_write_bytecode = True
    import swivel

    public = {name: getattr(swivel, name) for name in swivel.__all__}
    (Path(folder) / "swivel/__init__.pyi").write_text(Stubs(public).text())


if __name__ == "__main__":
    main(sys.argv[1])
