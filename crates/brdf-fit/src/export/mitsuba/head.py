"""
A fitted BRDF for Mitsuba 3: a BSDF plugin, and a program that renders a scene with it.

    python FILE [SCENE.xml] [PICTURE.png] [--spp N] [--size N] [--variant VARIANT]

By default it renders the scene FILE.xml to the picture FILE.png. In other programs:

    mitsuba.set_variant("llvm_ad_rgb")
    FILE.register()
    mitsuba.load_dict({"type": "@NAME@"})        or <bsdf type="@NAME@"/> in a scene
"""

import argparse
import sys
from collections import namedtuple
from pathlib import Path

import drjit as dr
import mitsuba as mi

NAME = "@NAME@"

# The BRDF of a colour: f_r in 1/sr, its Lambertian part, and how directions are drawn.
Lobe = namedtuple("Lobe", "value lambertian specular_weight mirrored_density draw")
