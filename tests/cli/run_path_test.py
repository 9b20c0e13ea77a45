"""Libraries come from fixed folders: nothing in the working directory is loaded as code."""

import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import run_path
from tool import TOOL, ToolTest, absent


@unittest.skipUnless(sys.platform == "linux", "ELF files")
class RunPath(ToolTest):
    def test_the_tool_searches_no_folder_of_its_user(self):
        # The same test checks an installed tree, see tests/consumer.
        self.assertEqual(run_path.loose_entries(pathlib.Path(TOOL)), [], run_path.run_path(
            pathlib.Path(TOOL)))

    def test_libraries_next_to_the_tool_are_not_loaded(self):
        folder = pathlib.Path(TOOL).resolve().parent
        for library in [*folder.glob("../lib/**/*.so*"), *folder.glob("../../*.so*")]:
            if library.is_file():
                self.assertEqual(run_path.loose_entries(library), [], library)

    def test_a_library_of_the_working_directory_is_not_loaded(self):
        compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
        if compiler is None:
            absent("there is no C compiler to make a library with")
        source = self.write("evil.c", """#include <stdio.h>
__attribute__((constructor)) static void run(void) { fputs("loaded", stderr); }
""")
        for name in ("libz.so.1", "libzip.so.4", "libtinyxml2.so.9", "libfmt.so.9"):
            subprocess.run([compiler, "-shared", "-fPIC", "-o", self.folder / name, source],
                           check=True)
        environment = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
        result = self.run_tool("--version", env=environment)
        self.assertNotIn("loaded", result.stderr)
        self.assert_done(result)


@unittest.skipUnless(sys.platform == "linux", "ELF files")
class Hardening(ToolTest):
    """The built tool has the protections of RETARGET_HARDENING."""

    def read(self, *options):
        program = shutil.which("readelf")
        if program is None:
            absent("there is no readelf")
        return subprocess.run([program, "-W", *options, TOOL], check=True, text=True,
                              stdout=subprocess.PIPE).stdout

    def setUp(self):
        super().setUp()
        if os.environ.get("RETARGET_HARDENED") != "ON":
            self.skipTest("built without RETARGET_HARDENING")

    def test_it_lies_anywhere_in_memory(self):
        self.assertRegex(self.read("-h"), r"Type:\s+DYN")
        self.assertRegex(self.read("-d"), r"FLAGS_1.*\bPIE\b")

    def test_its_tables_are_read_only_and_its_stack_is_no_code(self):
        segments = self.read("-l")
        self.assertIn("GNU_RELRO", segments)
        stack = next(line for line in segments.splitlines() if "GNU_STACK" in line)
        self.assertNotRegex(stack, r"\bRWE\b")
        dynamic = self.read("-d")
        self.assertRegex(dynamic, r"BIND_NOW|FLAGS_1.*\bNOW\b")

    def test_its_stacks_and_its_library_calls_are_checked(self):
        symbols = self.read("--dyn-syms")
        self.assertIn("__stack_chk_fail", symbols)
        self.assertRegex(symbols, r"__\w+_chk\b")


if __name__ == "__main__":
    unittest.main()
