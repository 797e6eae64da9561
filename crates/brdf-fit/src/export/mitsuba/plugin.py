GLOSSY, DIFFUSE = 0, 1  # The components of the BSDF.
UP = (0, 0, 1)


def parts(ctx):
    """Whether the glossy and the diffuse component are enabled."""
    return (
        ctx.is_enabled(mi.BSDFFlags.GlossyReflection, GLOSSY),
        ctx.is_enabled(mi.BSDFFlags.DiffuseReflection, DIFFUSE),
    )


def above(wi, wo, active):
    """Where both directions are above the surface; elsewhere the directions are replaced by UP."""
    active = active & (wi.z > 0) & (wo.z > 0)
    up = mi.Vector3f(UP)
    return active, dr.select(active, wi, up), dr.select(active, wo, up)


def spectrum(values, wavelengths):
    """
    The values of red, green and blue as a spectrum of the variant: in monochrome their luminance;
    in spectral variants they apply at the dominant wavelengths of the sRGB primaries, with linear
    interpolation between them and constant continuation.
    """
    red, green, blue = values
    if mi.is_rgb:
        return mi.Spectrum(red, green, blue)
    if mi.is_monochromatic:
        return mi.Spectrum(0.212671 * red + 0.715160 * green + 0.072169 * blue)
    to_green = dr.clip((wavelengths - 464) / (549 - 464), 0, 1)
    to_red = dr.clip((wavelengths - 549) / (611 - 549), 0, 1)
    return blue + to_green * (green - blue) + to_red * (red - green)


def brdf(lobe, ctx, wi, wo):
    """f_r of the enabled components, in 1/sr."""
    glossy, diffuse = parts(ctx)
    if glossy and diffuse:
        return lobe.value(wi, wo)
    if glossy:
        return lobe.value(wi, wo) - lobe.lambertian
    return mi.Float(lobe.lambertian if diffuse else 0)


def eval_cos(ctx, si, wo, active):
    """f_r cos theta, in 1/sr; 0 below the surface."""
    active, wi, wo = above(si.wi, wo, active)
    values = {lobe: brdf(lobe, ctx, wi, wo) for lobe in LOBES}
    f_r = spectrum([values[lobe] for lobe in CHANNELS], si.wavelengths)
    return dr.select(active, f_r * wo.z, 0)


def shares(lobe, ctx, wi):
    """The probabilities of drawing from the glossy and from the diffuse component."""
    glossy, diffuse = parts(ctx)
    weight = lobe.specular_weight(wi.z)
    if glossy and diffuse:
        return weight, 1 - weight
    # Without a glossy component (weight 0) none is drawn from it.
    return dr.select(weight > 0, mi.Float(glossy), 0), mi.Float(diffuse)


def density(ctx, si, wo, active):
    """The density of the directions that are drawn, in 1/sr: the mean of those of the lobes."""
    active, wi, wo = above(si.wi, wo, active)
    total = mi.Float(0)
    for lobe in LOBES:
        facets, cosine = shares(lobe, ctx, wi)
        total += facets * lobe.mirrored_density(wi, wo) + cosine * wo.z / dr.pi
    return dr.select(active, total / len(LOBES), 0)


def draw(ctx, wi, choice, uv):
    """
    A direction for wi, and whether it is drawn from the glossy component. The integer part of
    choice * len(LOBES) chooses the lobe, the fractional part the component.
    """
    wo, glossy = mi.Vector3f(UP), mi.Mask(False)
    for i, lobe in enumerate(LOBES):
        left = choice * len(LOBES) - i
        facets, cosine = shares(lobe, ctx, wi)
        # The lobe draws from the glossy component if the number is below its weight; 1 never is.
        from_facets = left < facets
        drawn = lobe.draw(wi, (dr.select(from_facets, 0.0, 1.0), uv.x, uv.y))
        wo = dr.select(left >= 0, mi.Vector3f(*drawn), wo)
        glossy = dr.select(left >= 0, from_facets, glossy)
    return wo, glossy


def register():
    """Registers the material as a BSDF of the type NAME, in the current variant of Mitsuba."""
    if mi.is_polarized:
        raise RuntimeError(f"{NAME}: the model has no polarisation: expected another variant")

    class Coating(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            front = mi.BSDFFlags.FrontSide
            self.m_components = [
                mi.BSDFFlags.GlossyReflection | front,
                mi.BSDFFlags.DiffuseReflection | front,
            ]
            self.m_flags = self.m_components[GLOSSY] | self.m_components[DIFFUSE]

        def eval(self, ctx, si, wo, active=True):
            return eval_cos(ctx, si, wo, active)

        def pdf(self, ctx, si, wo, active=True):
            return density(ctx, si, wo, active)

        def eval_pdf(self, ctx, si, wo, active=True):
            return eval_cos(ctx, si, wo, active), density(ctx, si, wo, active)

        def sample(self, ctx, si, sample1, sample2, active=True):
            active, wi, _ = above(si.wi, mi.Vector3f(UP), active)
            bs = dr.zeros(mi.BSDFSample3f)
            bs.wo, glossy = draw(ctx, wi, sample1, sample2)
            bs.pdf = density(ctx, si, bs.wo, active)
            bs.eta = 1
            bs.sampled_component = dr.select(glossy, mi.UInt32(GLOSSY), mi.UInt32(DIFFUSE))
            bs.sampled_type = dr.select(
                glossy,
                mi.UInt32(+mi.BSDFFlags.GlossyReflection),
                mi.UInt32(+mi.BSDFFlags.DiffuseReflection),
            )
            active = bs.pdf > 0
            weight = eval_cos(ctx, si, bs.wo, active) / dr.select(active, bs.pdf, 1)
            return bs, weight

        def to_string(self):
            return f"{NAME}[]"

    mi.register_bsdf(NAME, Coating)


def choose_variant(variant):
    """Sets a variant of Mitsuba: by default llvm_ad_rgb, or scalar_rgb without LLVM."""
    if variant is None:
        variant = "llvm_ad_rgb" if dr.has_backend(dr.JitBackend.LLVM) else "scalar_rgb"
        if variant == "scalar_rgb":
            print("no LLVM found (DRJIT_LIBLLVM_PATH): scalar_rgb, which is slow", file=sys.stderr)
    mi.set_variant(variant)


def main():
    beside = Path(__file__)
    parser = argparse.ArgumentParser(description="Renders a scene with the material.")
    add = parser.add_argument
    add("scene", nargs="?", default=beside.with_suffix(".xml"), help="scene [FILE.xml]")
    add("output", nargs="?", default=beside.with_suffix(".png"), help="picture [FILE.png]")
    add("--spp", type=int, default=0, help="samples per pixel [those of the scene]")
    add("--size", type=int, help="pixels per side, for scenes with the parameter $size")
    add("--variant", help="variant of Mitsuba [llvm_ad_rgb, or scalar_rgb without LLVM]")
    arguments = parser.parse_args()
    choose_variant(arguments.variant)
    register()
    size = {} if arguments.size is None else {"size": arguments.size}
    scene = mi.load_file(str(arguments.scene), **size)
    picture = mi.render(scene, spp=arguments.spp)
    mi.util.write_bitmap(str(arguments.output), picture, write_async=False)
    print(f"written: {arguments.output}")


if __name__ == "__main__":
    main()
