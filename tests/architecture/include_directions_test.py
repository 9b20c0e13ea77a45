"""Modules only include permitted headers; the library neither prints nor exits and computes identically on
all machines."""

import pathlib
import re
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]

# The core modules from the bottom up: a file includes only files of its own module and of modules before it.
CORE = ["base", "motion", "robot", "scene", "formats", "human", "solve", "judge", "app"]

# The folders of a module in their order: a folder includes only folders before it. A module without an
# entry has no folders.
FOLDERS = {
    "base": ["", "math"],
    "robot": ["model", "anatomy"],
    "formats": ["containers", "bvh", "smpl", "scene", "robot_motion", "world", "registry"],
    "human": ["skeleton", "gait"],
    "solve": ["ik", "targets", "hands", "dynamics", "fit", "online", "robot_setup"],
    "judge": ["quality", "inspect", "simulation"],
    "app": ["options", "provenance", "plan", "run"],
    "live": ["session", "stream"],
}

# Outer modules include public headers and their own files, like programs outside src.
OUTER = ["batch", "edit", "live", "rig", "view"]

# Public headers of outer modules that the core does not include either. It works without them: callers
# pass in what draws. (edit.h is not among them: a run mirrors its clip with it.)
RIM_HEADERS = ["batch", "edit_paths", "edit_seams", "edit_tables", "gallery", "ground_path", "live", "live_table",
               "repeated_clips", "rig", "serve",
               "serve_table", "view"]

# Clients include public headers and their own files: programs outside src have no other way in.
CLIENTS = ["tools/retarget", "python/src"]

INCLUDE = re.compile(r'^\s*#\s*include\s*["<](?!retarget/)([a-z0-9_]+(?:/[a-z0-9_]+)?)/[^/">]+[">]')

# The library's errors are values, and its user owns the terminal and the process.
FORBIDDEN = re.compile(
    r"#\s*include\s*<iostream>|\bstd::(cout|cerr|clog|exit|_Exit|quick_exit|abort|terminate)\b"
    r"|(?<![\w:.>])(?:std::|::)?(printf|puts|putchar|perror|abort|exit|_exit)\s*\(")

# C libraries choose these implementations by the processor, and the last digits differ:
# retarget/trigonometry.h replaces them. std::sqrt, std::remainder and rounding are exact
# everywhere.
NOT_PORTABLE = re.compile(
    r"(?<![\w:.>])(?:std::|::)"
    r"(sin|cos|tan|asin|acos|atan|atan2|exp|exp2|log|log2|log10|pow|cbrt|hypot|fma|sinh|cosh|tanh)\s*\("
    r"|\b(AngleAxisd?|angularDistance|slerp)\b")


# Messages name an option by its schema (base/option_name.h), because other callers have no flags.
FLAG = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")


def position(folder):
    """(module, folder in the module) as numbers; None for a folder of an outer module or outside src."""
    module, _, inner = folder.partition("/")
    if module not in CORE:
        return None
    return CORE.index(module), FOLDERS.get(module, [""]).index(inner)


def is_private(folder):
    return folder.partition("/")[0] in CORE + OUTER


def fault_of(folder, included):
    """Describes an include in a wrong direction; None if it is allowed."""
    if folder == included:
        return None
    module, other = folder.partition("/")[0], included.partition("/")[0]
    if module in OUTER:
        if other != module:
            return f"the outer module {module} includes public headers and its own files only"
        if FOLDERS[module].index(included.partition("/")[2]) > FOLDERS[module].index(
                folder.partition("/")[2]):
            return f"{folder} comes before {included}"
        return None
    if other in OUTER:
        return f"the core must not include the outer module {other}"
    return f"{folder} comes before {included}" if position(included) > position(folder) else None


def private_includes(top):
    """(file, folder) of each include of a private header in the files below a folder."""
    for file in sorted((SOURCE / top).rglob("*")):
        if file.suffix not in (".h", ".cpp", ".inc"):
            continue
        for line in file.read_text().splitlines():
            match = INCLUDE.match(line)
            if match and is_private(match.group(1)):
                yield str(file.relative_to(SOURCE)), match.group(1)


def library_files():
    """(folder below src, file) for every file of the library; other files have folder None."""
    for top in ("include", "src"):
        for file in sorted((SOURCE / top).rglob("*")):
            if file.suffix in (".h", ".cpp", ".inc"):
                parts = file.relative_to(SOURCE / top).parts
                yield ("/".join(parts[:-1]) if len(parts) > 1 and top == "src" else None), file


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
    def test_every_folder_is_in_a_table(self):
        for folder, file in library_files():
            if folder is None:
                continue
            module, _, inner = folder.partition("/")
            self.assertIn(module, CORE + OUTER, f"{file}: add the module to a table")
            self.assertIn(inner, FOLDERS.get(module, [""]), f"{file}: add the folder to FOLDERS")
        self.assertLessEqual(len(CORE) + len(OUTER), 16)

    def test_includes_go_one_way(self):
        faults = []
        for folder, file in library_files():
            if folder is None:
                continue
            for number, line in enumerate(file.read_text().splitlines(), 1):
                match = INCLUDE.match(line)
                if not match or not is_private(match.group(1)):
                    continue
                fault = fault_of(folder, match.group(1))
                if fault:
                    faults.append(f"{file.relative_to(SOURCE)}:{number}: {fault}")
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_clients_include_public_headers_only(self):
        faults = [f"{file}: {folder}" for top in CLIENTS for file, folder in private_includes(top)]
        self.assertEqual(faults, [], "use a header of include/retarget:\n" + "\n".join(faults))

    def test_clients_keep_no_lists_of_options(self):
        # A row says which work takes it (OptionUse); a list beside the tables forgets new options.
        known = set(re.findall(r"`--([a-z0-9-]+)`", (SOURCE / "docs/options.md").read_text()))
        self.assertGreater(len(known), 100)
        faults = []
        for top in CLIENTS:
            for file in sorted((SOURCE / top).glob("*.cpp")):
                for listed in re.findall(r"\{((?:\s*\"[^\"]*\"\s*,?){3,})\}", file.read_text()):
                    names = re.findall(r'"([^"]*)"', listed)
                    if known.issuperset(names):
                        faults.append(f"{file.relative_to(SOURCE)}: {names}")
        self.assertEqual(faults, [])

    def test_core_needs_no_public_header_of_the_rim(self):
        faults = []
        for folder, file in library_files():
            if folder is None or folder.partition("/")[0] not in CORE:
                continue
            for line in file.read_text().splitlines():
                match = re.match(r'\s*#\s*include\s*"retarget/([a-z_]+)\.h"', line)
                if match and match.group(1) in RIM_HEADERS:
                    faults.append(f"{file.relative_to(SOURCE)}: retarget/{match.group(1)}.h")
        self.assertEqual(faults, [])

    def test_few_arrows_between_rooms(self):
        arrows = set()
        for folder, file in library_files():
            for line in file.read_text().splitlines() if folder else ():
                match = INCLUDE.match(line)
                if match and is_private(match.group(1)):
                    arrows.add((folder.partition("/")[0], match.group(1).partition("/")[0]))
        self.assertLess(len({(a, b) for a, b in arrows if a != b}), 60)

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
    def test_directions(self):
        for folder, included in (("app/plan", "solve/fit"), ("solve/fit", "solve/ik"),
                                 ("base/math", "base"), ("live/stream", "live/session"),
                                 ("batch", "batch")):
            self.assertIsNone(fault_of(folder, included), (folder, included))
        for folder, included in (("solve/fit", "app/plan"), ("solve/ik", "solve/fit"),
                                 ("live/session", "live/stream"), ("batch", "view"),
                                 ("batch", "app/run"), ("live/stream", "base"),
                                 ("app/run", "view"), ("base", "base/math")):
            self.assertIsNotNone(fault_of(folder, included), (folder, included))

    def test_private_includes(self):
        self.assertEqual(INCLUDE.match('#include "solve/fit/fit.h"').group(1), "solve/fit")
        self.assertEqual(INCLUDE.match('#include "base/file.h"').group(1), "base")
        self.assertIsNone(INCLUDE.match('#include "retarget/load.h"'))
        self.assertFalse(is_private("nlohmann"))

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
