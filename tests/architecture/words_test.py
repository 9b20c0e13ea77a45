"""tools/check_words.py: every pattern finds its bad example, and only prose is checked."""

import contextlib
import importlib.util
import io
import pathlib
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = SOURCE / "tools" / "check_words.py"
spec = importlib.util.spec_from_file_location("check_words", SCRIPT)
check_words = importlib.util.module_from_spec(spec)
spec.loader.exec_module(check_words)

PATTERNS = check_words.read_patterns()
BAD = "stands" + " fast"  # this file is checked, too


def found(text, kind):
    """(line, column, words) of every hit."""
    hits = check_words.check_text("file", text, kind, PATTERNS)
    return [(hit.line, hit.column, hit.words) for hit in hits]


class Examples(unittest.TestCase):
    def test_there_are_at_least_eighty_patterns(self):
        self.assertGreaterEqual(len(PATTERNS), 80)
        self.assertEqual(len({pattern.words for pattern in PATTERNS}), len(PATTERNS))

    def test_patterns_find_their_bad_example(self):
        for pattern in PATTERNS:
            with self.subTest(pattern.words):
                text, _ = check_words.prose(pattern.bad, "markdown")
                self.assertTrue(list(pattern.find(text)), pattern.bad)

    def test_no_pattern_finds_a_good_example(self):
        for pattern in PATTERNS:
            with self.subTest(pattern.words):
                self.assertEqual(found(pattern.good, "markdown"), [])

    def test_incomplete_entries_are_errors(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "words.txt")
            path.write_text("avoid: x\nwrite: y\ngood: z\n")
            with self.assertRaisesRegex(ValueError, 'words.txt:3: expected "bad: ..."'):
                check_words.read_patterns(path)
            path.write_text("avoid: x\nwrite: y\n")
            with self.assertRaisesRegex(ValueError, "incomplete"):
                check_words.read_patterns(path)


class Prose(unittest.TestCase):
    def test_reports_line_and_column(self):
        self.assertEqual(found(f"int a;\nint b;  // It {BAD}.\n", "c"), [(2, 15, BAD)])

    def test_comments_and_strings_of_cpp_are_checked(self):
        for text in (f"/// It {BAD}.", f"/* It\n * {BAD} */", f'f("it {BAD}");',
                     f'auto x = R"(it {BAD})";', f'auto x = R"x(it {BAD})x";',
                     f"x = 1'000;  // it {BAD}", f"""if (x == '"') y("it {BAD}");"""):
            with self.subTest(text):
                self.assertEqual([hit[2] for hit in found(text, "c")], [BAD])

    def test_code_is_not_checked(self):
        for text, kind in ((f"{BAD};", "c"), (f"#include <{BAD}>", "c"),
                           (BAD, "python"), ("stands(fast)", "cmake"),
                           (BAD, "shell"), (f"{BAD};", "js"),
                           ("stands_fast // a\n", "c"), ('x("stands", "fast");', "c")):
            with self.subTest(text):
                self.assertEqual(found(text, kind), [])

    def test_sentences_go_on_in_the_next_line(self):
        first, second = BAD.split()
        for text, kind in ((f"  // it {first}\n  // {second}", "c"),
                           (f"/// {first}\n/// {second}", "c"),
                           (f'"it {first} "\n    "{second}"', "c"),
                           (f"# {first}\n# {second}", "python"),
                           (f"a {first}\n{second}", "markdown")):
            with self.subTest(text):
                self.assertEqual([hit[2] for hit in found(text, kind)], [BAD])
        self.assertEqual(found(f"x;  // {first}\ny;  // {second}\n", "c"), [])

    def test_python_shell_cmake_and_javascript(self):
        for text, kind in ((f'def f():\n    """It {BAD}."""', "python"),
                           (f"f(f'it {BAD} {{x}}')", "python"), (f"x = 1  # it {BAD}", "python"),
                           (f"echo \"it {BAD}\"", "shell"), (f"echo 'it {BAD}'", "shell"),
                           (f"f ${{#x}} # it {BAD}", "shell"), (f"set(x y)  # it {BAD}", "cmake"),
                           (f'message("it {BAD}")', "cmake"), (f"x = `it {BAD}`;", "js"),
                           (f"// it {BAD}", "js"), (f"x = 'it {BAD}';", "js")):
            with self.subTest(text):
                self.assertEqual([hit[2] for hit in found(text, kind)], [BAD])

    def test_code_of_markdown_is_skipped(self):
        text = (f"```sh\nit {BAD}\n```\n\n~~~\nit {BAD}\n~~~\n\n"
                f"`it {BAD}` and [x](it-{BAD}.md)\n\nIt {BAD}.\n")
        self.assertEqual(found(text, "markdown"), [(11, 4, BAD)])

    def test_only_whole_words_at_the_beginning_of_a_sentence_where_the_pattern_says_so(self):
        self.assertEqual(found("Stands faster. Understands fast. stands-fast", "markdown"), [])
        self.assertEqual(found("It shows what the robot does.", "markdown"), [])
        self.assertEqual(found("What does the robot do?", "markdown"), [])
        self.assertEqual(len(found("It ends. What" + " moves is drawn.", "markdown")), 1)

    def test_some_patterns_are_for_pages_alone(self):
        bad = "Boxes count" + " with this option only."
        self.assertEqual(len(found(bad, "markdown")), 1)
        self.assertEqual(found(f"// {bad}", "c"), [])

    def test_marked_lines_are_exempt(self):
        self.assertEqual(found(f"// It {BAD}.  words-ok\n", "c"), [])
        self.assertEqual(found(f"It {BAD}. <!-- words-ok -->\n", "markdown"), [])


class Files(unittest.TestCase):
    def test_history_generated_files_and_other_peoples_text_are_exempt(self):
        for name in ("CHANGELOG.md", "third_party/a/b.cpp", "data/README.md",
                     "viewer/dist/viewer.js", "docs/options.md", "LICENSE",
                     "THIRD_PARTY_NOTICES", "src/a.png"):
            self.assertIsNone(check_words.language(name), name)
        for name, kind in (("src/a/b.h", "c"), ("x.inc", "c"), ("CMakeLists.txt", "cmake"),
                           (".ci/run", "shell"), ("cmake/a.cmake", "cmake"),
                           ("docs/fit.md", "markdown"), ("viewer/src/a.js", "js")):
            self.assertEqual(check_words.language(name), kind, name)

    def test_all_kinds_of_files_are_found(self):
        names = check_words.repository_files()
        for name in ("README.md", "tools/check.sh", "tools/check_words.py", "CMakeLists.txt"):
            self.assertIn(name, names)


class Repository(unittest.TestCase):
    """The modes, in a small separate repository."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.addCleanup(setattr, check_words, "ROOT", check_words.ROOT)
        check_words.ROOT = self.root

    def run_check(self, *arguments):
        """(exit code, what was printed)"""
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            code = check_words.main(list(arguments))
        return code, out.getvalue()

    def git(self, *arguments):
        identity = ("-c", "user.name=a", "-c", "user.email=a@example.org")
        subprocess.run(["git", "-C", self.root, *identity, *arguments], check=True,
                       capture_output=True)

    def test_hits_are_errors(self):
        page = self.root / "a.md"
        page.write_text(f"It {BAD}. It {BAD}.\n")
        code, text = self.run_check()
        self.assertEqual(code, 1)
        self.assertIn(f'a.md:1:4: "{BAD}": write "is fixed"', text)
        self.assertIn("words: 2 hits", text)

        page.write_text("It is fixed.\n")
        self.assertEqual(self.run_check(), (0, "words: clean\n"))

    def test_named_files_are_checked_alone(self):
        (self.root / "a.h").write_text("// It is fixed.\n")
        (self.root / "b.h").write_text(f"// It {BAD}.\n")
        self.assertEqual(self.run_check(str(self.root / "a.h"))[0], 0)
        code, text = self.run_check(str(self.root / "b.h"))
        self.assertEqual(code, 1)
        self.assertIn("b.h:1:7", text)

    def test_new_checks_added_lines_alone(self):
        page = self.root / "a.md"
        page.write_text(f"It {BAD}.\n")
        self.git("init", "-b", "main")
        self.git("add", ".")
        self.git("commit", "-m", "first")
        page.write_text(f"It {BAD}.\n\nIt is fixed.\n")
        self.git("commit", "-am", "second")
        self.assertEqual(self.run_check("--new"), (0, "words: clean\n"))
        page.write_text(f"It {BAD}.\n\nIt also {BAD}.\n")
        code, text = self.run_check("--new")
        self.assertEqual((code, text.count("a.md:")), (1, 1))
        self.assertIn("a.md:3:9", text)
        self.assertEqual(self.run_check("--new", "HEAD~1")[0], 1)

        self.git("checkout", "-b", "work")
        self.git("commit", "-am", "on a branch")
        page.write_text(page.read_text() + "\nThe last line.\n")
        self.git("commit", "-am", "on a branch again")
        self.assertIn("a.md:3:9", self.run_check("--new")[1])
        self.assertEqual(self.run_check("--new", "HEAD~1")[0], 0)
        code, text = self.run_check("--new", "no-such-commit")
        self.assertEqual(code, 2)
        self.assertIn("no-such-commit", text)


class ThisRepository(unittest.TestCase):
    def test_has_no_hits(self):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            code = check_words.main([])
        self.assertEqual(code, 0, out.getvalue())


if __name__ == "__main__":
    unittest.main()
