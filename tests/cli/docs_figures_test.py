"""The figures that README.md and docs/ state are those that the tool measures."""

import pathlib
import re
import sys
import unittest

from tool import SOURCE, TOOL, ToolTest, is_sanitized

sys.path.insert(0, str(SOURCE / "tools"))
import docs_figures  # noqa: E402  (tools/)
import quality_tables  # noqa: E402

class Marks(unittest.TestCase):
    def test_marks_of_all_documents_are_sound(self):
        counts = {}
        for file in docs_figures.documents():
            text = file.read_text(encoding="utf-8")
            self.assertEqual(docs_figures.fault_of_marks(text), "", file)
            counts[str(file.relative_to(SOURCE))] = len(docs_figures.FIGURE.findall(text)) + len(
                docs_figures.TABLE.findall(text))
        self.assertGreaterEqual(counts["README.md"], 9)
        self.assertGreaterEqual(counts["docs/quality.md"], 13)

    def test_every_number_of_the_readme_s_comparison_is_measured(self):
        text = (SOURCE / "README.md").read_text(encoding="utf-8")
        table = re.search(r"\n\| \| published method \|.*\n\|---.*\n((?:\|.*\n)+)", text)[1]
        self.assertEqual(len(table.splitlines()), 4)
        for row in table.splitlines():
            for cell in row.split("|")[2:-1]:
                rest = docs_figures.SPEED.sub("", docs_figures.FIGURE.sub("", cell))
                self.assertNotRegex(rest, r"\d", row)

    def test_speeds_are_those_of_the_page_of_benchmarks(self):
        page = (SOURCE / "docs/performance.md").read_text(encoding="utf-8")
        speeds = [mark for file in docs_figures.documents()
                  for mark in docs_figures.SPEED.finditer(file.read_text(encoding="utf-8"))]
        self.assertGreaterEqual(len(speeds), 3)
        for mark in speeds:
            self.assertTrue((SOURCE / mark["what"]).is_file(), mark[0])
            self.assertIn(pathlib.Path(mark["what"]).name, page)
            self.assertRegex(page, rf"[| ]{re.escape(mark['text'])}[ |]", mark[0])

    def test_faults_of_marks_are_found(self):
        figure = "<!-- figure: gates -->1<!-- /figure -->"
        for text, fault in ((f"a {figure}", ""), ("no marks", ""),
                            ("a <!-- figure: gates -->1", "1 marks, of which 0 are pairs"),
                            (f"a\n{figure} b", "a line begins with a mark")):
            self.assertRegex(docs_figures.fault_of_marks(text), f"^{fault}" if fault else "^$")


class Measured(unittest.TestCase):
    """Texts computed from given reports."""

    def fresh(self, text, known, **options):
        clips = quality_tables.Clips()
        reports = quality_tables.Reports("no tool", clips)
        reports.known = {(quality_tables.DATA / f"{name}.bvh", options.get("robot", "unitree_g1"),
                          method, False): report for (name, method), report in known.items()}
        return docs_figures.Fresh(reports).document(text)

    def figure(self, what, known, old="old", **options):
        text = self.fresh(f"a <!-- figure: {what} -->{old}<!-- /figure --> b", known, **options)
        return docs_figures.FIGURE.search(text)["text"]

    def test_a_stale_figure_is_replaced_and_an_unknown_one_stays(self):
        known = {("walk", "fit"): {"slip": 0.00068, "angle": [1.96, 4]},
                 ("walk", "gmr"): {"slip": 0.0418}, ("squat", "fit"): {"slip": 0.002}}
        self.assertEqual(self.figure("slip of=walk scale=1000 format=.1f", known), "0.7")
        self.assertEqual(self.figure("slip of=walk method=gmr scale=1000 format=.0f", known), "42")
        self.assertEqual(self.figure("angle of=walk", known), "2.0")
        self.assertEqual(self.figure("slip of=walk,squat take=range format=.4f", known),
                         "0.0007 to 0.0020")
        self.assertEqual(self.figure("slip of=walk,squat take=max format=.3f", known), "0.002")
        # Clips that are missing or have no figures.
        self.assertEqual(self.figure("slip of=lafan1", known), "old")
        self.assertEqual(self.figure("slip of=wave", known), "old")
        for wrong in ("slip", "slip of=walk robt=unitree_h1", "slap of=walk"):
            with self.assertRaises(docs_figures.MarkError):
                self.figure(wrong, known)

    def test_words_for_gates(self):
        gates = [{"metric": "a", "passed": True}, {"metric": "b", "passed": None},
                 {"metric": "c", "passed": False}, {"metric": "solver_failures", "passed": True}]
        known = {("walk", "fit"): {"gates": gates}, ("squat", "fit"): {"gates": gates[:2]}}
        self.assertEqual(self.figure("verdict of=walk", known), "1 of 3 gates passed")
        self.assertEqual(self.figure("passed of=walk,squat", known), "1")
        self.assertEqual(self.figure("motions of=walk,squat", known), "2")

    def test_a_table_keeps_the_cells_that_are_not_measured(self):
        known = {(name, method): {"limb_angle_deg": [angle, 0.0], "jumps": 0}
                 for name in quality_tables.SAMPLES for method, angle in (("fit", 2.0),
                                                                           ("as-published", 3.0))}
        old = ("<!-- table: means robot=unitree_h2 -->\n\n| mean of | LAFAN1 | samples |\n"
               "| --- | --- | --- |\n| `limb_angle_deg` | 7.5 -> 3.1 | 9 -> 9 |\n\n<!-- /table -->")
        text = self.fresh(old, known, robot="unitree_h2")
        self.assertIn("| mean of | LAFAN1 | excerpts | other skeletons | samples |", text)
        self.assertIn("| `limb_angle_deg` | 7.5 -> 3.1 |  |  | 3 -> 2 |", text)
        self.assertEqual(self.fresh(old, {}, robot="unitree_h2"), old)


class Figures(ToolTest):
    def setUp(self):
        super().setUp()
        if is_sanitized():
            self.skipTest("a build with sanitizers takes long and makes the same figures")

    def test_stated_figures_are_those_that_are_measured(self):
        """Always checks data/; with shared data also LAFAN1 and others, only for the G1."""
        now = docs_figures.fresh_documents(TOOL, docs_figures.shared_data(), quick=True)
        stale = docs_figures.stale_lines(now)
        self.assertFalse(stale, "\n".join([docs_figures.AGAIN, *stale]))


if __name__ == "__main__":
    unittest.main()
