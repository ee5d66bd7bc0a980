"""The sun's place by others: ERFA's own chain (IAU 2006/2000A, the Earth of epv00) and pvlib's SPA.

stdin: lines of `day fraction delta_t latitude longitude elevation pressure temperature`: UT1 as a Julian date in two
parts, seconds, degrees, metres, hPa, degrees C. stdout: for each line
`azimuth elevation right_ascension declination distance   azimuth elevation apparent_elevation equation_of_time`
the first five by ERFA, the last four by pvlib, in degrees, au and minutes. No polar motion; dates of any age.
"""

import sys
import warnings

import erfa
import numpy as np
import pvlib.spa

AU_M = 149597870700.0
LIGHT_AU_PER_DAY = 173.1446326846693


def erfa_chain(day, fraction, delta_t, latitude, longitude, elevation):
    """Topocentric azimuth and elevation, apparent right ascension and declination [rad], distance [au]."""
    tt = (day, fraction + delta_t / 86400.0)
    heliocentric, barycentric = erfa.epv00(*tt)
    era = erfa.era00(day, fraction)
    to_cirs = erfa.c2i06a(*tt)

    # The observer on WGS84, turned into the celestial frame.
    ground = erfa.gd2gc(1, longitude, latitude, elevation) / AU_M
    cos, sin = np.cos(era), np.sin(era)
    turned = np.stack([cos * ground[:, 0] - sin * ground[:, 1], sin * ground[:, 0] + cos * ground[:, 1], ground[:, 2]], -1)
    rate = 2 * np.pi * 1.00273781191135448
    moving = np.stack([-turned[:, 1], turned[:, 0], 0 * cos], -1) * rate
    celestial = lambda v: np.einsum("nji,nj->ni", to_cirs, v)

    def apparent(position, velocity):
        light_time = np.full(len(day), 0.0057755)
        for _ in range(3):
            then_h, then_b = erfa.epv00(tt[0], tt[1] - light_time)
            vector = then_b["p"] - then_h["p"] - position
            light_time = np.linalg.norm(vector, axis=-1) / LIGHT_AU_PER_DAY
        direction = vector / np.linalg.norm(vector, axis=-1, keepdims=True)
        v = velocity / LIGHT_AU_PER_DAY
        root = np.sqrt(1 - np.sum(v * v, -1))
        sun = np.linalg.norm(heliocentric["p"], axis=-1)
        return erfa.ab(direction, v, sun, root), np.linalg.norm(vector, axis=-1)

    seen, _ = apparent(barycentric["p"] + celestial(turned), barycentric["v"] + celestial(moving))
    cirs = np.einsum("nij,nj->ni", to_cirs, seen)
    x = cos * cirs[:, 0] + sin * cirs[:, 1]
    y = cos * cirs[:, 1] - sin * cirs[:, 0]
    z = cirs[:, 2]
    # To the local meridian, then to the horizon.
    out = np.cos(longitude) * x + np.sin(longitude) * y
    east = np.cos(longitude) * y - np.sin(longitude) * x
    north = np.cos(latitude) * z - np.sin(latitude) * out
    up = np.sin(latitude) * z + np.cos(latitude) * out
    azimuth, height = np.arctan2(east, north) % (2 * np.pi), np.arctan2(up, np.hypot(east, north))

    geocentric, _ = apparent(barycentric["p"], barycentric["v"])
    of_date = np.einsum("nij,nj->ni", erfa.pnm06a(*tt), geocentric)
    right_ascension = np.arctan2(of_date[:, 1], of_date[:, 0]) % (2 * np.pi)
    declination = np.arctan2(of_date[:, 2], np.hypot(of_date[:, 0], of_date[:, 1]))
    return azimuth, height, right_ascension, declination, np.linalg.norm(heliocentric["p"], axis=-1)


def pvlib_spa(day, fraction, delta_t, latitude, longitude, elevation, pressure, temperature):
    """Azimuth, true and apparent elevation [degrees], equation of time [minutes]."""
    unix = (day - 2440587.5) * 86400.0 + fraction * 86400.0
    rows = [
        pvlib.spa.solar_position_numpy(np.array([u]), la, lo, h, p, t, d, 0.5667, 1)
        for u, la, lo, h, p, t, d in zip(unix, latitude, longitude, elevation, pressure, temperature, delta_t)
    ]
    rows = np.array(rows)[:, :, 0]
    return rows[:, 4], rows[:, 3], rows[:, 2], rows[:, 5]


def main():
    warnings.filterwarnings("ignore")  # ERFA's "dubious year"
    table = np.loadtxt(sys.stdin, ndmin=2)
    day, fraction, delta_t, latitude, longitude, elevation, pressure, temperature = table.T
    truth = erfa_chain(day, fraction, delta_t, np.radians(latitude), np.radians(longitude), elevation)
    columns = [np.degrees(c) for c in truth[:4]] + [truth[4]]
    columns += pvlib_spa(*table.T)
    np.savetxt(sys.stdout, np.array(columns).T, fmt="%.15g")


if __name__ == "__main__":
    main()
