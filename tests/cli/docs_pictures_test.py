"""The pictures of docs/ are those that the tool draws, and show the figures that it measures."""

import importlib.util
import json
import sys
import tempfile
import unittest

from tool import SOURCE, TOOL, ToolTest, is_sanitized

sys.path.insert(0, str(SOURCE / "tools"))
import docs_figures  # noqa: E402  (tools/)


class Pictures(ToolTest):
    def setUp(self):
        super().setUp()
        if is_sanitized():
            self.skipTest("a build with sanitizers takes long and makes the same figures")

    def test_committed_drawings_are_up_to_date(self):
        for name, content in docs_figures.draw_with_tool(TOOL, self.folder).items():
            # The compression of PNG depends on zlib: view_test compares the pixels.
            if name.endswith(".svg"):
                self.assertTrue(content == (SOURCE / "docs/pictures" / name).read_bytes(),
                                f"{name}: {docs_figures.AGAIN}")

    def test_page_screenshots_match_the_current_metrics(self):
        if importlib.util.find_spec("numpy") is None:
            self.skipTest("there is no numpy")
        with tempfile.TemporaryDirectory() as folder:
            gates = docs_figures.page_gates(TOOL, folder)
        self.assertEqual(json.loads(docs_figures.PAGES_FILE.read_text()), gates, docs_figures.AGAIN)


if __name__ == "__main__":
    unittest.main()
