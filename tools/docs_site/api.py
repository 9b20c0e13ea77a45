"""Makes the Python reference: pdoc's pages, with types and options of the compiled module."""

from __future__ import annotations

import importlib
import inspect
import re
import sys
import textwrap
import types
from pathlib import Path

import pdoc
import pdoc.render
from pdoc.doc_ast import walk_tree

MODULES = ("retarget", "retarget.data_set", "retarget.edit", "retarget.gmr", "retarget.packs", "retarget.ray")
_ENGINE = "retarget._retarget"
_OPTIONS = re.compile(r"^Options \((?P<default>.*)\):\n(?P<items>(?:    .*\n?)+)", re.M)


class _Annotation:
    """An annotation that pdoc shows verbatim."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __repr__(self) -> str:
        return self._text


def write(folder: Path) -> None:
    """Writes a page per module and the index of their search."""
    modules = {name: importlib.import_module(name) for name in MODULES}
    _replace_engine(modules["retarget"])
    documents = {name: pdoc.doc.Module(module) for name, module in modules.items()}
    for module in documents.values():
        _complete(module, module, modules["retarget"].__all__)
    pdoc.render.configure(docformat="google", show_source=False, footer_text="",
                          template_directory=Path(__file__).with_name("templates"))
    for name, module in documents.items():
        file = folder / (name.replace(".", "/") + ".html")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(pdoc.render.html_module(module, documents), encoding="utf-8")
    (folder / "search.js").write_text(pdoc.render.search_index(documents), encoding="utf-8")


def _replace_engine(package: types.ModuleType) -> None:
    """Replaces compiled classes and functions by those of the stubs, which have signatures and types."""
    stubs = _stub_module("retarget._options"), _stub_module(_ENGINE)
    for name in package.__all__:
        value = getattr(package, name)
        if getattr(value, "__module__", "") == _ENGINE:
            stub = getattr(stubs[1], name)
            stub.__module__ = package.__name__
            setattr(package, name, stub)


def _stub_module(name: str) -> types.ModuleType:
    """Returns a module from its .pyi file, under another name."""
    file = Path(sys.modules["retarget"].__file__ or "").parent / f"{name.rpartition('.')[2]}.pyi"
    source = "from __future__ import annotations\n" + file.read_text(encoding="utf-8").replace("import retarget.", "# ")
    module = types.ModuleType(f"{name}_stub")
    # pdoc looks up annotations by the name of the module.
    sys.modules[module.__name__] = module
    exec(compile(source, str(file), "exec"), module.__dict__)
    return module


def _complete(document: pdoc.doc.Namespace, module: pdoc.doc.Module, names: list[str]) -> None:
    """Adds what the sources say in other ways: types, options, arguments, links to pages."""
    document.docstring = _with_links(document.docstring, module)
    members = document.members
    if isinstance(document, pdoc.doc.Class):
        document.decorators = []
        if "__init__" not in vars(document.obj):
            members.pop("__init__", None)
    else:
        # The functions first: most classes are their results.
        document.members = dict(sorted(members.items(), key=lambda each: isinstance(each[1], pdoc.doc.Class)))
    for member in members.values():
        if isinstance(member, pdoc.doc.Function) and (member.name == "__init__" or member.name[0] != "_"):
            _complete_function(member, names)
        if isinstance(member, pdoc.doc.Class):
            _complete(member, module, names)
        elif not isinstance(member, pdoc.doc.Module):
            member.docstring = _with_links(member.docstring, module)
        if isinstance(member, pdoc.doc.Variable):
            _complete_variable(member, module)


def _complete_function(function: pdoc.doc.Function, names: list[str]) -> None:
    try:
        signature = inspect.signature(function.obj)
    except (TypeError, ValueError):
        return  # A member of an exception or a descriptor.
    options = _OPTIONS.search(function.docstring)
    listed = set(re.findall(r"^    (\w+):", options["items"], re.M)) if options else set()
    kept, types_of = [], {}
    for parameter in signature.parameters.values():
        text = _annotation(parameter.annotation, names)
        if parameter.name in listed and parameter.kind is parameter.KEYWORD_ONLY and parameter.default is None:
            types_of[parameter.name] = text
        else:
            kept.append(parameter if text is None else parameter.replace(annotation=_Annotation(text)))
    if types_of:
        kept.append(inspect.Parameter("options", inspect.Parameter.VAR_KEYWORD))
    result = _annotation(signature.return_annotation, names)
    function.signature = signature.replace(
        parameters=kept, return_annotation=inspect.Signature.empty if result is None else _Annotation(result))
    function.decorators = [each for each in function.decorators if not each.startswith("@with_options")]
    if options:
        function.docstring = (function.docstring[:options.start()] + f"\n**Options** ({options['default']}):\n\n"
                              + _items(options["items"], types_of) + function.docstring[options.end():])
    else:
        function.docstring = _with_arguments(function.docstring, set(signature.parameters))


def _complete_variable(variable: pdoc.doc.Variable, module: pdoc.doc.Module) -> None:
    """Adds the docstring of a variable that is defined in another file, and hides values, which have local paths."""
    variable.default_value = inspect.Parameter.empty
    for name, other in sorted(sys.modules.items()):
        if not variable.docstring and name.startswith(f"{module.modulename}."):
            variable.docstring = walk_tree(other).var_docstrings.get(variable.qualname, "")


def _annotation(annotation: object, names: list[str]) -> str | None:
    """Returns an annotation as text in which the package's names are dotted: pdoc makes links of them."""
    if annotation is inspect.Parameter.empty:
        return None
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    text = re.sub(r"\b_retarget\.|\bcollections\.abc\.|\bnumpy\.typing\.", "", text)
    return re.sub(rf"(?<![\w.'\"])(?:{'|'.join(map(re.escape, names))})\b(?!['\"])", r"retarget.\g<0>", text)


def _items(items: str, types_of: dict[str, str | None]) -> str:
    """Returns `    name: help` lines as a list of Markdown."""
    lines = []
    for name, text in re.findall(r"^    (\w+): (.*(?:\n        .*)*)", items, re.M):
        kind = f" (`{types_of[name]}`)" if types_of.get(name) else ""
        text = re.sub(r"\s+", " ", text).replace("<", "&lt;").replace("*", r"\*")
        lines.append(f"- **{name}**{kind}: {text}\n")
    return "".join(lines)


def _with_arguments(docstring: str, parameters: set[str]) -> str:
    """Indents the arguments in docstrings of the engine, which have no heading, below `Args:`."""
    lines = docstring.split("\n")
    made: list[str] = []
    inside = "Args:" in lines
    for line in lines:
        found = re.match(r"(\w+(?:, \w+)*): ", line)
        is_argument = found is not None and set(found[1].split(", ")) <= parameters
        if is_argument and "Args:" not in made and not inside:
            made.append("Args:")
        made.append(f"    {line}" if is_argument and not inside else line)
    return "\n".join(made)


def _with_links(docstring: str, module: pdoc.doc.Module) -> str:
    """Makes links of names such as docs/quality.md, and marks code."""
    docstring = re.sub(r"(?<=\n\n)(?:    .*\n|\n(?=    ))+", lambda code: f"```python\n{textwrap.dedent(code[0])}```\n",
                       docstring)
    up = "../" * (module.modulename.count(".") + 1)
    return re.sub(r"\bdocs/(\w+)\.md\b", rf"[\1]({up}\1.html)", docstring)
