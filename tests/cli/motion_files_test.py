"""What happens to files beside and between runs: nothing is overwritten, differences are told."""

import pathlib
import pickle
import unittest

from tool import ToolTest, sample


class NothingIsOverwritten(ToolTest):
    def test_outputs_are_no_inputs(self):
        clip = self.folder / "w.bvh"
        clip.write_bytes(pathlib.Path(sample("wave")).read_bytes())
        before = clip.read_bytes()
        for option in ("--report", "--write-map"):
            self.assert_fails(self.retarget(option, "w.bvh", bvh=clip), 2, "overwrite")
        self.assertEqual(clip.read_bytes(), before)
        self.assert_done(self.retarget("--method", "gmr"))
        motion = self.folder / "out.csv"
        before = motion.read_bytes()
        self.assert_fails(self.run_tool("evaluate", "out.csv", "--robot", "unitree_g1", "--json",
                                        "out.csv"), 2, "overwrite")
        self.assertEqual(motion.read_bytes(), before)

    def test_motion_and_report_come_together(self):
        self.assertEqual(self.retarget("--method", "gmr", "--report", "/dev/full").returncode, 1)
        self.assertEqual(self.files(), [])


class Differences(ToolTest):
    def test_the_tolerance_itself_agrees(self):
        self.write("a.csv", "0.043508,1,2\n0.1,1,2\n")
        self.write("b.csv", "0.043509,1,2\n0.1,1,2\n")
        self.assert_done(self.run_tool("compare", "a.csv", "b.csv", "--tolerance", "1e-6"))
        self.write("c.csv", "0.043510,1,2\n0.1,1,2\n")
        self.assert_fails(self.run_tool("compare", "a.csv", "c.csv", "--tolerance", "1e-6"), 1)

    def test_rates_count_and_nothing_is_no_agreement(self):
        self.assert_done(self.retarget("--method", "gmr"))
        for fps in ("30", "25"):
            self.assert_done(self.run_tool("convert", "out.csv", f"{fps}.pkl", "--robot",
                                           "unitree_g1", "--format", "pkl-gmr", "--source-fps",
                                           fps))
        self.assert_done(self.run_tool("compare", "30.pkl", "30.pkl"))
        self.assert_fails(self.run_tool("compare", "30.pkl", "25.pkl"), 1, "fps")
        (self.folder / "empty.pkl").write_bytes(pickle.dumps({"about": "nothing"}, protocol=4))
        self.assert_fails(self.run_tool("compare", "empty.pkl", "empty.pkl"), 3)


if __name__ == "__main__":
    unittest.main()
