"""Fits numbers of a scene to measurements: CMA-ES over sweeps, then how sure each number is (docs/identify.md)."""

import csv
import json
import math
import os
import shutil
import subprocess

import numpy as np

from identify_data import DataError, Results
from sweep_run import parse_arguments, sweep
from whole_file import whole_file

WINDOW = 100.0  # times and parts of what the scene says, within the registry's range, unless the user says another
SPREAD = 0.25  # of the first generation, as share of the bounds
ROUNDS = 8  # of refinement, at most
FAILED = 1e300  # the loss of a scene that stopped or was refused


class Parameter:
    """A number of the scene with its bounds; `share` runs from 0 to 1 between these, by the logarithm where it can."""

    def __init__(self, text, described):
        self.path, _, bounds = text.partition("=")
        row = described[self.path]
        self.unit, self.is_known = row["unit"], row["value"] != ""
        self.start = float(row["value"]) if self.is_known else None
        self.low, self.high = self._bounds(bounds, row)
        if self.start is None or not self.low <= self.start <= self.high:
            self.start = math.sqrt(self.low * self.high) if self.low > 0 else (self.low + self.high) / 2
        self.by_logarithm = self.low > 0

    def _bounds(self, text, row):
        if not text:
            if not self.is_known:
                raise DataError(f"{self.path}: no registry describes it: give bounds, as {self.path}=LOW:HIGH")
            if not self.start > 0:
                raise DataError(f"{self.path} is {self.start:g} in the scene: give bounds, as {self.path}=LOW:HIGH")
            return max(float(row["minimum"]), self.start / WINDOW), min(float(row["maximum"]), self.start * WINDOW)
        try:
            low, high = (float(part) for part in text.split(":"))
        except ValueError:
            raise DataError(f"{self.path}={text}: bounds are written LOW:HIGH, as 0.1:10")
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise DataError(f"{self.path}={text}: LOW must be less than HIGH")
        if self.is_known:
            least, most = float(row["minimum"]), float(row["maximum"])
            is_open = row["minimum_is_allowed"] == "0"
            if low < least or high > most or (is_open and low == least):
                raise DataError(f"{self.path}={text}: it must be a number {'>' if is_open else '>='} {least:g} and <= "
                                f"{most:g} [{self.unit}]")
        return low, high

    def value(self, share):
        if self.by_logarithm:
            return float(self.low * (self.high / self.low) ** share)
        return float(self.low + (self.high - self.low) * share)

    def share(self, value):
        if self.by_logarithm:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


def described(program, scene, paths, folder="."):
    """What the program knows of numbers of the scene: {path: row}."""
    answer = subprocess.run([program, "describe", scene, *(word for path in paths for word in ("--value", path))],
                            capture_output=True, text=True, cwd=folder)
    if answer.returncode != 0:
        raise DataError(answer.stderr.strip().removeprefix("error: "))
    return {row["path"]: row for row in csv.DictReader(answer.stdout.splitlines())}


class Fit:
    """A search in the folder `options.out`, which can be stopped at any time: generations that are done are read."""

    def __init__(self, options, parameters, measurements, time_step, engine):
        self.options, self.parameters, self.measurements, self.engine = options, parameters, measurements, engine
        self.end = max(m.times.max() for m in measurements)
        self.steps = max(1, math.ceil(self.end / time_step - 1e-9))
        self.every = frames_between(measurements, time_step)
        self.interval = self.every * time_step
        self.split = (1 - options.held_out / 100) * self.end
        self.evaluations = 0

    # ---- scenes ----

    def run(self, name, shares):
        """Steps a scene for each row of shares. Returns the folder of its results."""
        folder = os.path.join(self.options.out, name)
        table = folder + ".csv"
        with whole_file(table, newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow([p.path for p in self.parameters])
            rows.writerows([[repr(p.value(s)) for p, s in zip(self.parameters, row)] for row in shares])
        fields = sorted({"wrenches" if m.field == "wrenches" else m.field.rsplit("_", 1)[1] for m in self.measurements})
        per_shard = math.ceil(len(shares) / self.options.workers)
        arguments = [self.options.scene, "--vary", table, "--out", folder, "--program", self.options.program,
                     "--shard-rows", str(per_shard), "--timeout", str(self.options.timeout), "--quiet",
                     "--steps", str(self.steps), "--trajectory", f"every:{self.every}", f"fields:{','.join(fields)}",
                     *self.options.run_options]
        code = sweep(parse_arguments(arguments, ""), self.engine)
        if code not in (0, 3):
            raise DataError(f"the sweep {folder} ended with {code}")
        return folder

    def losses(self, name, shares):
        """Of each row: the mean of squared residuals over the noise, of the times before those held out."""
        kept = os.path.join(self.options.out, name + ".json")
        values = [[p.value(s) for p, s in zip(self.parameters, row)] for row in shares]
        if os.path.exists(kept):
            with open(kept) as file:
                there = json.load(file)
            if there["values"] == values:
                return there["losses"]
        folder = self.run(name, shares)
        results = Results(folder, self.interval)
        losses = [self.loss(results, scene) for scene in range(len(shares))]
        with whole_file(kept) as file:
            json.dump({"values": values, "losses": losses}, file)
        shutil.rmtree(folder)
        os.remove(folder + ".csv")
        self.evaluations += len(shares)
        return losses

    def loss(self, results, scene):
        total = 0.0
        for m in self.measurements:
            used = np.concatenate([r for r, t in zip(m.residuals(results, scene), m.times) if t <= self.split])
            total += float(np.mean(np.square(used / m.scale)))
        return total / len(self.measurements) if math.isfinite(total) else FAILED

    def count(self):
        """Residuals that count."""
        return sum(np.size(f) for m in self.measurements for f, t in zip(frames_of(m), m.times) if t <= self.split)

    # ---- the search ----

    def search(self, tell):
        """Returns the shares at the end and the spread of the last generation."""
        try:
            from cmaes import CMA
        except ImportError as error:
            raise DataError(f"{error} (Debian: python3-cmaes)")
        # The library wants two dimensions at least: a second one that means nothing changes no order.
        n = max(2, len(self.parameters))
        start = np.full(n, 0.5)
        start[:len(self.parameters)] = [min(0.98, max(0.02, p.share(p.start))) for p in self.parameters]
        optimizer = CMA(mean=start, sigma=SPREAD, bounds=np.tile([0.0, 1.0], (n, 1)), seed=self.options.seed,
                        population_size=self.options.population)
        used = len(self.parameters)
        for generation in range(self.options.generations):
            asked = [optimizer.ask() for _ in range(optimizer.population_size)]
            losses = self.losses(f"generation-{generation:04d}", [x[:used] for x in asked])
            if min(losses) >= FAILED:
                raise DataError("no scene of a generation ran to its end: look at the scene, or give narrower bounds")
            optimizer.tell(list(zip(asked, losses)))
            best = asked[int(np.argmin(losses))][:used]
            spread = np.std([x[:used] for x in asked], axis=0)
            tell(generation, min(losses), optimizer._mean[:used], spread, best)
            if all(self.is_narrow(p, s) for p, s in zip(self.parameters, spread)):
                break
        return np.clip(optimizer._mean[:used], 0, 1), spread

    def is_narrow(self, parameter, spread):
        return self.relative(parameter, spread) < self.options.precision / 100

    @staticmethod
    def relative(parameter, spread):
        """A spread of shares as one of values: of the value, or of the bounds where these begin at or below 0."""
        return spread * math.log(parameter.high / parameter.low) if parameter.by_logarithm else spread

    # ---- how sure it is ----

    def refine(self, center, spread):
        """From where the search ended to the lowest place of the paraboloid that the loss is there, by Newton's steps,
        as long as these lower it. Returns that and the covariance of the shares; None for this where the loss has no
        minimum there, so that the data do not say all of the parameters."""
        basis, covariance = np.diag(np.clip(2 * spread, 3e-4, 0.02)), None
        for number in range(ROUNDS):
            losses, gradient, hessian, roughness = self.paraboloid(f"around-{number}", center, basis)
            if losses is None or np.linalg.eigvalsh(hessian).min() <= 1e-9 * losses[0]:
                if covariance is not None or np.abs(basis).max() > 0.1:
                    break
                basis = 4 * basis  # over what is rough
                continue
            # A number is as unsure as the noise of the data leaves it, and as what the loss is off its paraboloid.
            freedom = max(1, self.count() - len(center))
            covariance = basis @ (2 * (losses.min() / freedom + roughness) * np.linalg.inv(hessian)) @ basis.T
            step = -np.linalg.solve(hessian, gradient)
            step *= min(1.0, 2.0 / np.abs(step).max())
            candidate = np.clip(center + basis @ step, 0, 1)
            is_better = self.losses(f"step-{number}", [candidate])[0] < losses[0]
            if is_better:
                center = candidate
            # Next along the paraboloid's own axes, as far as the numbers are unsure.
            values, axes = np.linalg.eigh(covariance)
            wanted = axes * np.minimum(2 * np.sqrt(values), 0.1 / np.abs(axes).max(axis=0))
            change = np.abs(wanted).max() / np.abs(basis).max()
            if number > 0 and (not is_better or np.abs(step).max() < 0.3) and 0.4 < change < 2.5:
                break
            basis = wanted
        return center, covariance

    def paraboloid(self, name, center, basis):
        """The loss at the centre and steps along each column of the basis and each pair of them; by least squares its
        gradient and second derivatives in these; and how far it is off that, root mean square. None: a scene failed."""
        n = len(center)
        units = np.eye(n)
        steps = [np.zeros(n), *units, *-units, *(0.5 * units if n == 1 else ()), *(-0.5 * units if n == 1 else ())]
        steps += [a * units[i] + b * units[j] for i in range(n) for j in range(i) for a in (1, -1) for b in (1, -1)]
        at = np.clip([center + basis @ step for step in steps], 0, 1)
        losses = np.array(self.losses(name, at))
        if (losses >= FAILED).any():
            return None, None, None, None
        z = np.linalg.solve(basis, (at - center).T).T
        pairs = [(i, j) for i in range(n) for j in range(i, n)]
        columns = [np.ones(len(z)), *z.T, *(z[:, i] * z[:, j] * (0.5 if i == j else 1.0) for i, j in pairs)]
        matrix = np.stack(columns, axis=1)
        solution = np.linalg.lstsq(matrix, losses, rcond=None)[0]
        off = np.sum(np.square(losses - matrix @ solution)) / (len(losses) - matrix.shape[1])
        hessian = np.zeros((n, n))
        for (i, j), value in zip(pairs, solution[1 + n:]):
            hessian[i, j] = hessian[j, i] = value
        return losses, solution[1:1 + n], hessian, math.sqrt(off)


def frames_of(measurement):
    """Arrays of what was measured, a frame each, as long as its residuals."""
    measured = getattr(measurement, "frames", None)
    if measured is not None:
        return [np.zeros(len(frame)) for frame in measured]
    return [frame[~np.isnan(frame)] for frame in measurement.measured]


def frames_between(measurements, time_step):
    """Steps between recorded frames, so that each measured time is one of them; 1 where they are between steps."""
    steps = np.concatenate([m.times for m in measurements]) / time_step
    if np.abs(steps - np.round(steps)).max() > 1e-6 * max(1.0, steps.max()):
        return 1
    return max(1, math.gcd(*np.unique(np.round(steps).astype(int)).tolist()))
