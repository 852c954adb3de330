"""Measured motion and forces, and how far simulations are from them (docs/identify.md).

Lengths are in m, times in s, forces in N. A motion is (times, frames): frames[k] is an array (n, 3).
"""

import csv
import os
import warnings

import numpy as np
import yaml

FRAME_FILES = (".obj", ".ply", ".stl", ".vtk", ".vtu")
KINDS = ("points", "cloud", "forces")
KEYS = {"kind", "file", "body", "link", "rate", "start", "noise", "scale", "rotation_rpy", "position", "match", "field",
        "partial", "most_points"}


class DataError(Exception):
    """What is wrong with measured data: file, place, what is allowed."""


# ---- readers ------------------------------------------------------------------------------------------------------


def read_table(path):
    """A CSV file as {column: array of numbers or texts}."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    if len(rows) < 2:
        raise DataError(f"{path}: it has no rows; the first line names columns, as time,particle,x,y,z")
    header, columns = [name.strip() for name in rows[0]], {}
    for number, row in enumerate(rows[1:], start=2):
        if len(row) != len(header):
            raise DataError(f"{path}:{number}: {len(row)} cells, but the first line has {len(header)} columns")
    for k, name in enumerate(header):
        texts = [row[k] for row in rows[1:]]
        try:
            columns[name] = np.array([float(text) if text.strip() else np.nan for text in texts])
        except ValueError:
            columns[name] = np.array(texts)
    return columns


def columns_of(table, names, path):
    missing = [name for name in names if name not in table]
    if missing:
        raise DataError(f"{path}:1: column '{missing[0]}' is missing; there are {', '.join(table)}")
    return np.stack([table[name] for name in names], axis=1).astype(float)


def read_csv_motion(path):
    """Rows of time,x,y,z: a cloud; with a column `particle` the frames are whole arrays, NaN where a row lacks."""
    table = read_table(path)
    points, when = columns_of(table, ("x", "y", "z"), path), columns_of(table, ("time",), path)[:, 0]
    times = np.unique(when)
    if "particle" not in table:
        return times, [points[when == time] for time in times]
    particle = table["particle"].astype(int)
    if particle.min() < 0:
        raise DataError(f"{path}: a particle is {particle.min()}, but they count from 0")
    frames = np.full((len(times), particle.max() + 1, 3), np.nan)
    frames[np.searchsorted(times, when), particle] = points
    return times, list(frames)


def read_point_cache(path, half):
    """PC2 point caches, and CLOTH3D's PC16, which holds numbers of 16 bits: a header of 32 bytes ("POINTCACHE2", its
    version, the number of points, the first frame, the rate, the number of frames), then the points of each frame."""
    with open(path, "rb") as file:
        data = file.read()
    header = np.dtype([("kind", "S12"), ("version", "<i4"), ("points", "<i4"), ("start", "<f4"), ("rate", "<f4"),
                       ("frames", "<i4")])
    if len(data) < header.itemsize or not data.startswith(b"POINTCACHE2"):
        raise DataError(f"{path}: it does not begin with POINTCACHE2")
    head = np.frombuffer(data, header, 1)[0]
    kind = np.dtype("<f2" if half else "<f4")
    size = int(head["points"]) * int(head["frames"]) * 3
    if head["points"] < 1 or head["frames"] < 1 or len(data) != header.itemsize + size * kind.itemsize:
        raise DataError(f"{path}: its length is not that of {head['frames']} frames of {head['points']} points")
    numbers = np.frombuffer(data, kind, size, header.itemsize).astype(float)
    return list(numbers.reshape(int(head["frames"]), int(head["points"]), 3))


def read_anime(path):
    """DeformingThings4D's .anime: the numbers of frames, vertices and triangles, the vertices of the first frame, the
    triangles, and the offsets of all further frames from the first."""
    with open(path, "rb") as file:
        data = file.read()
    frames, vertices, triangles = np.frombuffer(data, "<i4", 3) if len(data) >= 12 else (0, 0, 0)
    if min(frames, vertices, triangles) < 1 or len(data) != 12 + 12 * (int(frames) * int(vertices) + int(triangles)):
        raise DataError(f"{path}: its length is not that of {frames} frames of {vertices} vertices")
    first = np.frombuffer(data, "<f4", 3 * vertices, 12).reshape(vertices, 3).astype(float)
    begin = 12 + 12 * (int(vertices) + int(triangles))
    offsets = np.frombuffer(data, "<f4", -1, begin).reshape(frames - 1, vertices, 3).astype(float)
    return [first, *(first + offsets)]


def read_folder(path):
    """A folder of meshes or point clouds, a file a frame, in the order of their names."""
    try:
        import meshio
    except ImportError as error:
        raise DataError(f"{path}: a folder of meshes: {error} (Debian: python3-meshio)")
    names = sorted(name for name in os.listdir(path) if name.lower().endswith(FRAME_FILES))
    if not names:
        raise DataError(f"{path}: no file in it ends with one of {', '.join(FRAME_FILES)}")
    frames = []
    for name in names:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                frames.append(np.asarray(meshio.read(os.path.join(path, name)).points, float))
        except (Exception, SystemExit) as error:  # of the library, which ends the program for some files
            raise DataError(f"{os.path.join(path, name)}: it cannot be read: {error}")
    return frames


def read_array(path):
    try:
        frames = np.load(path, allow_pickle=False)
    except ValueError as error:
        raise DataError(f"{path}: {error}")
    if frames.ndim != 3 or frames.shape[2] != 3:
        raise DataError(f"{path}: its shape is {frames.shape}, but must be (frames, points, 3)")
    return list(frames.astype(float))


READERS = {".npy": read_array, ".pc2": lambda path: read_point_cache(path, False),
           ".pc16": lambda path: read_point_cache(path, True), ".anime": read_anime}


def read_motion(path, rate=None, start=0.0):
    """Of a file or a folder. `rate`: frames a second of what holds no times."""
    ending = os.path.splitext(path)[1].lower()
    if ending == ".csv":
        times, frames = read_csv_motion(path)
        return times + start, frames
    if os.path.isdir(path):
        frames = read_folder(path)
    elif ending in READERS:
        frames = READERS[ending](path)
    else:
        raise DataError(f"{path}: '{ending}' is no format of motions; allowed are .csv, {', '.join(READERS)} and a folder "
                        f"of {', '.join(FRAME_FILES)}")
    if rate is None:
        raise DataError(f"{path}: it holds no times: say its frames a second, as rate: 30")
    return start + np.arange(len(frames)) / rate, frames


def turned(frames, scale, rpy, position):
    """Into the scene's frame, as a scene's own `scale`, `rotation_rpy`, `position`."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    turn = np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], [-sp, cp * sr, cp * cr]])
    return [scale * frame @ turn.T + position for frame in frames]


# ---- simulations --------------------------------------------------------------------------------------------------


class Results:
    """What a sweep recorded of scenes at each `interval` [s]."""

    def __init__(self, folder, interval):
        self.folder, self.interval, self.arrays = folder, interval, {}
        with open(os.path.join(folder, "scenes.csv"), newline="") as file:
            rows = csv.reader(file)
            self.header = next(rows)

    def array(self, name):
        if name not in self.arrays:
            path = os.path.join(self.folder, f"trajectory_{name}.npy")
            if not os.path.exists(path):
                there = sorted(name[11:-4] for name in os.listdir(self.folder) if name.startswith("trajectory_"))
                raise DataError(f"there is no '{name}' in the scene; there are {', '.join(there)}")
            self.arrays[name] = np.load(path, mmap_mode="r")
        return self.arrays[name]

    def at(self, name, scene, times):
        """Evenly between two frames."""
        all_frames = self.array(name)[scene]
        place = np.clip(times / self.interval, 0, len(all_frames) - 1)
        low = np.minimum(place.astype(int), max(len(all_frames) - 2, 0))
        share = (place - low)[:, None, None]
        return (1 - share) * all_frames[low] + share * all_frames[np.minimum(low + 1, len(all_frames) - 1)]

    def link(self, name):
        links = [column[:-len(".force_x")] for column in self.header if column.endswith(".force_x")]
        if name not in links:
            raise DataError(f"'{name}' is no link or obstacle of the scene; there are {', '.join(links)}")
        return links.index(name)


# ---- measurements -------------------------------------------------------------------------------------------------


class Measurement:
    """Measured frames of one kind. residuals() gives, of a scene, a list of arrays, one a frame: how far the scene is
    from what was measured, [m] or [N]."""

    unit = "m"

    def __init__(self, name, times, noise, extent):
        self.name, self.times = name, times
        self.scale = noise if noise else 0.01 * extent
        if not self.scale > 0:
            raise DataError(f"{name}: nothing moves in it, so that its noise must be given")


class Points(Measurement):
    """Points that are known in the scene too: its particles, or what is nearest to them at the start."""

    def __init__(self, item, name):
        times, frames = motion_of(item)
        count = {len(frame) for frame in frames}
        if len(count) != 1:
            raise DataError(f"{name}: its frames have from {min(count)} to {max(count)} points; points that are not the "
                            "same in each frame are a cloud: kind: cloud")
        self.measured = np.stack(frames)
        super().__init__(name, times, item.get("noise"), extent_of(self.measured.reshape(-1, 3)))
        self.field = f"{item['body']}_{item.get('field', 'positions')}"
        self.match, self.nearest, self.offset = item.get("match", "number"), None, 0.0
        if self.match not in ("number", "nearest"):
            raise DataError(f"{name}: match is '{self.match}', but must be number or nearest")

    def residuals(self, results, scene):
        simulated = results.at(self.field, scene, self.times)
        if self.match == "nearest":
            simulated = self.followed(results, scene, simulated)
        if simulated.shape[1] < self.measured.shape[1]:
            raise DataError(f"{self.name}: it has {self.measured.shape[1]} points, but the body has "
                            f"{simulated.shape[1]} particles: match: nearest, or kind: cloud")
        difference = simulated[:, :self.measured.shape[1]] - self.measured
        seen = ~np.isnan(self.measured)
        return [d[s] for d, s in zip(difference, seen)]

    def followed(self, results, scene, simulated):
        from scipy.spatial import cKDTree

        first = results.at(self.field, scene, self.times[:1])[0]
        if self.nearest is None:
            self.nearest = cKDTree(first).query(np.nan_to_num(self.measured[0]))[1]
        return simulated[:, self.nearest] + (self.measured[0] - first[self.nearest])


class Cloud(Measurement):
    """Points of which nobody knows which are which: the Chamfer distance, from the points to the surface and, unless
    they show a part of it, from its vertices to the points."""

    def __init__(self, item, name):
        from scipy.spatial import cKDTree

        times, frames = motion_of(item)
        frames = [frame[~np.isnan(frame).any(axis=1)] for frame in frames]
        if min(len(frame) for frame in frames) == 0:
            raise DataError(f"{name}: a frame of it has no points")
        super().__init__(name, times, item.get("noise"), extent_of(np.concatenate(frames)))
        random, most = np.random.default_rng(0), int(item.get("most_points", 2000))
        self.frames = [frame if len(frame) <= most else frame[random.choice(len(frame), most, replace=False)]
                       for frame in frames]
        self.trees = [None if item.get("partial") else cKDTree(frame) for frame in self.frames]
        self.field = f"{item['body']}_{item.get('field', 'points')}"

    def residuals(self, results, scene):
        simulated = results.at(self.field, scene, self.times)
        return [self.distances(*frame) for frame in zip(self.frames, self.trees, simulated)]

    @staticmethod
    def distances(points, tree, surface):
        if np.isnan(surface).any():
            return np.array([np.nan])
        there = surface_distances(points, surface)
        if tree is None:
            return there
        back = tree.query(surface)[0]
        # Both directions count the same, however many points each has.
        return np.concatenate([there, back * np.sqrt(len(there) / len(back))])


class Forces(Measurement):
    """Forces of bodies on a robot's link or an obstacle, in its frame."""

    unit = "N"

    def __init__(self, item, name):
        table = read_table(item["file"])
        self.measured = columns_of(table, ("force_x", "force_y", "force_z"), item["file"])
        times = columns_of(table, ("time",), item["file"])[:, 0] + item.get("start", 0.0)
        super().__init__(name, times, item.get("noise"), extent_of(self.measured))
        if "link" not in item:
            raise DataError(f"{name}: say on which link or obstacle, as link: gripper")
        self.link = item["link"]

    field = "wrenches"

    def residuals(self, results, scene):
        simulated = results.at("wrenches", scene, self.times)[:, results.link(self.link), :3]
        return list(simulated - self.measured)


def surface_distances(points, vertices):
    """From each point to the surface near it: the plane through the three vertices next to it where its foot is among
    them, else the nearest vertex."""
    from scipy.spatial import cKDTree

    distance, near = cKDTree(vertices).query(points, k=min(3, len(vertices)))
    if len(vertices) < 3:
        return distance[:, 0] if distance.ndim > 1 else distance
    a, b, c = (vertices[near[:, k]] for k in range(3))
    u, v, w = b - a, c - a, points - a
    normal = np.cross(u, v)
    square = np.einsum("ij,ij->i", normal, normal)
    flat = square < 1e-24
    square[flat] = 1.0
    beta = np.einsum("ij,ij->i", np.cross(w, v), normal) / square
    gamma = np.einsum("ij,ij->i", np.cross(u, w), normal) / square
    inside = ~flat & (beta >= -1e-9) & (gamma >= -1e-9) & (beta + gamma <= 1 + 1e-9)
    height = np.abs(np.einsum("ij,ij->i", w, normal)) / np.sqrt(square)
    return np.where(inside, height, distance[:, 0])


def extent_of(points):
    return float(np.linalg.norm(np.nanmax(points, axis=0) - np.nanmin(points, axis=0)))


def motion_of(item):
    times, frames = read_motion(item["file"], item.get("rate"), item.get("start", 0.0))
    if any(key in item for key in ("scale", "rotation_rpy", "position")):
        frames = turned(frames, item.get("scale", 1.0), np.array(item.get("rotation_rpy", [0, 0, 0]), float),
                        np.array(item.get("position", [0, 0, 0]), float))
    return times, frames


def kind_of(item):
    """Where the data do not say it."""
    if not item["file"].endswith(".csv"):
        return "points"
    with open(item["file"], newline="") as file:
        header = next(csv.reader(file), [])
    return "forces" if "force_x" in header else "points" if "particle" in header else "cloud"


def read_item(item, where, folder, bodies):
    if not isinstance(item, dict) or "file" not in item:
        raise DataError(f"{where}: it must be a map with 'file'")
    unknown = sorted(set(item) - KEYS)
    if unknown:
        raise DataError(f"{where}: unknown key '{unknown[0]}'; allowed are {', '.join(sorted(KEYS))}")
    item = {**item, "file": os.path.join(folder, item["file"])}
    if not os.path.exists(item["file"]):
        raise DataError(f"{where}: there is no file '{item['file']}'")
    item.setdefault("body", bodies[0])
    if item["body"] not in bodies:
        raise DataError(f"{where}: there is no body '{item['body']}'; there are {', '.join(bodies)}")
    kind = item.get("kind") or kind_of(item)
    if kind not in KINDS:
        raise DataError(f"{where}: kind is '{kind}', but must be one of {', '.join(KINDS)}")
    measurement = {"points": Points, "cloud": Cloud, "forces": Forces}[kind](item, where)
    if measurement.times.min() < 0 or measurement.times.max() <= 0:
        raise DataError(f"{where}: its times are from {measurement.times.min():g} to {measurement.times.max():g} s, but "
                        "the scene begins at 0")
    return measurement


def read_data(path, bodies):
    """Measurements of a YAML file (`measurements:`, a list), or of one file of data. Also all files that it names."""
    if os.path.splitext(path)[1] not in (".yaml", ".yml"):
        return [read_item({"file": os.path.abspath(path)}, path, "", bodies)], [path]
    with open(path) as file:
        try:
            data = yaml.safe_load(file)
        except yaml.YAMLError as error:
            raise DataError(f"{path}: {error}")
    if not isinstance(data, dict) or list(data) != ["measurements"] or not isinstance(data["measurements"], list) \
            or not data["measurements"]:
        raise DataError(f"{path}: it must hold 'measurements:', a list, and nothing else")
    folder = os.path.dirname(os.path.abspath(path))
    items = [(item, f"{path}: measurements[{k}]") for k, item in enumerate(data["measurements"])]
    measurements = [read_item(item, where, folder, bodies) for item, where in items]
    return measurements, [path, *(os.path.join(folder, item["file"]) for item, _ in items)]
