"""Lays the results of a sweep's shards together, as one `pliant run` would have written them."""

import ast
import csv
import math
import os
import shutil

from sweep_shard import SweepError
from whole_file import whole_file

def parts_of(shards):
    """All parts in the order of rows, and isolated rows between them: (begin, end, folder or None, why)."""
    for target, done in shards:
        parts = [(begin, end, os.path.join(target, name), "") for begin, end, name in done["parts"]]
        parts += [(int(row), int(row) + 1, None, why) for row, why in done["isolated"].items()]
        yield from sorted(parts)


def table_rows(path):
    with open(path, newline="") as file:
        rows = (row for row in csv.reader(file) if row)
        next(rows)
        yield from rows


def merge_tables(parts, options, target):
    with open(next(folder for _, _, folder, _ in parts if folder) + "/scenes.csv", newline="") as file:
        header = file.readline()
    columns, isolated = len(next(csv.reader([header]))), {part[0]: part[3] for part in parts if part[2] is None}
    values = {row: cells for row, cells in enumerate(table_rows(options.vary)) if row in isolated} if isolated else {}
    with whole_file(target, newline="") as merged:
        merged.write(header)
        for begin, _, folder, why in parts:
            if folder is None:
                cells = [str(begin), *values[begin]]
                csv.writer(merged, lineterminator="\n").writerow(cells + [""] * (columns - len(cells) - 1) + [why])
                continue
            with open(folder + "/scenes.csv", newline="") as file:
                if file.readline() != header:
                    raise SweepError(f"{folder}/scenes.csv has other columns than the first shard's")
                shutil.copyfileobj(file, merged)


def merge_rows(parts, name, target):
    """Of contacts or warnings, which say of which scene they are: those of crashed rows are none."""
    with whole_file(target, newline="") as merged:
        for number, (_, _, folder, _) in enumerate(part for part in parts if part[2] is not None):
            with open(os.path.join(folder, name), newline="") as file:
                header = file.readline()
                if number == 0:
                    merged.write(header)
                shutil.copyfileobj(file, merged)


def npy_header(file):
    """The shape of the array, and where its numbers begin."""
    length = int.from_bytes(file.read(10)[8:10], "little")
    return ast.literal_eval(file.read(length).decode("latin1"))["shape"], 10 + length


def merge_arrays(parts, name, target):
    with open(os.path.join(next(folder for _, _, folder, _ in parts if folder), name), "rb") as file:
        shape = npy_header(file)[0][1:]
    items = sum(end - begin for begin, end, _, _ in parts)
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {(items, *shape)}, }}".encode().ljust(245) + b"\n"
    missing = b"\0\0\0\0\0\0\xf8\x7f" * math.prod(shape)  # NaN
    with whole_file(target, "wb") as merged:
        merged.write(b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text)
        for begin, end, folder, _ in parts:
            if folder is None:
                merged.write(missing)
                continue
            with open(os.path.join(folder, name), "rb") as file:
                found, offset = npy_header(file)
                if found != (end - begin, *shape):
                    raise SweepError(f"{folder}/{name} has the shape {found}, but must have {(end - begin, *shape)}")
                file.seek(offset)
                shutil.copyfileobj(file, merged, 1 << 20)


def check_inputs(shards):
    """Shards of one sweep are made of one scene: also of the same meshes and robots."""
    first = next((done["inputs"] for _, done in shards if done["inputs"]), [])
    for target, done in shards:
        if done["inputs"] and done["inputs"] != first:
            raise SweepError(f"{target} was made of other inputs than the first shard: a file that the scene names has "
                             "changed meanwhile; remove the shards of before, or give --overwrite")


def merge(options, shards):
    check_inputs(shards)
    parts = list(parts_of(shards))
    whole = next((folder for _, _, folder, _ in parts if folder), None)
    if whole is None:
        raise SweepError("no row ran to its end: " + parts[0][3])
    merge_tables(parts, options, os.path.join(options.out, "scenes.csv"))
    for name in sorted(os.listdir(whole)):
        if name.endswith(".npy"):
            merge_arrays(parts, name, os.path.join(options.out, name))
        if name in ("trajectory_contacts.csv", "warnings.csv"):
            merge_rows(parts, name, os.path.join(options.out, name))
    with whole_file(os.path.join(options.out, "summary.csv"), newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["begin", "end", "seconds", "worker", "isolated"])
        for _, done in shards:
            rows.writerow([done["begin"], done["end"], done["seconds"], done["worker"], len(done["isolated"])])
