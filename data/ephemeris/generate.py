"""Makes truth.csv, and the rows of delta_t.csv that come from the IERS, anew.

Run with the Python of the tests:  python data/ephemeris/generate.py
truth.csv keeps its places and times, which were drawn at random once; the directions are computed. In delta_t.csv the
polynomials of Morrison et al. are copied from print and stay as they are.
"""

import sys
from pathlib import Path

import astropy_iers_data
import erfa
import numpy as np
from astropy.utils import iers

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1] / "tests" / "python"))
from ephemeris import erfa_chain


def truth():
    """Azimuth and true elevation by ERFA, after the six columns that are given."""
    path = HERE / "truth.csv"
    lines = path.read_text().splitlines()
    head = [line for line in lines if not line[0].isdigit()]
    given = [line.split(",")[:6] for line in lines if line[0].isdigit()]
    day, fraction, delta_t, latitude, longitude, elevation = np.array(given, float).T
    places = erfa_chain(day, fraction, delta_t, np.radians(latitude), np.radians(longitude), elevation)
    rows = [
        ",".join(cells) + f",{azimuth:.9f},{height:.9f}"
        for cells, azimuth, height in zip(given, np.degrees(places[0]), np.degrees(places[1]))
    ]
    path.write_text("\n".join(head + rows) + "\n")


def observed(year):
    """Delta-T [s] at Julian epochs: EOP 20 C04 as far as it goes, then finals2000A, both as astropy-iers-data has them."""
    days = 51544.5 + 365.25 * (year - 2000.0)
    c04 = iers.IERS_B.open(astropy_iers_data.IERS_B_FILE)
    finals = iers.IERS_A.open(astropy_iers_data.IERS_A_FILE)
    answer = np.empty_like(days)
    for i, mjd in enumerate(days):
        table = c04 if mjd <= c04["MJD"][-1].value else finals
        # TT - UT1 has no leap seconds: it is interpolated, where UT1 - UTC would jump.
        at = np.searchsorted(table["MJD"].value, mjd) - 1
        around = table["MJD"].value[at : at + 2]
        ut1_utc = table["UT1_UTC"][at : at + 2].to_value("s")
        values = [32.184 + tai_minus_utc(m) - d for m, d in zip(around, ut1_utc)]
        answer[i] = np.interp(mjd, around, values)
    return answer


def tai_minus_utc(mjd):
    year, month, day, fraction = erfa.jd2cal(2400000.5, mjd)
    return erfa.dat(year, month, day, fraction)


def delta_t():
    """The IERS's quarter years: straight pieces between values rounded to 1 ms."""
    path = HERE / "delta_t.csv"
    lines = path.read_text().splitlines()
    for i, line in enumerate(lines):
        if ",IERS " not in line:
            continue
        start, end = line.split(",")[:2]
        first, last = observed(np.array([float(start), float(end)])).round(3)
        lines[i] = f"{start},{end},{first:.10g},{round(last - first, 3):.10g},0.0,0.0,{line.split(',')[6]}"
    path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    truth()
    delta_t()
