"""
What the real Mitsuba makes of exported plugins: reads a job as JSON from standard input, writes what
it found as JSON to standard output. The job names a variant and steps, each of one plugin.
"""

import contextlib
import importlib.util
import json
import sys

import drjit as dr
import llvm
import mitsuba as mi
import numpy as np


def bsdf(path):
    """The BSDF of a plugin file, registered with the current variant."""
    spec = importlib.util.spec_from_file_location("plugin", path)
    plugin = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(plugin)
    plugin.register()
    return plugin.NAME, mi.load_dict({"type": plugin.NAME})


def interaction(wi):
    si = dr.zeros(mi.SurfaceInteraction3f, 1 if mi.variant().startswith("scalar") else dr.width(wi))
    si.wi = wi
    return si


def numbers(value):
    """A list of what may be a number or an array of one."""
    return [float(v) for v in value] if hasattr(value, "__len__") else [float(value)]


def vectors(directions):
    """Directions as Mitsuba takes them: one by one in scalar variants, all at once in others."""
    if mi.variant().startswith("scalar"):
        return [mi.Vector3f(direction) for direction in directions]
    return [mi.Vector3f([mi.Float(column) for column in zip(*directions)])]


def points(path, wi, wo, wavelengths=()):
    """
    f_r cos theta of the channels and the density, from `eval` and `pdf` and from `eval_pdf`. In
    spectral variants the channels are those of the wavelengths, in nm.
    """
    _, material = bsdf(path)
    ctx, found = mi.BSDFContext(), {"channels": [[] for _ in mi.Spectrum(0)], "pdf": []}
    for source, view in zip(vectors(wi), vectors(wo)):
        si = interaction(source)
        if mi.is_spectral:
            si.wavelengths = mi.Spectrum(wavelengths)
        value, pdf = material.eval(ctx, si, view), material.pdf(ctx, si, view)
        both = material.eval_pdf(ctx, si, view)
        assert dr.all(dr.all(both[0] == value) & (both[1] == pdf))
        for channel, values in zip(found["channels"], value):
            channel += numbers(values)
        found["pdf"] += numbers(pdf)
    return found


def context(component):
    ctx = mi.BSDFContext()
    if component is not None:
        ctx.component = component
    return ctx


def chi2(path, pdf_of, wi, component, tests, seed):
    """
    Mitsuba's chi-square test of `sample` against the `pdf` of the same plugin, or of another one.
    """
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    def functions(path):
        name, _ = bsdf(path)
        return BSDFAdapter(name, "", wi=wi, ctx=context(component))

    test = ChiSquareTest(
        domain=SphericalDomain(),
        sample_func=functions(path)[0],
        pdf_func=functions(pdf_of)[1],
        sample_dim=3,
        ires=16,
        seed=seed,
    )
    accepted = bool(test.run(0.01, tests, quiet=True))
    return {"accepted": accepted, "p": float(test.p_value), "words": test.messages}


def weights(path, wi, count, component):
    """The mean of the weights of samples, of each channel, and its standard error."""
    _, material = bsdf(path)
    sampler = mi.load_dict({"type": "independent"})
    scalar = mi.variant().startswith("scalar")
    sampler.seed(1, 1 if scalar else count)
    si, ctx = interaction(mi.Vector3f(wi)), context(component)
    drawn = []
    for _ in range(count if scalar else 1):
        _, weight = material.sample(ctx, si, sampler.next_1d(), sampler.next_2d())
        drawn.append(np.reshape(np.array(weight), (3, -1)))
    drawn = np.concatenate(drawn, axis=1)
    error = drawn.std(axis=1) / count**0.5
    return {"mean": drawn.mean(axis=1).tolist(), "error": error.tolist()}


def picture(path, parts):
    """
    The size of a picture in pixels, whether all of it are numbers, and the mean red, green and blue
    of parts of it: left, top, right and bottom as fractions of a side.
    """
    values = np.array(mi.Bitmap(path), dtype=float)
    height, width, _ = values.shape

    def mean(left, top, right, bottom):
        rows = slice(int(top * height), int(bottom * height))
        columns = slice(int(left * width), int(right * width))
        return values[rows, columns].mean(axis=(0, 1)).tolist()

    return {
        "size": [width, height],
        "finite": bool(np.isfinite(values).all()),
        "means": [mean(*part) for part in parts],
    }


# The shapes of the viewer and the cameras that look at them: a ball from far away, and a plate at a small angle from
# above, in a picture that is twice as wide as high.
BODIES = {
    "ball": (
        {"type": "sphere"},
        {"type": "orthographic", "to_world": {"origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0]}},
    ),
    "plate": (
        {"type": "rectangle", "to_world": [0.95, 1.6, 1]},
        {
            "type": "perspective",
            "fov": float(np.degrees(2 * np.arctan(0.28))),
            "to_world": {"origin": [0, -5, 1.34], "target": [0, 0, 0], "up": [0, 0, 1]},
        },
    ),
}


def surface(path, body, size, lamp, irradiance, sky, spp, pictures):
    """
    The mean of pictures of a body, its standard error, and how much of each pixel the body covers: red, green and blue
    of each pixel, row by row. The light comes from a direction and from all around.
    """
    name, _ = bsdf(path)
    transform = mi.ScalarTransform4f()
    shape, sensor = (dict(part) for part in BODIES[body])
    if "to_world" in shape:
        shape["to_world"] = transform.scale(shape["to_world"])
    sensor["to_world"] = transform.look_at(**sensor["to_world"])
    emitters = {}
    if irradiance > 0:
        emitters["lamp"] = {
            "type": "directional",
            "direction": [-x for x in lamp],
            "irradiance": {"type": "rgb", "value": irradiance},
        }
    if sky > 0:
        emitters["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": sky}}
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2, "hide_emitters": True},
        "sensor": {
            **sensor,
            "film": {
                "type": "hdrfilm",
                "width": size[0],
                "height": size[1],
                "pixel_format": "rgba",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent"},
        },
        "body": {**shape, "bsdf": {"type": name}},
        **emitters,
    })
    drawn = [np.array(mi.render(scene, spp=spp, seed=seed), dtype=float) for seed in range(pictures)]
    mean, error = np.mean(drawn, axis=0), np.std(drawn, axis=0, ddof=1) / pictures**0.5
    return {
        "mean": mean[..., :3].ravel().tolist(),
        "error": error[..., :3].ravel().tolist(),
        "covered": mean[..., 3].ravel().tolist(),
    }


STEPS = {"points": points, "chi2": chi2, "weights": weights, "picture": picture, "surface": surface}


def main():
    job = json.load(sys.stdin)
    if job["variant"].startswith("llvm") and not llvm.usable():
        return json.dump(None, sys.stdout)
    mi.set_variant(job["variant"])
    with contextlib.redirect_stdout(sys.stderr):
        found = [STEPS[step.pop("do")](**step) for step in job["steps"]]
    json.dump(found, sys.stdout)


main()
