"""Prints the error of a run, whole and up to a horizon, from two series: RUN.csv REFERENCE.csv HORIZON_S."""
import csv, re, sys

run, truth = ([{k: float(v or 0) for k, v in row.items()} for row in csv.DictReader(open(path))] for path in sys.argv[1:3])
groups = {}  # the components of each rate, by its name
for column in truth[0]:
    part = re.fullmatch(r"(.+)_(omega|v|rate|tilt_rate)(?:_?([xyz]))?_(?:rad|m)_s", column)
    groups.setdefault(part[1] + part[2], []).append(column) if part else None
size = lambda row: sum(x * x for x in row) ** 0.5
scale = {g: max(size([t[c] for c in columns]) for t in truth) for g, columns in groups.items()}
seen = [g for g in groups if scale[g] > float(sys.argv[4]) * max(scale.values())]
apart = [(t["time_s"], max(size([r[c] - t[c] for c in groups[g]]) / scale[g] for g in seen)) for r, t in zip(run, truth)]
print(max(e for _, e in apart), max(e for time, e in apart if time <= float(sys.argv[3])))
