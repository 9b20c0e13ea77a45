"""Libraries come from fixed places: nothing in the working directory is loaded as code."""

import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import run_path
from tool import TOOL, ToolTest


@unittest.skipUnless(sys.platform == "linux", "ELF files")
class RunPath(ToolTest):
    def test_the_tool_searches_no_folder_of_its_user(self):
        # an installed tree is checked by the same test, see tests/consumer
        self.assertEqual(run_path.loose_entries(pathlib.Path(TOOL)), [], run_path.run_path(
            pathlib.Path(TOOL)))

    def test_libraries_next_to_the_tool_neither(self):
        folder = pathlib.Path(TOOL).resolve().parent
        for library in [*folder.glob("../lib/**/*.so*"), *folder.glob("../../*.so*")]:
            if library.is_file():
                self.assertEqual(run_path.loose_entries(library), [], library)

    def test_a_library_of_the_working_directory_is_not_loaded(self):
        compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
        if compiler is None:
            self.skipTest("no C compiler to make a library with")
        source = self.write("evil.c", """#include <stdio.h>
__attribute__((constructor)) static void run(void) { fputs("loaded", stderr); }
""")
        for name in ("libz.so.1", "libcrypto.so.3", "libtinyxml2.so.9"):
            subprocess.run([compiler, "-shared", "-fPIC", "-o", self.folder / name, source],
                           check=True)
        environment = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
        result = self.run_tool("--version", env=environment)
        self.assertNotIn("loaded", result.stderr)
        self.assert_done(result)


if __name__ == "__main__":
    unittest.main()
