"""Writes the tables of this folder that come from Python packages.

Run with a Python that has colour-science 0.4.7, pvlib 0.16.1 and numpy:  python data/generate.py
What each file holds and where it comes from stands in SOURCES.md. The results are committed; this script shows how they were made.
"""

import csv
from pathlib import Path

import colour
import numpy as np
import pvlib
from pvlib.spectrum.spectrl2 import _SPECTRL2_COEFFS as SPECTRL2

HERE = Path(__file__).parent


def write(name, header, rows):
    with open(HERE / name, "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(header)
        out.writerows(rows)


def cie1931():
    """The 2 degree observer at 5 nm, 360 to 830 nm: the CIE's own table (CIE 018) through colour-science."""
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    rows = [[int(w)] + [f"{v:.10g}" for v in cmfs[float(w)]] for w in range(360, 831, 5)]
    write("cie1931_2deg.csv", ["wavelength_nm", "x_bar", "y_bar", "z_bar"], rows)


def sun_spectrum():
    """Cells of 5 nm up to 830 nm, then SPECTRL2's own grid: irradiance is the mean of ASTM G173 over each cell."""
    g173 = pvlib.spectrum.get_reference_spectra()["extraterrestrial"]
    centre = np.concatenate([np.arange(300.0, 831.0, 5.0), SPECTRL2["wavelength"][SPECTRL2["wavelength"] > 835.0]])
    edge = np.concatenate([[297.5], (centre[1:] + centre[:-1]) / 2.0, [4000.0]])
    fine = np.arange(280.0, 4000.01, 0.05)
    irradiance = np.interp(fine, g173.index.values, g173.values)
    cumulative = np.concatenate([[0.0], np.cumsum((irradiance[1:] + irradiance[:-1]) / 2.0 * np.diff(fine))])
    within = np.diff(np.interp(edge, fine, cumulative))
    width = np.diff(edge)
    column = lambda name: np.interp(centre, SPECTRL2["wavelength"], SPECTRL2[name])
    # Iqbal 1983 has ozone on a finer grid in the Chappuis band than SPECTRL2; both are Vigroux 1953.
    iqbal = np.genfromtxt(HERE / "ozone_iqbal1983.csv", delimiter=",", names=True)
    ozone = np.interp(centre, iqbal["wavelength_nm"], iqbal["absorption_per_cm"], right=0.0)
    rows = [
        [f"{c:g}", f"{d:g}", f"{s:.6g}", f"{o:.6g}", f"{w:.6g}", f"{m:.6g}"]
        for c, d, s, o, w, m in zip(
            centre, width, within / width, ozone, column("water_vapor_absorption"), column("mixed_absorption")
        )
    ]
    write(
        "sun_spectrum.csv",
        ["wavelength_nm", "width_nm", "irradiance_w_m2_nm", "ozone_per_cm", "water_vapour_per_cm", "mixed_gas_per_km"],
        rows,
    )


if __name__ == "__main__":
    cie1931()
    sun_spectrum()
