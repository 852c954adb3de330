import ast
import inspect
import pathlib

import pliant


def declared():
    tree = ast.parse((pathlib.Path(pliant.__file__).parent / "__init__.pyi").read_text())
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    return {
        name: {item.name for item in node.body if isinstance(item, ast.FunctionDef)} for name, node in classes.items()
    }


def test_the_stubs_declare_what_there_is():
    stubs = declared()
    assert set(stubs) == set(pliant.__all__)
    for name, members in stubs.items():
        kind = getattr(pliant, name)
        own = {member for member in vars(kind) if not member.startswith("_")}
        special = {member for member in vars(kind) if member in ("__len__", "__getitem__")}
        if not issubclass(kind, Exception):
            assert {member for member in members if member != "__init__"} == own | special, name


def test_typed_arguments_have_the_names_that_there_are():
    text = (pathlib.Path(pliant.__file__).parent / "__init__.pyi").read_text()
    tree = ast.parse(text)
    for node in (node for node in tree.body if isinstance(node, ast.ClassDef)):
        for item in (item for item in node.body if isinstance(item, ast.FunctionDef)):
            known = inspect.getdoc(getattr(getattr(pliant, node.name), item.name)) or ""
            for argument in item.args.args[1:]:
                assert argument.arg + ":" in known or item.name == "__getitem__", (node.name, item.name, argument.arg)


def test_unknown_names_are_no_part_of_it():
    assert not hasattr(pliant, "Simulater")
    assert "Simulator" in dir(pliant)
