"""Computes twilight.bin: the clear sky with the sun between +10 and -18 degrees, by spectral scattering in a spherical atmosphere.

Run with numpy and scipy:  python data/twilight.py   (some seconds). What the file holds stands in SOURCES.md.

Single scattering of sunlight by air and aerosol with the earth's shadow (and its penumbra), extinction by air, aerosol and
ozone along both paths, and multiple scattering as an isotropic source of second and higher orders (Hillaire 2020, "A
scalable and production ready sky and atmosphere rendering technique", section 5.5.3). No refraction. 19 wavelengths.
"""

from pathlib import Path

import numpy as np
from scipy.interpolate import RegularGridInterpolator

HERE = Path(__file__).parent
EARTH, TOP = 6371.0, 100.0  # km
SUN_RADIUS = np.radians(0.2667)
LAMBDA = np.arange(380.0, 741.0, 20.0)  # nm
UM = LAMBDA / 1000.0
RAYLEIGH_HEIGHT, AEROSOL_HEIGHT = 8.0, 1.2  # km
AEROSOL_DEPTH_550, AEROSOL_ANGSTROM, AEROSOL_ALBEDO, AEROSOL_G = 0.10, 1.3, 0.92, 0.76
OZONE_CM, GROUND_ALBEDO = 0.30, 0.2

# Grid of the file.
SUN_DEG = np.array([10, 8, 6, 4.5, 3, 2, 1, 0, -1, -2, -3, -4, -5, -6, -7, -8.5, -10, -12, -15, -18.0])
VIEW_SQRT_SIN = np.linspace(0.0, 1.0, 15)  # sqrt of the sine of the view elevation
AZIMUTH_DEG = np.array([0, 8, 16, 26, 38, 55, 75, 100, 130, 155, 180.0])

RAYLEIGH_DEPTH = 0.008569 * UM**-4 * (1 + 0.0113 * UM**-2 + 0.00013 * UM**-4)
RAYLEIGH = RAYLEIGH_DEPTH / RAYLEIGH_HEIGHT  # 1/km at the ground
AEROSOL = AEROSOL_DEPTH_550 * (UM / 0.55) ** -AEROSOL_ANGSTROM / AEROSOL_HEIGHT
_o3 = np.genfromtxt(HERE / "ozone_iqbal1983.csv", delimiter=",", names=True)
OZONE = np.interp(LAMBDA, _o3["wavelength_nm"], _o3["absorption_per_cm"]) * OZONE_CM / 15.0  # 1/km at the layer's middle


def density(h):
    """Air, aerosol, ozone relative to their coefficients above; ozone is a tent from 7 to 37 km."""
    h = np.maximum(h, 0.0)
    return np.stack(
        [np.exp(-h / RAYLEIGH_HEIGHT), np.exp(-h / AEROSOL_HEIGHT), np.maximum(0.0, 1.0 - np.abs(h - 22.0) / 15.0)], -1
    )


COEFFICIENT = np.stack([RAYLEIGH, AEROSOL, OZONE])  # extinction; 3 x wavelengths


def horizon(r):
    return -np.sqrt(np.maximum(0.0, 1.0 - (EARTH / r) ** 2))


def length_to_top(r, mu):
    return -r * mu + np.sqrt(np.maximum(0.0, (EARTH + TOP) ** 2 - r * r * (1 - mu * mu)))


# Columns from height h toward the sun at cosine mu above the horizon: a table over sqrt(h) and the excess over the horizon.
_h = np.linspace(0, 1, 80) ** 2 * TOP
_x = np.linspace(0, 1, 160) ** 2


def _columns():
    h, x = np.meshgrid(_h, _x, indexing="ij")
    r = EARTH + np.maximum(h, 1e-3)
    mu = horizon(r) + x * (1 - horizon(r))
    t = np.linspace(0, 1, 801)
    mid, dt = (t[1:] + t[:-1]) / 2, np.diff(t)
    total = np.zeros(h.shape + (3,))
    length = length_to_top(r, mu)
    for m, d in zip(mid, dt):
        s = m * length
        total += density(np.sqrt(r * r + s * s + 2 * r * s * mu) - EARTH) * (d * length)[..., None]
    return RegularGridInterpolator((np.sqrt(_h / TOP), np.sqrt(_x)), np.log(total + 1e-12), bounds_error=False, fill_value=None)


COLUMNS = _columns()


def sunlight(r, mu):
    """Columns toward the sun and the share of its disc that the earth leaves, at radius r and local solar cosine mu."""
    low = horizon(r)
    x = np.clip((mu - low) / (1 - low), 0, 1)
    h = np.clip((r - EARTH) / TOP, 0, 1)
    columns = np.exp(COLUMNS(np.stack([np.sqrt(h), np.sqrt(x)], -1)))
    angle = np.arccos(np.clip(low, -1, 1)) - np.arccos(np.clip(mu, -1, 1))
    return columns, np.clip(0.5 + angle / (2 * SUN_RADIUS), 0, 1)


def rayleigh_phase(c):
    return 3 / (16 * np.pi) * (1 + c * c)


def march(r0, mu, cos_sun, cos_view_sun, steps, second=None):
    """Along rays from radius r0 at cosine mu with the sun at local cosine cos_sun: per wavelength, what is scattered
    (air, aerosol with phase 1 each; second and higher orders), the isotropic transfer, and the end of rays on the ground."""
    hits = (mu < 0) & (r0 * r0 * (1 - mu * mu) < EARTH**2)
    length = np.where(
        hits, -r0 * mu - np.sqrt(np.maximum(0.0, EARTH**2 - r0 * r0 * (1 - mu * mu))), length_to_top(r0, mu)
    )
    edges = np.linspace(0, 1, steps + 1) ** 2
    n = len(LAMBDA)
    air, aerosol, higher, transfer = (np.zeros(r0.shape + (n,)) for _ in range(4))
    depth = np.zeros(r0.shape + (n,))
    for a, b in zip(edges[:-1], edges[1:]):
        s, ds = (a + b) / 2 * length, (b - a) * length
        r = np.sqrt(r0 * r0 + s * s + 2 * r0 * s * mu)
        local_sun = (r0 * cos_sun + s * cos_view_sun) / r
        rho = density(r - EARTH)
        extinction = rho @ COEFFICIENT
        step = extinction * ds[..., None]
        # Exact for a constant source over the step.
        weight = np.exp(-depth) * np.where(step > 1e-9, -np.expm1(-step) / np.maximum(extinction, 1e-12), ds[..., None])
        depth += step
        columns, lit = sunlight(r, local_sun)
        arriving = np.exp(-columns @ COEFFICIENT) * lit[..., None]
        scatter_air = rho[..., :1] * RAYLEIGH
        scatter_aerosol = rho[..., 1:2] * AEROSOL * AEROSOL_ALBEDO
        air += scatter_air * weight * arriving
        aerosol += scatter_aerosol * weight * arriving
        transfer += (scatter_air + scatter_aerosol) * weight
        if second is not None:
            higher += (scatter_air + scatter_aerosol) * weight * second(r, local_sun)
    ground_sun = (r0 * cos_sun + length * cos_view_sun) / EARTH
    columns, lit = sunlight(np.full_like(r0, EARTH + 1e-3), ground_sun)
    ground = (
        np.exp(-depth - columns @ COEFFICIENT)
        * (np.maximum(ground_sun, 0) * lit * hits * GROUND_ALBEDO / np.pi)[..., None]
    )
    return air, aerosol, higher, transfer, ground


def second_orders():
    """The isotropic source of second and higher orders over height and local solar cosine."""
    hs = np.linspace(0, 1, 22) ** 2 * TOP
    suns = np.sin(np.radians(np.concatenate([np.linspace(-35, -12, 16), np.linspace(-11, 12, 36), [16, 25, 40, 90]])))
    z, w = np.polynomial.legendre.leggauss(12)
    phi = (np.arange(12) + 0.5) / 12 * np.pi
    h, sun, mu, p = np.meshgrid(hs, suns, z, phi, indexing="ij")
    shape = h.shape
    cos_view = mu * sun + np.sqrt((1 - mu**2) * (1 - sun**2)) * np.cos(p)
    air, aerosol, _, transfer, ground = march(
        EARTH + np.maximum(h, 1e-2).ravel(), mu.ravel(), sun.ravel(), cos_view.ravel(), 40
    )
    isotropic = ((air + aerosol) / (4 * np.pi) + ground).reshape(shape + (-1,))
    transfer = transfer.reshape(shape + (-1,))
    average = lambda v: np.einsum("abcdl,c->abl", v, w / 2) / 12
    source = average(isotropic) / (1 - average(transfer))
    table = RegularGridInterpolator((np.sqrt(hs / TOP), suns), np.log(source + 1e-30), bounds_error=False, fill_value=None)

    def second(r, sun):
        at = np.stack([np.sqrt(np.clip((r - EARTH) / TOP, 0, 1)), np.clip(sun, suns[0], 1)], -1)
        return np.exp(table(at))

    return second


def main():
    second = second_orders()
    elevation = np.arcsin(np.clip(VIEW_SQRT_SIN**2, 1e-4, 1))
    sun, view, azimuth = np.meshgrid(np.radians(SUN_DEG), elevation, np.radians(AZIMUTH_DEG), indexing="ij")
    cos_view = np.sin(view) * np.sin(sun) + np.cos(view) * np.cos(sun) * np.cos(azimuth)
    flat = lambda v: v.ravel()
    air, aerosol, higher, _, _ = march(
        np.full(sun.size, EARTH + 1e-2), np.sin(flat(view)), np.sin(flat(sun)), flat(cos_view), 400, second
    )
    # 20 nm cells of the solar spectrum and the observer, to XYZ.
    e0 = np.genfromtxt(HERE / "sun_spectrum.csv", delimiter=",", names=True)
    bar = np.genfromtxt(HERE / "cie1931_2deg.csv", delimiter=",", names=True)
    cell = lambda x, y: np.array([np.interp(np.linspace(l - 10, l + 10, 21), x, y).mean() for l in LAMBDA])
    spectrum = cell(e0["wavelength_nm"], e0["irradiance_w_m2_nm"])
    xyz = np.stack([cell(bar["wavelength_nm"], bar[k]) for k in ("x_bar", "y_bar", "z_bar")], -1)
    to_xyz = spectrum[:, None] * xyz * 20 * 683.002
    # What needs no sharp phase function goes together; single scattering by aerosol is kept apart, its phase being 1.
    smooth = (air * rayleigh_phase(flat(cos_view))[:, None] + higher) @ to_xyz
    forward = aerosol @ to_xyz
    both = np.concatenate([smooth, forward], -1).reshape(sun.shape + (6,))
    # Relative to the sky's brightest direction of each sun. Logarithms are interpolated: 5e-4 of the mean sky stands for
    # the orders of scattering that are left out where the earth's shadow fills the whole path.
    peak = both[..., 1].max(axis=(1, 2))[:, None, None, None]
    relative = both / peak
    relative[..., :3] += 5e-4 * relative[..., :3].mean(axis=(1, 2), keepdims=True) / relative[..., 1:2].mean(axis=(1, 2), keepdims=True)
    relative[..., 3:] += 1e-5
    table = np.log(relative).astype("<f4")
    # All azimuths are one at the zenith.
    table[:, -1, :, :] = table[:, -1, :1, :]
    table.tofile(HERE / "twilight.bin")
    print(table.shape, table.nbytes)


if __name__ == "__main__":
    main()
