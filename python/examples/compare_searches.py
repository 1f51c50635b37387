"""The same calibration by SciPy, PINTS, emcee and droptower: three parameters, one VIRTUAL recording, one simulator.

    pip install scipy pints emcee
    python python/examples/compare_searches.py

A run with known multipliers and noise stands for the recording. SciPy, PINTS (whose CMA-ES PyBOP offers, too) and
emcee call the simulator through Python, one run an evaluation; `calibrate` of droptower runs it in its own process,
stores runs, and samples its posterior on surrogates. Prints a row a method: evaluations, wall time, values (medians of
emcee and droptower) and half widths of 95 %.
"""

import argparse
import contextlib
import pathlib
import tempfile
import time
from collections.abc import Callable

import emcee
import numpy as np
import pints
import scipy.optimize

import droptower

NAMES = ["k1", "ke", "ky"]
TRUTH = np.array([2.75, 3.41, 1.0])
START = np.array([2.0, 2.5, 1.1])
LOW, HIGH = np.array([1.0, 1.5, 0.6]), np.array([6.0, 6.0, 1.6])
END = 0.055  # s, about the lowest point


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="scenarios/drop/1008.toml")
    parser.add_argument("--mesh", default="40 mm", help="size of the elements")
    parser.add_argument("--noise", type=float, default=1.5, help="of each bin, m/s2")
    parser.add_argument("--generations", type=int, default=12, help="of CMA-ES at most")
    parser.add_argument("--walkers", type=int, default=12, help="of emcee")
    parser.add_argument("--steps", type=int, default=60, help="of emcee, the first third of which is discarded")
    return parser.parse_args()


class Simulator:
    """Means of the acceleration over bins of 1 ms, as a function of the three multipliers."""

    def __init__(self, options: argparse.Namespace, folder: pathlib.Path) -> None:
        self.options, self.folder, self.runs = options, folder, 0

    def __call__(self, x: np.ndarray) -> np.ndarray:
        self.runs += 1
        keys = {f"specimen.material.fabric.scale.{name}": float(value) for name, value in zip(NAMES, x, strict=True)}
        settings = {"specimen.mesh.size": self.options.mesh, "loading.impact.duration": "60 ms"}
        run = droptower.run(self.options.scenario, set=settings | keys, out=self.folder / "run", force=True)
        times, values = run.signals["time_s"].to_numpy(), run.signals["acceleration_filtered_m_s2"].to_numpy()
        places = np.floor(times / 1e-3).astype(int)
        inside = times < END
        return np.bincount(places[inside], values[inside]) / np.bincount(places[inside])


class SumOfSquares(pints.ErrorMeasure):
    """The sum of squared residuals, as PINTS minimizes it."""

    def __init__(self, residuals: Callable[[np.ndarray], np.ndarray]) -> None:
        self.residuals = residuals

    def __call__(self, x: np.ndarray) -> float:
        return float(np.sum(self.residuals(x) ** 2))

    def n_parameters(self) -> int:
        return len(NAMES)


def row(method: str, runs: int, seconds: float, middle: np.ndarray, half: np.ndarray | None = None) -> None:
    widths = ["" if half is None else f" ± {width:.3f}" for width in (NAMES if half is None else half)]
    text = "  ".join(f"{name} {value:.3f}{width}" for name, value, width in zip(NAMES, middle, widths, strict=True))
    print(f"{method:28} {runs:6} runs {seconds:8.1f} s   {text}", flush=True)


def main() -> None:
    options = arguments()
    with tempfile.TemporaryDirectory() as name, contextlib.suppress(KeyboardInterrupt):
        folder = pathlib.Path(name)
        simulator = Simulator(options, folder)
        clean = simulator(TRUTH)
        measured = clean + options.noise * np.random.default_rng(1).normal(size=clean.size)

        def residuals(x: np.ndarray) -> np.ndarray:
            return (simulator(x) - measured) / options.noise

        simulator.runs, begin = 0, time.monotonic()
        found = scipy.optimize.least_squares(residuals, START, bounds=(LOW, HIGH), x_scale=START, diff_step=0.01)
        deviation = np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))
        row("scipy, least_squares", simulator.runs, time.monotonic() - begin, found.x, 1.96 * deviation)

        before, begin = simulator.runs, time.monotonic()
        np.random.seed(4)  # of CMA-ES
        cma = pints.OptimisationController(
            SumOfSquares(residuals),
            START,
            sigma0=0.2 * START,
            boundaries=pints.RectangularBoundaries(LOW, HIGH),
            method=pints.CMAES,
        )
        cma.set_log_to_screen(False)
        cma.set_max_iterations(options.generations)
        lowest, _ = cma.run()
        row("PINTS, CMA-ES", simulator.runs - before, time.monotonic() - begin, lowest)

        def log_posterior(x: np.ndarray) -> float:
            if np.any(x < LOW) or np.any(x > HIGH):
                return -np.inf
            return float(-0.5 * np.sum(residuals(x) ** 2))

        before, begin = simulator.runs, time.monotonic()
        walkers = found.x + deviation * np.random.default_rng(2).normal(size=(options.walkers, len(NAMES)))
        sampler = emcee.EnsembleSampler(options.walkers, len(NAMES), log_posterior)
        sampler.random_state = np.random.RandomState(3).get_state()
        sampler.run_mcmc(np.clip(walkers, LOW, HIGH), options.steps)
        low, middle, high = np.quantile(
            sampler.get_chain(discard=options.steps // 3, flat=True), [0.025, 0.5, 0.975], axis=0
        )
        row("emcee, each sample a run", simulator.runs - before, time.monotonic() - begin, middle, 0.5 * (high - low))

        recording = folder / "recording.csv"
        centres = (np.arange(measured.size) + 0.5) * 1e-3
        table = np.column_stack([centres, measured])
        np.savetxt(recording, table, delimiter=",", header="time_s,acceleration_m_s2", comments="")
        begin = time.monotonic()
        script = pathlib.Path(__file__).with_suffix(".rhai")
        args = {"recording": str(recording), "mesh": options.mesh, "noise": options.noise}
        study = droptower.script(script, options.scenario, args=args, out=folder / "study", force=True)
        seconds = time.monotonic() - begin
        table = study.tables["posterior"].set_index("parameter").loc[NAMES]
        half = 0.5 * (table["upper_95"] - table["lower_95"]).to_numpy()
        row("droptower, calibrate", int(study.summary["runs"]), seconds, table["median"].to_numpy(), half)


if __name__ == "__main__":
    main()
