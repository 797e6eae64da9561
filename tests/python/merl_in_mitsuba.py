"""
A MERL table as the real Mitsuba sees it: reads a job as JSON from standard input, the path of a
table, bins of theta_h, theta_d and phi_d, and pairs of directions, and writes as JSON f_r of red,
green and blue, in 1/sr; null where there is no LLVM that Dr.Jit can use.

Mitsuba reads no MERL tables, but `measured_polarized` has tables in the same coordinates. The bins
are handed to it in the middle of each, so that it turns directions into half and difference angles.
Of all bins this would take 1 GB.
"""

import contextlib
import json
import struct
import sys
import tempfile
from pathlib import Path

import drjit as dr
import llvm
import mitsuba as mi
import numpy as np

SCALES = np.array([1, 1.15, 1.66]) / 1500
UINT16, FLOAT32 = 3, 10  # Types of the fields of a tensor file.


def read(path):
    """f_r of the channels over theta_h, theta_d and phi_d."""
    shape = np.fromfile(path, "<i4", 3)
    values = np.fromfile(path, "<f8", offset=12).reshape(3, *shape)
    return values * SCALES[:, None, None, None]


def middles(shape):
    """The angles in the middle of the bins."""
    h, d, p = ((np.arange(count) + 0.5) / count for count in shape)
    return h**2 * np.pi / 2, d * np.pi / 2, p * np.pi


def write_tensors(path, fields):
    """
    Mitsuba's tensor file: its name, version and number of fields; of each field the name, number of
    dimensions, type, place and shape; then the fields, each at a multiple of 64 bytes.
    """
    head = 18 + sum(13 + len(name) + 8 * a.ndim for name, _, a in fields)
    offset = (head + 63) // 64 * 64
    index, body = b"tensor_file\0" + struct.pack("<2BI", 1, 0, len(fields)), b""
    for name, kind, a in fields:
        index += struct.pack("<H", len(name)) + name.encode()
        index += struct.pack(f"<HBQ{a.ndim}Q", a.ndim, kind, offset + len(body), *a.shape)
        body += np.ascontiguousarray(a).tobytes()
        body += bytes(-len(body) % 64)
    Path(path).write_bytes(index.ljust(offset, b"\0") + body)


def material(values, bins, path):
    """Some bins of a channel as a material that does not polarise."""
    theta_h, theta_d, phi_d = (angle[i] for angle, i in zip(middles(values.shape), bins))
    part = np.transpose(values[np.ix_(*bins)], (2, 1, 0))
    # The other half of phi_d is reciprocal.
    phi_d, part = np.concatenate([phi_d - np.pi, phi_d]), np.concatenate([part, part])
    # The same for each wavelength.
    wavelengths = np.array([450, 500, 550, 600, 650], np.uint16)
    mueller = np.zeros((*part.shape, 5, 4, 4), np.float32)
    mueller[..., 0, 0] = part[..., None]
    axes = [("theta_h", theta_h), ("theta_d", theta_d), ("phi_d", phi_d)]
    fields = [(name, FLOAT32, angles.astype(np.float32)[None]) for name, angles in axes]
    write_tensors(path, fields + [("wvls", UINT16, wavelengths), ("M", FLOAT32, mueller)])
    return mi.load_dict({"type": "measured_polarized", "filename": str(path), "wavelength": 550.0})


def evaluate(path, bins, sources, views):
    wi, wo = np.transpose(sources), np.transpose(views)
    si = dr.zeros(mi.SurfaceInteraction3f, wi.shape[1])
    si.wi = mi.Vector3f(wi)
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for i, values in enumerate(read(path)):
            bsdf = material(values, bins, Path(folder) / f"{i}.pbsdf")
            value = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(wo))
            found.append((np.array(value)[0] / wo[2]).tolist())
    return found


def main():
    job = json.load(sys.stdin)
    if not llvm.usable():
        return json.dump(None, sys.stdout)
    mi.set_variant("llvm_ad_rgb")
    with contextlib.redirect_stdout(sys.stderr):
        found = evaluate(**job)
    json.dump(found, sys.stdout)


main()
