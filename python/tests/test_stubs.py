"""The stubs say what the compiled module has: the same names, and the same parameters with the same defaults. A type checker agrees."""

from __future__ import annotations

import ast
import inspect
import pathlib
import subprocess
import sys

import pytest

import abbe
from abbe import _abbe

TREE = ast.parse(pathlib.Path(abbe.__file__).with_name("_abbe.pyi").read_text())


def parameters(function: ast.FunctionDef) -> list[tuple[str, str, object]]:
    """Name, kind and default of each parameter, that of the object itself apart."""
    arguments = function.args
    positional = [*arguments.posonlyargs, *arguments.args]
    defaults = [None] * (len(positional) - len(arguments.defaults)) + list(arguments.defaults)
    found = [(one.arg, "positional", default) for one, default in zip(positional, defaults) if one.arg not in ("self", "cls")]
    found += [(one.arg, "keyword", default) for one, default in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    found += [(arguments.kwarg.arg, "others", None)] if arguments.kwarg else []
    return [(name, kind, inspect.Parameter.empty if default is None else ast.literal_eval(default)) for name, kind, default in found]


def signature(function: object) -> list[tuple[str, str, object]]:
    kinds = {inspect.Parameter.KEYWORD_ONLY: "keyword", inspect.Parameter.VAR_KEYWORD: "others"}
    known = inspect.signature(function).parameters.values()
    return [(one.name, kinds.get(one.kind, "positional"), one.default) for one in known if one.name != "self"]


def public(names: object) -> set[str]:
    return {name for name in names if not name.startswith("_") or name in ("_repr_html_", "_repr_latex_")}


def test_names_of_the_module() -> None:
    stated = {node.name for node in TREE.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    assert public(stated) == public(vars(_abbe))


def test_members_and_parameters() -> None:
    compared = 0
    for node in TREE.body:
        if isinstance(node, ast.FunctionDef):
            assert parameters(node) == signature(getattr(_abbe, node.name)), node.name
            compared += 1
        if isinstance(node, ast.ClassDef) and not node.bases:
            thing = getattr(_abbe, node.name)
            members = {member.name: member for member in node.body if isinstance(member, ast.FunctionDef)}
            assert public(members) == public(vars(thing)), node.name
            for name, member in members.items():
                is_property = bool(member.decorator_list)
                assert is_property == inspect.isgetsetdescriptor(vars(thing)[name]), f"{node.name}.{name}"
                if name == "__new__":
                    assert parameters(member) == signature(thing), node.name
                elif not is_property and not name.startswith("__"):
                    assert parameters(member) == signature(getattr(thing, name)), f"{node.name}.{name}"
                    compared += 1
    assert compared > 20


def test_everything_has_a_type() -> None:
    """Each parameter and each result."""
    functions = [node for node in ast.walk(TREE) if isinstance(node, ast.FunctionDef)]
    for function in functions:
        arguments = function.args
        named = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
        bare = [one.arg for one in named if one.annotation is None and one.arg not in ("self", "cls")]
        assert not bare and function.returns is not None, function.name


@pytest.mark.parametrize("checker", ["mypy", "mypy.stubtest"])
def test_a_type_checker_agrees(checker: str, tmp_path: pathlib.Path) -> None:
    pytest.importorskip("mypy", reason="mypy is not installed: types are not checked")
    typed = str(pathlib.Path(__file__).with_name("typed.py"))
    what = {"mypy": ["--strict", typed], "mypy.stubtest": ["abbe._abbe"]}[checker]
    done = subprocess.run([sys.executable, "-m", checker, *what], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
