import argparse
import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import math


class Lobe:
    def __init__(self, family, k2, kd, k1, n, p, weights):
        self.family, self.k2, self.kd, self.k1, self.n, self.p = family, k2, kd, k1, n, p
        self.weights = weights
        self.k1_2 = k1 * k1
        L = math.log(self.k1_2)
        if family in ("paper", "smith", "power"):
            s = 1 - p
            mean = 1.0 if L == 0 else (L if s == 0 else math.expm1(s * L) / s) / (self.k1_2 - 1)
            self.peak = 1 / (math.pi * math.exp(p * L) * mean)
        else:
            self.peak = 1 / (math.pi * self.k1_2)

    def pair(self, wi, wo):
        s, d = wi + wo, wi - wo
        scale = 0.5 * dr.dot(d, s)
        hx = 0.5 * (s.x + scale * wo.x)
        hy = 0.5 * (s.y + scale * wo.y)
        across2 = hx * hx + hy * hy
        cos_theta = wo.z + scale * wo.z
        along = 0.5 * (wi.z + cos_theta)
        length2 = along * along + across2
        return wi.z, cos_theta, across2, along, length2, dr.sqrt(length2)

    def facet(self, pair):
        _, _, across2, along, length2, length = pair
        k1_2 = self.k1_2
        along2 = along * along
        if self.family in ("paper", "smith"):
            return along * length / (across2 / k1_2 + along2)
        if self.family == "ggx":
            q = k1_2 * length2 / (k1_2 * along2 + across2)
            return q * q
        if self.family == "beckmann":
            return dr.exp(-across2 / along2 / k1_2) * dr.square(length2 / along2)
        denominator = k1_2 * along2 + across2
        excess = (k1_2 - 1) * (across2 / denominator)
        fraction = k1_2 * length2 / denominator
        near = dr.abs(excess) < 0.5
        fraction = dr.select(near, 1 + excess, fraction)
        rest = (excess - (fraction - 1)) / fraction
        return dr.exp(self.p * (dr.log(fraction) + dr.select(near, rest, 0))) * along / length

    def specular(self, wi, wo):
        pair = self.pair(wi, wo)
        cos_psi, cos_theta, across2, along, length2, length = pair
        n2 = self.n * self.n - 1
        total = dr.sqrt(n2 + length2) + length
        square = n2 + 2 * length * total
        b = (length * square - total) / (length * n2 + total)
        q = (self.n + 1) ** 2 / square
        fresnel = 0.5 * q * q * (1 + b * b)
        if self.family in ("smith", "ggx"):
            side = lambda c: c + dr.sqrt(c * c + self.k1_2 * ((1 - c) * (1 + c)))
            shadowing = 4 / (side(cos_psi) * side(cos_theta))
        else:
            along2 = along * along
            shadowing = along2 / dr.maximum(along2 * (cos_psi * cos_theta),
                0.25 * (cos_psi + cos_theta) * length2 * dr.maximum(cos_psi, cos_theta))
        return self.k2 / math.pi * self.facet(pair) * fresnel * shadowing

    def specular_density(self, wi, wo):
        pair = self.pair(wi, wo)
        _, _, _, along, _, length = pair
        density = self.peak * self.facet(pair)
        if self.family in ("ggx", "beckmann"):
            density *= along / length
        return density / (4 * length)

    def tan2(self, u):
        L = math.log(self.k1_2)
        if self.family == "ggx":
            return self.k1_2 * (u / (1 - u))
        if self.family == "beckmann":
            return -self.k1_2 * dr.log(1 - u)
        if L == 0:
            return u / (1 - u)
        s = 1 - self.p
        if s == 0:
            a, b = -u * L, (1 - u) * L
        else:
            a = dr.log(1 + u * math.expm1(-s * L)) / s
            b = dr.log(1 + (1 - u) * math.expm1(s * L)) / s
        return self.k1_2 * ((dr.exp(a) - 1) / (1 - dr.exp(b)))

    def mirrored(self, wi, u, v):
        t = self.tan2(u)
        c = dr.rsqrt(1 + t)
        s = dr.sqrt(t) * c
        sin, cos = dr.sincos(2 * math.pi * v)
        m = mi.Vector3f(s * cos, s * sin, c)
        return 2 * dr.dot(wi, m) * m - wi

    def specular_weight(self, cos_psi):
        x = 16 * dr.sqrt(cos_psi)
        return sum(w * dr.maximum(0, 1 - dr.abs(x - i)) for i, w in enumerate(self.weights))


def _value(self, wi, wo, glossy, diffuse):
    f = mi.Float(0)
    if glossy: f = f + self.specular(wi, wo)
    if diffuse: f = f + self.kd / math.pi
    return f
Lobe.value = _value
_m = Lobe.mirrored
Lobe.mirrored = lambda self, wi, uv: _m(self, wi, uv.x, uv.y)
