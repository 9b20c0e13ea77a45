"""Results do not depend on the processor: glibc picks other sin, cos and atan2 where it has FMA."""

import os
import platform
import unittest

from tool import SAMPLES, ToolTest, sample

# glibc's names; it ignores names that the processor or version lacks.
OLD_PROCESSOR = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX,-AVX2,-AVX2_Usable,-FMA_Usable,-FMA4_Usable"


@unittest.skipUnless(platform.libc_ver()[0] == "glibc" and platform.machine() == "x86_64",
                     "only glibc on x86-64 can hide features of the processor")
class AnyProcessor(ToolTest):
    def both(self, name, *arguments):
        """Compares output of this processor with that of one without FMA."""
        texts = []
        for environment in (None, dict(os.environ, GLIBC_TUNABLES=OLD_PROCESSOR)):
            result = self.retarget("--quiet", *arguments, bvh=sample(name), output="-",
                                   env=environment)
            self.assert_done(result)
            texts.append(result.stdout)
        return texts

    def test_without_fma_the_same_bytes(self):
        for name in SAMPLES:
            for options in ((), ("--fps", "24"), ("--normalize-start",)):
                with self.subTest(sample=name, options=options):
                    # All digits.
                    self.assertEqual(*self.both(name, "--precision", 17, *options))


if __name__ == "__main__":
    unittest.main()
