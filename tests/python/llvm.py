"""Whether Mitsuba's LLVM variants run here; exits with 1 where they do not."""

import subprocess
import sys

# In a process of its own: where LLVM is too old for the code of Dr.Jit, LLVM aborts the process.
PROBE = """
import drjit as dr, mitsuba as mi
mi.set_variant("llvm_ad_rgb")
dr.eval(dr.minimum(mi.Float(1, 2), 1.5))
"""


def usable():
    return subprocess.run([sys.executable, "-c", PROBE], capture_output=True).returncode == 0


if __name__ == "__main__":
    sys.exit(0 if usable() else 1)
