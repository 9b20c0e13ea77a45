"""Modules include only what they may; the library neither prints nor ends the process, and computes
with nothing that differs from machine to machine."""

import pathlib
import re
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]

# module: the modules that it may include directly; what those may include, it may include too
MAY_INCLUDE = {
    "base": [],
    "options": ["base"],
    "math": ["base"],
    "motion": ["math", "options"],
    "bvh": ["motion"],
    "smpl": ["motion"],
    "scene": ["motion"],
    "human": ["bvh", "smpl", "scene"],
    "inspect": ["human"],
    "edit": ["human"],
    "robot": ["motion"],
    "ik": ["robot"],
    "dynamics": ["ik"],
    "io": ["robot"],
    "pipeline": ["human", "ik"],
    "anatomy": ["robot"],
    "rig": ["pipeline", "anatomy"],
    "hands": ["human", "ik", "anatomy"],
    "fit": ["pipeline", "dynamics"],
    "quality": ["fit", "dynamics", "hands"],
    "plan": ["anatomy", "quality", "io"],
    "live": ["fit", "options"],
    "stream": ["live", "plan"],
    "provenance": ["io"],
    "run": ["plan", "provenance", "view", "edit"],
    "batch": ["run"],
    "view": ["fit", "quality", "io"],
}

INCLUDE = re.compile(r'^\s*#\s*include\s*["<](?!retarget/)([a-z0-9_]+)/[^">]+[">]')

# the library's errors are values, and its user owns the terminal and the process
FORBIDDEN = re.compile(
    r"#\s*include\s*<iostream>|\bstd::(cout|cerr|clog|exit|_Exit|quick_exit|abort|terminate)\b"
    r"|(?<![\w:.>])(?:std::|::)?(printf|puts|putchar|perror|abort|exit|_exit)\s*\(")

# C libraries choose these by the processor, and the last digits differ: math/trigonometry.h has
# what serves; std::sqrt, std::remainder and rounding are exact everywhere
NOT_PORTABLE = re.compile(
    r"(?<![\w:.>])(?:std::|::)"
    r"(sin|cos|tan|asin|acos|atan|atan2|exp|exp2|log|log2|log10|pow|cbrt|hypot|fma|sinh|cosh|tanh)\s*\("
    r"|\b(AngleAxisd?|angularDistance|slerp)\b")


# texts for people name an option by its schema (base/option_name.h): other callers have no flags
FLAG = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")


def allowed(module):
    """The module itself and all that it may include, directly or not."""
    reached = {module}
    waiting = [module]
    while waiting:
        for other in MAY_INCLUDE[waiting.pop()]:
            if other not in reached:
                reached.add(other)
                waiting.append(other)
    return reached


def library_files():
    """(module, file) for every file of a module; files beside the modules have module None."""
    for top in ("include", "src"):
        for file in sorted((SOURCE / top).rglob("*")):
            if file.suffix in (".h", ".cpp", ".inc"):
                parts = file.relative_to(SOURCE / top).parts
                yield (parts[0] if len(parts) > 1 and top == "src" else None), file


def without_comments(text):
    """The text with comments and string contents blanked, line numbers kept."""
    pattern = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)

    def blank(match):
        found = match.group(0)
        return '""' if found.startswith('"') else "\n" * found.count("\n")

    return pattern.sub(blank, text)


def string_literals(text):
    """(line, literal) for every string literal, the prefixes of raw ones included."""
    pattern = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.*?)\)"|"(?:\\.|[^"\\\n])*"', re.DOTALL)
    for match in pattern.finditer(text):
        if '"' in match.group(0)[:2]:
            yield text.count("\n", 0, match.start()) + 1, match.group(0)


class IncludeDirections(unittest.TestCase):
    def test_table_has_no_circle(self):
        for module, direct in MAY_INCLUDE.items():
            for other in direct:
                self.assertNotIn(module, allowed(other), f"{module} and {other} include each other")

    def test_every_module_is_in_the_table(self):
        for module, file in library_files():
            if module is not None:
                self.assertIn(module, MAY_INCLUDE, f"{file}: add the module to MAY_INCLUDE")

    def test_includes_go_one_way(self):
        faults = []
        for module, file in library_files():
            if module not in MAY_INCLUDE:
                continue
            for number, line in enumerate(file.read_text().splitlines(), 1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                other = match.group(1)
                if other in MAY_INCLUDE and other not in allowed(module):
                    place = f"{file.relative_to(SOURCE)}:{number}"
                    faults.append(f"{place}: {module} may not include {other}")
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_public_headers_include_no_private_ones(self):
        faults = []
        public = SOURCE / "include"
        for file in sorted(public.rglob("*.h")):
            for line in file.read_text().splitlines():
                match = re.match(r'\s*#\s*include\s*"([^"]+)"', line)
                if match and not (public / match.group(1)).exists():
                    faults.append(f"{file.relative_to(SOURCE)}: {match.group(1)}")
        self.assertEqual(faults, [])

    def test_public_headers_are_seen_from_outside_of_a_shared_library(self):
        for file in sorted((SOURCE / "include").rglob("*.h")):
            opened = re.findall(r"^namespace (?!\w+ = ).*\bretarget\b.*{$", file.read_text(), re.M)
            self.assertEqual(set(opened) - {"namespace RETARGET_API retarget {"}, set(), file)

    def test_no_flags_of_the_command_line_in_texts(self):
        faults = []
        for _, file in library_files():
            for number, text in string_literals(file.read_text()):
                if FLAG.search(text):
                    faults.append(f"{file.relative_to(SOURCE)}:{number}: {text}")
        self.assertEqual(faults, [], "name an option by OPTION():\n" + "\n".join(faults))

    def test_library_neither_prints_nor_exits(self):
        faults = []
        for _, file in library_files():
            lines = without_comments(file.read_text()).splitlines()
            for number, line in enumerate(lines, 1):
                if FORBIDDEN.search(line):
                    faults.append(f"{file.relative_to(SOURCE)}:{number}: {line.strip()}")
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_library_computes_alike_on_every_machine(self):
        faults = []
        for _, file in library_files():
            lines = without_comments(file.read_text()).splitlines()
            for number, line in enumerate(lines, 1):
                if NOT_PORTABLE.search(line):
                    faults.append(f"{file.relative_to(SOURCE)}:{number}: {line.strip()}")
        self.assertEqual(faults, [], "\n" + "\n".join(faults))


class TheChecksThemselves(unittest.TestCase):
    def test_allowed_reaches_through(self):
        self.assertEqual(allowed("motion"), {"motion", "math", "options", "base"})
        self.assertIn("base", allowed("view"))
        self.assertNotIn("io", allowed("pipeline"))

    def test_forbidden_words(self):
        for bad in ("#include <iostream>", "std::cerr << x;", 'printf("")', "std::exit(1);",
                    "  ::abort();", "std::printf(x)"):
            self.assertTrue(FORBIDDEN.search(bad), bad)
        for good in ("std::snprintf(b, n, f)", "loop.exit()", "on_exit(x)", "file.printf(x)"):
            self.assertFalse(FORBIDDEN.search(good), good)
        self.assertFalse(FORBIDDEN.search(without_comments('x = "exit(1)"; // abort()')))

    def test_flags_in_texts(self):
        found = [text for _, text in string_literals('a("--fps 30"); // "--x"\nb(R"(use\n--up y)"); c("a -- b")')]
        self.assertEqual([bool(FLAG.search(text)) for text in found], [True, True, False])

    def test_not_portable_words(self):
        for bad in ("std::sin(x)", "return std::pow (a, b);", "Eigen::AngleAxisd(a, b)",
                    "q.slerp(t, p)"):
            self.assertTrue(NOT_PORTABLE.search(bad), bad)
        for good in ("portable::sin_cos(x)", "portable::atan2(y, x)", "std::sqrt(x)",
                     "log_so3(q)", "std::abs(x)"):
            self.assertFalse(NOT_PORTABLE.search(good), good)


if __name__ == "__main__":
    unittest.main()
