"""How commands are called: words without options, short names, mistakes and their messages."""

import re
import shlex
import shutil
import subprocess
import unittest

from tool import SOURCE, TOOL, ToolTest, sample, short_clip

COMMANDS = ("batch", "compare", "convert", "edit", "evaluate", "inspect", "live", "robots", "verify")

# The same kinds of values, as help pages name them.
OPTION_KINDS = {"S": "SECONDS", "N\\|source": "N", "NAME,...": "NAME", "ADDRESS,...": "ADDRESS"}
# Options with different kinds of values in several commands; each command makes the meaning clear.
# This list may only shrink.
NAMES_OF_SEVERAL_KINDS = {
    "contacts": {"FILE", ""},  # A batch has one file per clip.
    "json": {"FILE", ""},
    "list": {"FILE", ""},  # A list of inputs (batch), or of formats (live).
    "output": {"FILE", "DIR", "ADDRESS"},
    "scale": {"auto\\|table\\|height\\|limbs", "N"},  # The scale of a body, or of a path.
    "skeleton": {"FILE", ""},
    "to": {"FILE", "FILE\\|line\\|circle\\|figure8", "ADDRESS"},
    "tolerance": {"M", "X"},
}


class Words(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("walk.bvh", sample("wave").read_bytes())

    def run_to(self, output, *words):
        self.assert_done(self.run_tool(*words, "-o", output))
        return (self.folder / output).read_bytes()

    def test_motion_and_robot_need_no_options(self):
        plain = self.run_to("plain.csv", "--bvh", "walk.bvh", "--robot", "unitree_g1")
        for words in (("walk.bvh", "g1"), ("walk.bvh", "--robot", "g1"), ("g1", "walk.bvh"),
                      ("--robot", "G1", "walk.bvh"), ("--bvh", "walk.bvh", "unitree_g1"),
                      ("walk.bvh", SOURCE / "robots" / "unitree_g1")):
            self.assertEqual(self.run_to("out.csv", *words), plain, words)

    def test_short_names_are_understood_everywhere(self):
        self.run_to("out.csv", "walk.bvh", "g1", "--sidecar")
        sidecar = (self.folder / "out.csv.json").read_text()
        self.assertIn('"robot": "unitree_g1"', sidecar)
        self.assert_done(self.run_tool("verify", "out.csv.json"))
        self.assert_done(self.run_tool("evaluate", "out.csv", "--robot", "g1", "--gate", "none"))
        self.assert_done(self.run_tool("convert", "out.csv", "again.csv", "--robot", "g1"))
        self.assert_done(self.run_tool("compare", "out.csv", "again.csv", "--robot", "g1"))
        self.assert_done(self.run_tool("robots", "check", "g1"))
        shown = self.run_tool("robots", "show", "toddy")
        self.assertIn("stanford_toddy", shown.stdout)
        several = self.run_tool("walk.bvh", "unitree", "-o", "x.csv")
        self.assert_fails(several, 4, "unitree_g1, unitree_g1_with_hands, unitree_h1")

    def test_a_batch_is_the_same_by_either_name(self):
        self.write("in/walk.bvh", sample("wave").read_bytes())
        self.assert_done(self.run_tool("batch", "in", "-o", "out", "--robot", "unitree_g1"))
        again = self.run_tool("batch", "in", "-o", "out", "--robot", "g1", "--resume")
        self.assert_done(again)
        self.assertIn("1 of 1 are done", again.stderr)
        self.assert_done(self.run_tool("batch", "in", "-o", "two", "--robot", "g1,t1"))
        self.assertTrue((self.folder / "two" / "unitree_g1" / "walk.csv").exists())
        self.assertTrue((self.folder / "two" / "booster_t1" / "walk.csv").exists())

    def test_extra_words_are_errors(self):
        self.write("wave.bvh", sample("wave").read_bytes())
        for words in (("walk.bvh", "wave.bvh"), ("walk.bvh", "--bvh", "wave.bvh")):
            self.assert_fails(self.run_tool(*words, "-o", "x.csv"), 2, "two motions", "wave.bvh",
                              "batch")
        self.assert_fails(self.run_tool("walk.bvh", "wave.bvh", "g1", "-o", "x.csv"), 2,
                          "unexpected g1", "batch")
        self.assert_fails(self.run_tool("walk.bvh", "g1", "--robot", "t1", "-o", "x.csv"), 2,
                          "two robots", "g1", "t1")
        self.assert_fails(self.run_tool("frobnicate", "walk.bvh", "-o", "x.csv"), 2,
                          '"frobnicate" is not a command, a motion file or a robot')


class Mistakes(ToolTest):
    def test_mistyped_commands(self):
        for words, meant in ((("evalute", "x.csv", "--gate", "none"), "evaluate"),
                             (("help", "evalute"), "evaluate"), (("inspct", "x.bvh"), "inspect"),
                             (("robot", "list"), "robots"), (("edit", "pth", "x.bvh"), "path"),
                             (("robots", "lst"), "list"), (("help", "edit", "concta"), "concat")):
            self.assert_fails(self.run_tool(*words), 2, f'did you mean "{meant}"?')

    def test_a_file_is_not_a_mistyped_command(self):
        self.write("edits", sample("wave").read_bytes())
        self.assert_done(self.run_tool("edits", "g1", "-o", "x.csv"))

    def test_help_of_every_command(self):
        for command in (*((name,) for name in COMMANDS), ("edit", "path"), ("robots", "add")):
            asked, shown = self.run_tool("help", *command), self.run_tool(*command, "--help")
            self.assert_done(asked)
            self.assertEqual(asked.stdout, shown.stdout)
            self.assertIn("retarget " + " ".join(command), asked.stdout)
            for line in asked.stdout.splitlines():
                self.assertLessEqual(len(line), 80, line)
        self.assertEqual(self.run_tool("help").stdout, self.run_tool("--help").stdout)
        self.assertIn("  help ", self.run_tool("--help").stdout)
        self.assert_fails(self.run_tool("help", "walk"), 2, '"walk"')

    def test_short_help_fits_a_screen(self):
        for command in ((), *((name,) for name in COMMANDS), ("edit", "path")):
            short = self.run_tool(*command, "--help").stdout
            self.assertLessEqual(len(short.splitlines()), 60, command)
            whole = self.run_tool(*command, "--help-all").stdout
            self.assertIn("--quiet" if command not in (("edit",), ("robots",)) else "--help", whole)
            for line in whole.splitlines():
                self.assertLessEqual(len(line), 80, line)
        self.assertIn("--tpose-file", self.run_tool("--help-all").stdout)
        self.assertIn("Examples:", self.run_tool("batch", "--help").stdout)
        self.assertIn("Examples:", self.run_tool("--help").stdout)

    def test_the_page_of_options_is_that_of_this_tool(self):
        made = self.run_tool("generate", "options")
        self.assert_done(made)
        page = (SOURCE / "docs" / "options.md").read_text()
        self.assertEqual(made.stdout, page, "retarget generate options > docs/options.md")

    def test_a_name_has_one_meaning_in_all_commands(self):
        """Checks the value type of each name: a flag, a file, seconds, a choice."""
        kinds = {}
        for line in self.run_tool("generate", "options").stdout.splitlines():
            row = re.match(r"\| `--([a-z0-9-]+)`[^|]* \| ((?:\\\||[^|])*) \|", line)
            if row:
                kinds.setdefault(row[1], set()).add(OPTION_KINDS.get(row[2].strip(), row[2].strip()))
        self.assertGreater(len(kinds), 100)
        several = {name: found for name, found in kinds.items() if len(found) > 1}
        self.assertEqual(several, NAMES_OF_SEVERAL_KINDS)

    def test_scripts_of_shells_are_sound(self):
        for shell in ("bash", "zsh", "fish"):
            script = self.run_tool("generate", shell)
            self.assert_done(script)
            for word in ("--tpose-file" if shell == "bash" else "tpose-file", "fit gmr", "batch"):
                self.assertIn(word, script.stdout)
            program = shutil.which(shell)
            if program is None:
                continue
            checked = subprocess.run([program, "-n"], input=script.stdout, text=True,
                                     capture_output=True, timeout=60)
            self.assertEqual((checked.returncode, checked.stderr), (0, ""), shell)
        for shell, texts in (("zsh", (r"robot'\''s", r"udp\:PORT")), ("fish", (r"robot\'s", "udp:PORT"))):
            script = self.run_tool("generate", shell).stdout
            for text in (*texts, "retarget robots list", "zsh fish man options robot-pack"):
                self.assertIn(text, script, shell)
        page = self.run_tool("generate", "man")
        self.assertIn(".SH EXIT STATUS", page.stdout)

    def test_bash_completes(self):
        bash = shutil.which("bash")
        if bash is None:
            self.skipTest("bash is missing")
        self.write("complete.sh", self.run_tool("generate", "bash").stdout)

        def completed(*words):
            asked = " ".join(f"'{word}'" for word in ("retarget", *words))
            line = (f". ./complete.sh; COMP_WORDS=({asked}); COMP_CWORD={len(words)}; _retarget {shlex.quote(TOOL)}; "
                    'printf "%s\\n" "${COMPREPLY[@]}"')
            return subprocess.run([bash, "-c", line], cwd=self.folder, text=True, timeout=60,
                                  capture_output=True, env=self.tool_environment()).stdout.splitlines()

        self.assertEqual(completed("--method", ""), ["fit", "gmr"])
        self.assertEqual(completed("--tpose-fr"), ["--tpose-frame"])
        self.assertIn("--clip-timeout", completed("batch", "--cl"))
        self.assertIn("concat", completed("edit", "conc"))
        self.assertIn("--search", completed("edit", "concat", "--sea"))
        self.assertIn("complete.sh", completed("--map", "comp"))
        self.assertIn("unitree_g1", completed("--robot", "unitree_"))
        self.assertEqual(completed("edit", "rest", "--from-robot", "booster_k"), ["booster_k1"])
        self.assertEqual(completed("batch", "--format", "npz-m"), ["npz-mjlab"])
        self.assertEqual(completed("generate", "rob"), ["robot-pack"])
        self.assertEqual(completed("help", "simu"), ["simulate"])
        self.assertEqual(completed("robots", "check", "booster_k"), ["booster_k1"])
        self.write("my walk.bvh", "")
        self.write("a *", "")
        for words in (("my",), ("--bvh", "my"), ("inspect", "my")):
            self.assertEqual(completed(*words), ["my walk.bvh"])
        self.assertEqual(completed("--bvh", "a"), ["a *"])

    def test_hints_name_the_help_of_the_command(self):
        for words in (("evaluate", "x.csv", "--no-such"), ("evaluate", "x.csv", "--fps"),
                      ("evaluate", "x.csv", "--robot")):
            self.assert_fails(self.run_tool(*words), 2, "hint: retarget evaluate --help")
        self.assert_fails(self.run_tool("edit", "trim", "x.bvh", "-o", "y.bvh", "--no-such"), 2,
                          "hint: retarget edit trim --help")
        self.assert_fails(self.run_tool("--no-such"), 2, "hint: retarget --help")

    def hint_of(self, words, option):
        """The hint of an error about an option: it names the help page that lists it."""
        command = words[:2] if words[0] in ("edit", "robots") else words[:1] if words[0] in COMMANDS else ()
        short = self.run_tool(*command, "--help").stdout
        page = "--help" if re.search(rf"^  (-\w,)?{option}\b", short, re.M) else "--help-all"
        return " ".join(("hint: retarget", *command, page, "lists the options"))

    def test_hints_name_the_help_that_lists_the_option(self):
        run = ("walk.bvh", "g1", "-o", "x.csv")
        for words, option in (((*run, "--gat", "x"), "--gate"), ((*run, "--fps"), "--fps"),
                              ((*run, "--widow", "3"), "--window"), ((*run, "--window"), "--window"),
                              (("batch", "a", "-o", "b", "--robot-xml"), "--robot-xml"),
                              (("edit", "trim", "x.bvh", "-o", "y.bvh", "--strat", "1"), "--start"),
                              (("edit", "trim", "x.bvh", "-o", "y.bvh", "--take"), "--take")):
            self.assert_fails(self.run_tool(*words), 2, option, self.hint_of(words, option))
        # No option is near.
        self.assert_fails(self.run_tool(*run, "--no-such"), 2, "retarget --help-all lists")

    def test_numbers_of_values(self):
        self.write("walk.bvh", short_clip("wave", 2))
        run = ("walk.bvh", "g1", "-o", "x.csv")
        for words, message in (
                ((*run, "--mirror=maybe"), '--mirror: expected no value, true or false, found "maybe"'),
                ((*run, "--mirror=2"), '--mirror: expected no value, true or false, found "2"'),
                ((*run, "--quiet=x"), '--quiet: expected no value, true or false, found "x"'),
                (("evaluate", "x.csv", "--all=maybe"), '--all: expected no value, true or false, found "maybe"'),
                (("batch", "in", "-o", "out", "--resume=1e5"), '--resume: expected no value, true or false, found "1e5"'),
                (("inspect", "walk.bvh", "--json=0.5"), '--json: expected no value, true or false, found "0.5"'),
                ((*run, "--fps", "50", "--fps", "30"), "--fps is given more than once"),
                ((*run, "--fps="), "--fps needs a value"),
                ((*run, "--fps"), "--fps needs a value")):
            option = re.match(r"--\w+", message).group()
            self.assert_fails(self.run_tool(*words), 2, f"error: {message}", self.hint_of(words, option))
        self.assertEqual(self.files(), ["walk.bvh"])

    def test_all_missing_arguments_are_reported_together(self):
        for words, missing in (
                ((), "no motion file, no robot and no output are given"),
                (("walk.bvh",), "no robot and no output are given"),
                (("g1",), "no motion file and no output are given"),
                (("walk.bvh", "g1"), "no output is given"),
                (("--robot-xml", "x.xml"), "no motion file, no output and no retargeting configuration are given"),
                (("evaluate",), "no motions and no robot are given"),
                (("convert",), "no input, no robot and no output are given"),
                (("compare",), "no motion files are given"),
                (("compare",), "the two motion files to compare"),
                (("compare", "x.csv"), "no second motion file is given"),
                (("batch",), "no motion files, no output and no robot are given"),
                (("batch", "in", "--robot", "g1"), "no output is given"),
                (("edit", "trim"), "no file and no output are given"),
                (("edit", "rest"), "no file, no --like and no output are given"),
                (("robots", "add"), "no name and no --model are given"),
                (("edit",), "retarget edit needs one of the commands rest, transfer")):
            self.assert_fails(self.run_tool(*words), 2, missing)
        # A merge has neither clips nor a robot.
        self.assert_fails(self.run_tool("batch", "--merge", "-o", "none"), 2, '"none" is not the output')

    def test_folder_instead_of_a_file(self):
        (self.folder / "clips").mkdir()
        for words in (("clips", "g1", "-o", "x.csv"), ("clips",), ("inspect", "clips"),
                      ("--bvh", "clips", "--robot", "g1", "-o", "x.csv"),
                      ("edit", "trim", "clips", "--start", "1", "-o", "x.bvh")):
            self.assert_fails(self.run_tool(*words), 3, "clips", "directory", "retarget batch clips")
        for words in (("evaluate", "clips"), ("convert", "clips", "x.csv"),
                      ("compare", "clips", "clips")):
            self.assert_fails(self.run_tool(*words, "--robot", "g1"), 3, "clips", "directory",
                              "clips/*.csv", "retarget batch")

    def test_a_rate_without_effect(self):
        of_npz = ("--frames", ":30", "--format", "npz-mjlab")
        self.assert_fails(self.retarget(*of_npz, "--fps", "60", bvh=sample("wave"), output="x.npz"), 2,
                          "--fps has no effect on npz-mjlab", "--npz-fps N")
        self.assert_done(self.retarget(*of_npz[:3], "npz-mjlab,csv", "--fps", "60", bvh=sample("wave"), output="x"))
        self.assert_done(self.retarget(*of_npz, "--fps", "60", "--method", "gmr", bvh=sample("wave"), output="x.npz"))

    def test_files_in_folders(self):
        (self.folder / "clips").mkdir()
        self.write("x.csv", "1\n")
        self.assert_fails(self.run_tool("verify", "clips"), 3, "found a directory", "walk.csv.json")
        for words in (("compare", "x.csv", "clips"), ("compare", "clips", "x.csv")):
            self.assert_fails(self.run_tool(*words), 3, "directory", "hint: give a file in it")
        model = ("--ik-config", "derived", "--bvh", sample("wave"), "-o", "x.csv", "--robot-xml")
        self.assert_fails(self.run_tool(*model, "clips"), 4, "clips", "found a directory", "MJCF")
        robot = SOURCE / "robots" / "unitree_g1"
        self.assert_fails(self.run_tool(*model, robot), 4, "found a directory", f"--robot {robot}",
                          "model.xml")
        self.assert_fails(self.run_tool("evaluate", "x.csv", "--robot-xml", "clips"), 4,
                          "found a directory")

    def test_a_robot_without_its_option(self):
        self.write("g.csv", "1\n")
        for words in (("evaluate", "g.csv", "g1"), ("convert", "g.csv", "y.csv", "g1"),
                      ("convert", "g.csv", "g1"), ("compare", "g.csv", "y.csv", "g1"),
                      ("convert", "g.csv", "y.csv", "g1", "--data-dir", SOURCE)):
            self.assert_fails(self.run_tool(*words), 2, "did you mean --robot g1?")
        for words in (("evaluate", "g.csv"), ("convert", "g.csv", "y.csv", "z.csv"),
                      ("convert", "g.csv", "y.csv", "g1", "--robot", "t1"),
                      ("evaluate", "g.csv", "nothing.csv")):
            result = self.run_tool(*words)
            self.assertEqual(result.returncode, 2)
            self.assertNotIn("did you mean", result.stderr)

    def test_hints_can_be_followed(self):
        model = SOURCE / "robots" / "unitree_g1" / "model.xml"
        line = ("--bvh", sample("wave"), "--robot-xml", model, "-o", "x.csv", "--frames", "0:3")
        failed = self.run_tool(*line, "--ik-config", "published")
        self.assert_fails(failed, 4, "--ik-config derived", "--ik-config FILE")
        self.assertNotIn("omit", failed.stderr)
        self.assert_done(self.run_tool(*line, "--ik-config", "derived"))

    def test_whole_clip_search_is_reported_without_seconds(self):
        # A clip of lying for a second and a third has no pose in common with a walk.
        self.write("lying.bvh", short_clip("get_up", 40))
        refused = self.run_tool("edit", "concat", "lying.bvh", sample("wave"), "-o", "x.bvh")
        self.assert_fails(refused, 1, "does not fit lying.bvh anywhere that enough",
                          "--force")
        self.assertNotIn("--search", refused.stderr)
        near = self.run_tool("edit", "concat", "lying.bvh", sample("wave"), "--search", "0.2", "-o",
                             "x.bvh")
        self.assert_fails(near, 1, "within 0.2 s", "--search all")


if __name__ == "__main__":
    unittest.main()
