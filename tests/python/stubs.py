"""The type stubs name what there is: every function, parameter and default of the module, and none besides."""

import ast
import inspect
import pathlib
import unittest

import ivory

STUBS = pathlib.Path(ivory.__file__).with_name("__init__.pyi")


def parameters(function, defaults_of=ast.literal_eval):
    """Of a parsed function: name, whether by keyword alone, and default."""
    args = function.args
    plain = args.posonlyargs + args.args
    values = [None] * (len(plain) - len(args.defaults)) + list(args.defaults)
    pairs = [(arg.arg, False, value) for arg, value in zip(plain, values)]
    pairs += [(arg.arg, True, value) for arg, value in zip(args.kwonlyargs, args.kw_defaults)]

    def plain_value(value):
        if value is None:
            return "required"
        value = defaults_of(value)
        return list(value) if isinstance(value, tuple) else value

    return [(name, keyword, plain_value(value)) for name, keyword, value in pairs if name != "self"]


def signature(function):
    """As pybind11 writes it into the first line of its documentation."""
    line = function.__doc__.splitlines()[0]
    return parameters(ast.parse(f"def {line}: ...").body[0])


class Stubs(unittest.TestCase):
    def setUp(self):
        self.tree = ast.parse(STUBS.read_text(encoding="utf-8"))

    def test_names(self):
        told = {node.name for node in self.tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(told | {"__version__"}, set(ivory.__all__))

    def test_functions(self):
        for node in self.tree.body:
            if isinstance(node, ast.FunctionDef):
                self.assertEqual(parameters(node), signature(getattr(ivory, node.name)), node.name)

    def test_classes(self):
        for node in self.tree.body:
            if not isinstance(node, ast.ClassDef) or issubclass(getattr(ivory, node.name), Exception):
                continue
            there = getattr(ivory, node.name)
            own = {name for name in vars(there) if not name.startswith("_") or name in ("__init__", "__len__")}
            told = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
            # Without an __init__ of its own a class has one that refuses.
            self.assertEqual(told | {"__init__"}, own | {"__init__"}, node.name)
            for item in node.body:
                if not isinstance(item, ast.FunctionDef):
                    continue
                decorators = {decorator.id for decorator in item.decorator_list}
                what = inspect.getattr_static(there, item.name)
                self.assertEqual("property" in decorators, isinstance(what, property), f"{node.name}.{item.name}")
                self.assertEqual("staticmethod" in decorators, isinstance(what, staticmethod), item.name)
                if "property" not in decorators:
                    self.assertEqual(parameters(item), signature(getattr(there, item.name)),
                                     f"{node.name}.{item.name}")


if __name__ == "__main__":
    unittest.main()
