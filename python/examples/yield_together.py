"""Would one more term of the fabric law follow coupons at angles between 0, 45 and 90 degrees?

Fits the curves of MD, TD and shear to coupons at 0, 45 and 90 degrees, as they are (chi = 0) and where
they yield together (chi = 1: W = Σ E_i e_i²/rho² W_i(rho/√E_i), rho² = Σ E_i e_i², first slopes E_i), and prints
how far both are off at every angle. Files are called 22.5deg-1.csv, …, with columns of time (s),
displacement (m) and force (N). Needs NumPy and SciPy; from the repository:

    python python/examples/yield_together.py data/virtual_angles
    python python/examples/yield_together.py lab --gauge 100 --width 15 --thickness 25
"""

import argparse
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

STRAINS = np.array([0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1, 0.13, 0.16, 0.2])
FIBRE = np.array([0.012, 0.025, 0.035, 0.045, 0.06, 0.1, 0.15, 0.25])  # strains of the points of a fibre curve
SHEAR = np.array([0.012, 0.025, 0.04, 0.055, 0.075, 0.1, 0.16, 0.25, 0.4])  # angles of the points of the shear curve
AXES = (0, 45, 90)
DIFFERENCE = 1e-5  # of stretches


class Curve:
    """A piecewise linear curve through the origin by its rises, and its energy."""

    def __init__(self, places, rises):
        slope = rises[-1] / (places[-1] - places[-2])
        self.x = np.concatenate([[0.0], places, [4 * places[-1]]])
        self.y = np.concatenate([[0.0], np.cumsum(rises), [rises.sum() + 3 * slope * places[-1]]])
        self.w = np.concatenate([[0.0], np.cumsum(0.5 * (self.y[1:] + self.y[:-1]) * np.diff(self.x))])
        self.modulus = self.y[1] / self.x[1]

    def energy(self, x):
        i = min(max(int(np.searchsorted(self.x, x)) - 1, 0), len(self.x) - 2)
        d = x - self.x[i]
        return self.w[i] + self.y[i] * d + 0.5 * (self.y[i + 1] - self.y[i]) / (self.x[i + 1] - self.x[i]) * d * d


def energy(curves, chi, angle, along, width, shear):
    """Energy per volume of a strip that is stretched and sheared, at an angle from MD."""
    c, s = np.cos(angle), np.sin(angle)
    f1 = np.array([along * c - shear * s, -width * s])
    f2 = np.array([along * s + shear * c, width * c])
    stretches = [np.hypot(*f) for f in (f1, f2)]
    sine = f1 @ f2 / (max(stretches[0], 1.0) * max(stretches[1], 1.0))
    strains = [max(stretch - 1.0, 0.0) for stretch in stretches] + [abs(np.arcsin(np.clip(sine, -0.99, 0.99)))]
    apart = sum(curve.energy(strain) for curve, strain in zip(curves, strains, strict=True))
    if chi == 0.0:
        return apart
    parts = [curve.modulus * strain**2 for curve, strain in zip(curves, strains, strict=True)]
    whole = sum(parts) + 1e-30
    pairs = zip(curves, parts, strict=True)
    together = sum(part / whole * curve.energy(np.sqrt(whole / curve.modulus)) for curve, part in pairs)
    return (1.0 - chi) * apart + chi * together


def pull(curves, chi, angle):
    """Nominal stresses of a strip with free sides: width and shear of the least energy, by Newton's method."""
    width, shear, stresses, h = 1.0, 0.0, [], DIFFERENCE
    for strain in STRAINS:
        along = 1.0 + strain
        for _ in range(60):

            def at(w, g, along=along, width=width, shear=shear):
                return energy(curves, chi, angle, along, width + w, shear + g)

            here = at(0, 0)
            ends = [at(h, 0), at(-h, 0), at(0, h), at(0, -h)]
            gradient = np.array([ends[0] - ends[1], ends[2] - ends[3]]) / (2 * h)
            mixed = (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h * h)
            pure = [(ends[0] - 2 * here + ends[1]) / h**2, (ends[2] - 2 * here + ends[3]) / h**2]
            values, vectors = np.linalg.eigh([[pure[0], mixed], [mixed, pure[1]]])
            step = -vectors @ ((vectors.T @ gradient) / np.maximum(np.abs(values), 1e4))
            share = 1.0
            while share > 1e-4 and at(*(share * step)) > here + 1e-9 * abs(here):
                share *= 0.5
            width, shear = width + share * step[0], shear + share * step[1]
            if np.abs(step).max() < 1e-7:
                break
        ends = [energy(curves, chi, angle, along + d, width, shear) for d in (h, -h)]
        stresses.append((ends[0] - ends[1]) / (2 * h))
    return np.array(stresses)


def recordings(folder, gauge, section):
    """Mean stresses at the strains, by angle in degrees."""
    found = {}
    for path in sorted(Path(folder).glob("*deg-*.csv")):
        rows = [line for line in path.read_text().splitlines() if not line.startswith("#")]
        data = np.loadtxt(rows[1:], delimiter=",")
        stress = np.interp(STRAINS, data[:, 1] / gauge, data[:, 2] / section)
        found.setdefault(float(path.name.split("deg")[0]), []).append(stress)
    missing = [str(angle) for angle in AXES if angle not in found]
    if missing:
        raise SystemExit(
            f"{folder} has no coupons at {', '.join(missing)} degrees: files such as {missing[0]}deg-1.csv"
        )
    return {angle: np.mean(stresses, axis=0) for angle, stresses in sorted(found.items())}


def fitted(measured, chi):
    """The curves that follow the coupons at 0, 45 and 90 degrees."""

    def rises(places, stresses):
        return np.maximum(np.diff(np.interp(np.concatenate([[0.0], places]), [0.0, *STRAINS], [0.0, *stresses])), 1e3)

    start = [rises(FIBRE, measured[0]), rises(FIBRE, measured[90]), 0.5 * rises(SHEAR / 1.3, measured[45])]
    start = np.log(np.concatenate(start))
    n = len(FIBRE)

    def curves(x):
        own = np.exp(x)
        return [Curve(FIBRE, own[:n]), Curve(FIBRE, own[n : 2 * n]), Curve(SHEAR, own[2 * n :])]

    def residuals(x):
        off = [pull(curves(x), chi, np.radians(angle)) / measured[angle] - 1.0 for angle in AXES]
        return np.concatenate([*off, 1e-3 * (x - start)])

    return curves(least_squares(residuals, start, diff_step=1e-4, max_nfev=15).x)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", help="of the recordings")
    parser.add_argument("--gauge", type=float, default=50, help="length between the jaws, mm")
    parser.add_argument("--width", type=float, default=10, help="of a coupon, mm")
    parser.add_argument("--thickness", type=float, default=50, help="of the film, um")
    args = parser.parse_args()
    measured = recordings(args.folder, 1e-3 * args.gauge, 1e-9 * args.width * args.thickness)
    for chi in (0.0, 1.0):
        curves = fitted(measured, chi)
        print(f"chi = {chi:g}, fitted to {AXES}: off by")
        for angle, stress in measured.items():
            off = 100 * (pull(curves, chi, np.radians(angle)) / stress - 1.0)
            print(f"  {angle:5g} degrees  mean {off.mean():+5.1f} %  largest {np.abs(off).max():4.1f} %")


if __name__ == "__main__":
    main()
