"""The faults that scripts/mutate plants: how they are written down, found again and made."""

import collections
import glob
import os
import random
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LIST = "tests/mutations.txt"
SEPARATOR = "\t"
# What computes; a fault in a reader of files shows by other means.
FOLDERS = ("math", "geometry/distance", "geometry/mesh", "geometry/search", "geometry/meshing", "core",
           "elements", "solvers", "effects", "models")
# A pattern, what takes the place of its first group's match, and a name.
KINDS = [
    ("sign", r"(?<=[\w)\]]) (\+) (?=[\w(])", "-"),
    ("sign", r"(?<=[\w)\]]) (-) (?=[\w(])", "+"),
    ("sign of a sum", r" (\+=) ", "-="),
    ("sign of a sum", r" (-=) ", "+="),
    ("negation", r"(?:return|=|\() ?(-)(?=[a-zA-Z(])", ""),
    ("factor", r"\b(0\.5) \*", "0.25"),
    ("factor", r"\b(2\.0) \*", "1.0"),
    ("factor", r"\b(3\.0) \*", "2.0"),
    ("product", r"(?<=[\w)\]]) (\*) (?=[\w(])", "/"),
    ("off by one", r"(?<=\w)( \+ 1)\b(?!\.)", ""),
    ("off by one", r"(?<=\w)( - 1)\b(?!\.)", ""),
    ("bound", r"(?<=[\w)\]]) (<=) (?=[\w(])", "<"),
    ("bound", r"(?<=[\w)\]]) (<) (?=[\w(])(?!.*>)", "<="),
    ("comparison", r"(?<=[\w)\]]) (>) (?=[\w(])(?!.*<)", "<"),
    ("extreme", r"std::(max)\(", "min"),
    ("extreme", r"std::(min)\(", "max"),
    ("logic", r" (&&) ", "||"),
    ("logic", r" (\|\|) ", "&&"),
    ("answer", r"\breturn (true);", "false"),
    ("answer", r"\breturn (false);", "true"),
    ("skipped", r"^\s+(\w[\w.\[\]()>-]* \+= [^;{}]+;)$", ";"),
    ("skipped", r"^\s+((?:\w+\.)?\w+\([^;{}]*\);)$", ";"),
]

Entry = collections.namedtuple("Entry", "file line nth old new kind")


def fail(message, code=2):
    print("mutate: " + message, file=sys.stderr)
    sys.exit(code)


def path(*parts):
    return os.path.join(ROOT, *parts)


def lines_of(name):
    with open(path(name), encoding="utf-8") as file:
        return file.read().split("\n")


def entries_of_list():
    entries = []
    for number, line in enumerate(lines_of(LIST), 1):
        if not line or line.startswith("#"):
            continue
        fields = line.split(SEPARATOR)
        if len(fields) != 6:
            fail("%s:%d: 6 fields between tabs are expected, there are %d" % (LIST, number, len(fields)))
        entries.append(Entry(fields[0], fields[1], int(fields[2]), fields[3], fields[4], fields[5]))
    return entries


def place_of(entry):
    """(number of the line, its text with the fault), or None where it is no longer there."""
    if not os.path.exists(path(entry.file)):
        return None
    lines = lines_of(entry.file)
    same = [k for k, line in enumerate(lines) if line.strip() == entry.line]
    if entry.nth >= len(same):
        return None
    line = lines[same[entry.nth]]
    column, text = entry.old.split("@", 1)
    start = len(line) - len(line.lstrip()) + int(column)
    if line[start:start + len(text)] != text:
        return None
    return same[entry.nth], line[:start] + entry.new + line[start + len(text):]


def places_in(name):
    """All faults that can be planted in a file."""
    found, seen = [], collections.Counter()
    is_comment = False
    for line in lines_of(name):
        text = line.strip()
        nth = seen[text]
        seen[text] += 1
        is_comment = text.startswith(("//", "#", "/*", "*"))
        # What only guards, names or allocates is no physics.
        if is_comment or re.search(r"\b(assert|throw|fmt::|reserve|resize|InputError|template|std::string)\b",
                                   text):
            continue
        code = line.split("//")[0].rstrip()
        for kind, pattern, new in KINDS:
            for match in re.finditer(pattern, code):
                if '"' in code[:match.start(1)]:
                    continue
                column = match.start(1) - (len(line) - len(line.lstrip()))
                found.append(Entry(name, text, nth, "%d@%s" % (column, match.group(1)), new, kind))
    return found


def generate(count):
    """Keeps the faults of the list that can be planted still, and adds others by chance."""
    files = sorted(name for folder in FOLDERS for name in glob.glob(
        os.path.join("src/pliant", folder, "**", "*.cpp"), root_dir=ROOT, recursive=True))
    chance = random.Random(1)
    by_kind = collections.defaultdict(list)
    for name in files:
        for entry in places_in(name):
            by_kind[entry.kind].append(entry)
    chosen = {entry for entry in entries_of_list() if place_of(entry) is not None}
    # As many of each kind, of files by chance; no line twice.
    kinds = sorted(by_kind)
    for kind in kinds:
        chance.shuffle(by_kind[kind])
    taken = {(entry.file, entry.line, entry.nth) for entry in chosen}
    while len(chosen) < count and any(by_kind.values()):
        for kind in kinds:
            while by_kind[kind]:
                entry = by_kind[kind].pop()
                if (entry.file, entry.line, entry.nth) not in taken:
                    taken.add((entry.file, entry.line, entry.nth))
                    chosen.add(entry)
                    break
            if len(chosen) == count:
                break
    lines = ["# Faults that scripts/mutate plants, one a line, between tabs: file, text of the line, which of",
             "# the equal lines (from 0), column@what is replaced, by what, kind. Made by scripts/mutate",
             "# --generate; the kinds `named` were added by hand."]
    lines += [SEPARATOR.join(str(field) for field in entry) for entry in sorted(chosen)]
    with open(path(LIST), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
    print("%d faults in %d files: %s" % (len(chosen), len({e.file for e in chosen}), LIST))


def check(entries, least):
    gone = [entry for entry in entries if place_of(entry) is None]
    for entry in gone:
        print("%s: no longer there: %s" % (entry.file, entry.line), file=sys.stderr)
    left = len(entries) - len(gone)
    print("%d of %d faults can be planted" % (left, len(entries)))
    if left < least:
        print("mutate: at least %d are wanted: make the list anew by scripts/mutate --generate" % least,
              file=sys.stderr)
    return 1 if left < least else 0
