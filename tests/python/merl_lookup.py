"""
A MERL table looked up as the reference code of its database does: reads a job as JSON from standard
input, the path of a table and pairs of directions, and writes as JSON the bins (theta_h, theta_d,
phi_d) that they lie in and f_r of red, green and blue there, in 1/sr.
"""

import json
import sys

import numpy as np

SCALES = np.array([1, 1.15, 1.66]) / 1500


def about_z(v, angle):
    x, y, z = v
    return np.array([x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle), z])


def about_y(v, angle):
    x, y, z = v
    return np.array([z * np.sin(angle) + x * np.cos(angle), y, z * np.cos(angle) - x * np.sin(angle)])


def angles(source, view):
    """
    theta_h, theta_d and phi_d in degrees: the half vector is turned into the plane of x and z, then to
    the normal, and the source with it.
    """
    half = source + view
    half = half / np.linalg.norm(half, axis=0)
    theta_h, phi_h = np.arccos(np.clip(half[2], -1, 1)), np.arctan2(half[1], half[0])
    difference = about_y(about_z(source, -phi_h), -theta_h)
    theta_d = np.arccos(np.clip(difference[2], -1, 1))
    return np.degrees([theta_h, theta_d, np.arctan2(difference[1], difference[0])])


def bins(theta_h, theta_d, phi_d):
    """theta_h in steps that grow with its square; of phi_d, half a turn: the rest is reciprocal."""
    phi_d = np.where(phi_d < 0, phi_d + 180, phi_d)
    found = np.floor([np.sqrt(theta_h * 90), theta_d, phi_d * 2 / 2]).astype(int)
    return np.minimum(found, [[89], [89], [179]])


def main():
    job = json.load(sys.stdin)
    assert np.fromfile(job["path"], "<i4", 3).tolist() == [90, 90, 180]
    channels = np.fromfile(job["path"], "<f8", offset=12).reshape(3, 90, 90, 180)
    found = bins(*angles(np.transpose(job["sources"]), np.transpose(job["views"])))
    values = channels[:, found[0], found[1], found[2]] * SCALES[:, None]
    json.dump({"bins": found.T.tolist(), "channels": values.tolist()}, sys.stdout)


main()
