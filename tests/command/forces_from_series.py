"""Prints the errors of forces and peaks, whole and up to a horizon, from RUN.json RUN.csv REFERENCE.csv HORIZON_S."""
import csv, itertools, json, math, sys

FLOOR, KEPT = 1e-3, 12
AT_REST = 1e-6  # rad/s^2: bodies of these cases that turn at all have more than 1, others rounding
truth, run = json.load(open(sys.argv[1]))["runs"]
rows = [[{k: float(v or 0) for k, v in row.items()} for row in csv.DictReader(open(path))] for path in sys.argv[2:4]]
horizon = float(sys.argv[4])
unit = lambda joint: next("N_m" if "force_max_N_m" in j else "N" for j in [joint])
at_samples = {n: max(abs(r[f"{n}_force_{unit(j)}"]) for r in rows[1]) for n, j in truth["joints"].items()}
of_steps = {n: j[f"force_max_{unit(j)}"] for n, j in truth["joints"].items()}


def scale(sizes, name):
    like = max(sizes[n] for n, j in truth["joints"].items() if unit(j) == unit(truth["joints"][name]))
    return max(sizes[name], FLOOR * like) or 1.0


def peaks(joint, other, name):  # (end, error) of each group of contacts that overlap
    contacts = sorted((s["onset_s"], s["onset_s"] + s["duration_s"], which, s[f"force_max_{unit(joint)}"])
                      for which, j in enumerate([joint, other]) for s in j["spikes"])
    weakest = [min(s[f"force_max_{unit(j)}"] for s in j["spikes"]) if len(j["spikes"]) == KEPT else 0 for j in [joint, other]]
    ends = list(itertools.accumulate((c[1] for c in contacts), max))
    number = list(itertools.accumulate([0] + [onset > end for (onset, *_), end in zip(contacts[1:], ends)]))
    for _, group in itertools.groupby(zip(number, contacts), lambda pair: pair[0]):
        group = [contact for _, contact in group]
        most = [max((f for *_, which, f in group if which == side), default=None) for side in (0, 1)]
        lone = [max(0, m - weakest[1 - side]) for side, m in enumerate(most) if m is not None]
        yield max(c[1] for c in group), (lone[0] if None in most else abs(most[0] - most[1])) / scale(of_steps, name)


apart, peak = [], []
for name, joint in truth["joints"].items():
    if joint["has_play"]:
        column = f"{name}_force_{unit(joint)}"
        apart += [(t["time_s"], abs(r[column] - t[column]) / scale(at_samples, name)) for r, t in zip(*rows)]
        peak += peaks(run["joints"][name], joint, name)
until = [max((e for time, e in errors if time <= horizon * (1 + 1e-9)), default=0) for errors in (apart, peak)]
whole = [max((e for _, e in errors), default=0) for errors in (apart, peak)]
alpha = max((abs(body[key] - run["bodies"][n][key]) / max(abs(body["alpha_max_rad_s2"]), abs(body["alpha_min_rad_s2"]))
            for n, body in truth["bodies"].items() for key in ("alpha_max_rad_s2", "alpha_min_rad_s2")
            if max(abs(body["alpha_max_rad_s2"]), abs(body["alpha_min_rad_s2"])) > AT_REST), default=0)
print(whole[0], until[0], whole[1], until[1], alpha)
