#!/usr/bin/env python3
"""The errors and scores of the BOP benchmark, written plainly from their definitions.

usage: bop_metrics.py CASE.json        prints the numbers as JSON

The case holds models, scenes with their truth and detections, and depth images as numbers. Nothing
here is shared with the program: rays are cast at every triangle, errors are computed for every
vertex and symmetry, precision for every recall. Needs numpy (Debian: python3-numpy).
"""
import json
import math
import sys

try:
    import numpy as np
except ImportError:
    sys.exit("bop_metrics.py needs numpy: apt-get install python3-numpy")

SHARES = np.arange(0.05, 0.51, 0.05)  # shares of the diameter, and of VSD's pixels
PIXELS = np.arange(5, 51, 5)
MILLIMETRES = np.arange(2, 21, 2)
RECALLS = np.linspace(0, 1, 101)
NUDGE = 1e-3  # pixels: how far a ray may be off by rounding
MIN_VISIBLE = 0.1
MAX_ESTIMATES = 100


def turn(axis, angle):
    """Rotation matrix from axis and angle (Rodrigues)."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def symmetries(model):
    """All motions that map the model onto itself, 4x4."""
    discrete = [np.eye(4)] + [np.array(s) for s in model["symmetries"]]
    if model["axis"] is None:
        return discrete
    point = np.array(model["axis"]["point"])
    steps = math.ceil(math.pi / 0.01)
    motions = []
    for i in range(steps):
        motion = np.eye(4)
        motion[:3, :3] = turn(model["axis"]["direction"], 2 * math.pi * i / steps)
        motion[:3, 3] = point - motion[:3, :3] @ point
        motions += [motion @ first for first in discrete]
    return motions


def moved(pose, points):
    return points @ pose[:3, :3].T + pose[:3, 3]


def image(camera, points):
    return np.stack([camera["fx"] * points[:, 0] / points[:, 2] + camera["cx"],
                     camera["fy"] * points[:, 1] / points[:, 2] + camera["cy"]], axis=1)


def mssd(model, estimate, truth):
    at = moved(estimate, model["vertices"])
    return min(np.linalg.norm(at - moved(truth @ s, model["vertices"]), axis=1).max()
               for s in model["motions"])


def mspd(model, camera, estimate, truth):
    at = image(camera, moved(estimate, model["vertices"]))
    return min(np.linalg.norm(at - image(camera, moved(truth @ s, model["vertices"])), axis=1).max()
               for s in model["motions"])


def rays(camera, width, height, shift=(0, 0)):
    u, v = np.meshgrid(np.arange(width) + shift[0], np.arange(height) + shift[1])
    return np.stack([(u - camera["cx"]) / camera["fx"], (v - camera["cy"]) / camera["fy"],
                     np.ones_like(u, dtype=float)], axis=-1)


def cast(corners, directions):
    """Distances along the rays (pixels x 3) from the origin to the nearest of the triangles, or 0."""
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    # t d = a + p ab + q ac, by Cramer's rule, for every pixel and triangle.
    normal = np.cross(ab, ac)
    det = directions @ normal.T
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.sum(a * normal, axis=1) / det
        p = -(directions @ np.cross(a, ac).T) / det
        q = (directions @ np.cross(a, ab).T) / det
        hit = (det != 0) & (p >= 0) & (q >= 0) & (p + q <= 1) & (t > 0)
    t = np.where(hit, t, np.inf).min(axis=1, initial=np.inf)
    length = np.linalg.norm(directions, axis=1)
    return np.where(np.isfinite(t), t * length, 0.0)


def render(model, pose, scene):
    """Distance map of the model alone, and the pixels whose value hangs on rounding."""
    vertices = moved(pose, model["vertices"])
    assert (vertices[:, 2] > 0).all(), "the cases hold nothing beside or behind the camera"
    at = image(scene["camera"], vertices)
    u, v = np.meshgrid(np.arange(scene["width"]), np.arange(scene["height"]))
    near = np.stack([u, v], axis=-1).reshape(-1, 2)
    near = ((near > at.min(axis=0) - 1) & (near < at.max(axis=0) + 1)).all(axis=1)
    corners = vertices[model["triangles"]]
    maps = []
    for shift in ((0, 0), (-NUDGE, -NUDGE), (-NUDGE, NUDGE), (NUDGE, -NUDGE), (NUDGE, NUDGE)):
        d = rays(scene["camera"], scene["width"], scene["height"], shift)
        maps.append(np.zeros(near.size))
        maps[-1][near] = cast(corners, d.reshape(-1, 3)[near])
    maps = np.array(maps)
    unsure = maps.max(axis=0) - maps.min(axis=0) > 0.01 * model["diameter"]
    return maps[0], unsure


def vsd(model, scene, estimate, truth, delta):
    """Errors for all tolerances, and how much each may change when unsure pixels do."""
    d_e, unsure_e = estimate
    d_g, unsure_g = truth
    d_i = scene["distance"]
    near = 1e-5 * model["diameter"]
    visible_g = (d_g > 0) & ((d_i == 0) | (d_g - d_i <= delta))
    visible_e = (d_e > 0) & ((d_i == 0) | (d_e - d_i <= delta) | visible_g)
    unsure = unsure_e | unsure_g
    for d in (d_e, d_g):
        unsure = unsure | ((d > 0) & (d_i > 0) & (abs(d - d_i - delta) < near))
    both, either = visible_g & visible_e, visible_g | visible_e
    errors, slacks = [], []
    for tau in SHARES:
        apart = abs(d_e - d_g) / model["diameter"]
        wrong = np.count_nonzero(both & (apart >= tau)) + np.count_nonzero(either & ~both)
        errors.append(wrong / np.count_nonzero(either) if either.any() else 1.0)
        doubtful = np.count_nonzero(unsure | (both & (abs(apart - tau) < 1e-5)))
        slacks.append(doubtful / max(1, np.count_nonzero(either) - doubtful))
    return errors, slacks


def share_seen(truth):
    if truth["visible_fraction"] is not None:
        return truth["visible_fraction"]
    return 0 if truth["ignore"] else 1


def greedy(estimates, truths, error, threshold):
    """Pairs estimate -> truth: in the estimates' order, each with the best that is free."""
    pairs = {}
    for e in estimates:
        free = [t for t in truths if t not in pairs.values() and error[e, t] < threshold]
        if free:
            pairs[e] = min(free, key=lambda t: error[e, t])  # the first of equals
    return pairs


def average_precision(answers, num_targets):
    """answers: (score, right) in the order of the images."""
    answers = sorted(answers, key=lambda answer: -answer[0])
    right = np.cumsum([answer[1] for answer in answers])
    recall = right / num_targets
    precision = right / np.arange(1, len(answers) + 1)
    return float(np.mean([max([p for p, r in zip(precision, recall) if r >= at], default=0)
                          for at in RECALLS]))


def measure(case):
    """Errors of every detection to every truth of its model, by scene."""
    delta = case["delta_mm"] / case["unit_mm"]
    for model in case["models"].values():
        model["vertices"] = np.array(model["vertices"])
        model["triangles"] = np.array(model["triangles"], dtype=int).reshape(-1, 3)
        model["motions"] = symmetries(model)
    for scene in case["scenes"]:
        for thing in scene["truth"] + scene["detections"]:
            thing["pose"] = np.array(thing["pose"])
        camera, has_depth = scene["camera"], scene["depth"] is not None
        if has_depth:
            z = np.array(scene["depth"])
            d = rays(camera, scene["width"], scene["height"]).reshape(-1, 3)
            scene["distance"] = z * np.linalg.norm(d, axis=1)
            for thing in scene["truth"] + scene["detections"]:
                thing["map"] = render(case["models"][thing["model"]], thing["pose"], scene)
        scene["mssd"], scene["mspd"], scene["vsd"], scene["slack"] = {}, {}, {}, {}
        for e, found in enumerate(scene["detections"]):
            model = case["models"][found["model"]]
            for t, truth in enumerate(scene["truth"]):
                if truth["model"] != found["model"]:
                    continue
                scene["mssd"][e, t] = mssd(model, found["pose"], truth["pose"])
                if not has_depth:
                    continue
                scene["mspd"][e, t] = 640 / scene["width"] * mspd(model, camera, found["pose"],
                                                                  truth["pose"])
                if len(model["triangles"]):
                    scene["vsd"][e, t], scene["slack"][e, t] = vsd(model, scene, found["map"],
                                                                   truth["map"], delta)


def by_score(scene, name):
    mine = [e for e, found in enumerate(scene["detections"]) if found["model"] == name]
    return sorted(mine, key=lambda e: -scene["detections"][e]["score"])


def localization(case):
    totals = {"mssd": 0, "mspd": 0, "vsd": 0}
    found = {"mssd": np.zeros(10), "mspd": np.zeros(10), "vsd": np.zeros((10, 10))}
    open_matches = 0
    for scene in case["scenes"]:
        for name in case["scored"]:
            model = case["models"][name]
            truths = [t for t, truth in enumerate(scene["truth"]) if truth["model"] == name]
            if scene["targets"] is None:
                wanted = sum(share_seen(scene["truth"][t]) >= MIN_VISIBLE for t in truths)
            else:
                wanted = scene["targets"].get(name, 0)
            truths = sorted(truths, key=lambda t: -share_seen(scene["truth"][t]))[:wanted]
            truths.sort()
            estimates = by_score(scene, name)[:wanted]
            totals["mssd"] += len(truths)
            shares = {pair: error / model["diameter"] for pair, error in scene["mssd"].items()}
            for k in range(10):
                found["mssd"][k] += len(greedy(estimates, truths, shares, SHARES[k]))
            if scene["depth"] is None:
                continue
            totals["mspd"] += len(truths)
            for k in range(10):
                found["mspd"][k] += len(greedy(estimates, truths, scene["mspd"], PIXELS[k]))
            if not len(model["triangles"]):
                continue
            totals["vsd"] += len(truths)
            for i in range(10):
                errors = {pair: error[i] for pair, error in scene["vsd"].items()}
                for k in range(10):
                    found["vsd"][i, k] += len(greedy(estimates, truths, errors, SHARES[k]))
                    open_matches += sum(scene["slack"][e, t][i] > 0 and
                                        abs(errors[e, t] - SHARES[k]) <= scene["slack"][e, t][i]
                                        for e in estimates for t in truths)
    recalls = {kind: float(np.mean(found[kind])) / totals[kind] if totals[kind] else None
               for kind in totals}
    recalls["num_targets"] = totals["mssd"]
    recalls["vsd_slack"] = open_matches / 100 / max(1, totals["vsd"])
    return recalls


def detection(case):
    absent, kept = 0, []
    for scene in case["scenes"]:
        scored = [e for e, found in enumerate(scene["detections"]) if found["model"] in case["scored"]]
        scored.sort(key=lambda e: -scene["detections"][e]["score"])
        kept.append(set(scored[:MAX_ESTIMATES]))
        present = {truth["model"] for truth in scene["truth"]}
        absent += sum(scene["detections"][e]["model"] not in present for e in kept[-1])

    def precision(name, kind, scale, thresholds):
        scenes = [(scene, best) for scene, best in zip(case["scenes"], kept)
                  if kind == "mssd" or scene["depth"] is not None]
        seen = sum(truth["model"] == name and share_seen(truth) >= MIN_VISIBLE
                   for scene, _ in scenes for truth in scene["truth"])
        if seen == 0:
            return None
        values = []
        for threshold in thresholds:
            answers = []
            for scene, best in scenes:
                truths = [t for t, truth in enumerate(scene["truth"]) if truth["model"] == name]
                if not truths:
                    continue
                estimates = [e for e in by_score(scene, name) if e in best]
                error = {pair: value * scale for pair, value in scene[kind].items()}
                pairs = greedy(estimates, truths, error, threshold)
                for e in estimates:
                    if e in pairs and share_seen(scene["truth"][pairs[e]]) < MIN_VISIBLE:
                        continue
                    answers.append((scene["detections"][e]["score"], e in pairs))
            values.append(average_precision(answers, seen))
        return np.mean(values)

    def mean(kind, scale_of, thresholds):
        values = [precision(name, kind, scale_of(case["models"][name]), thresholds)
                  for name in case["scored"]]
        values = [value for value in values if value is not None]
        return float(np.mean(values)) if values else None

    return {"num_absent": absent,
            "mssd": mean("mssd", lambda model: 1 / model["diameter"], SHARES),
            "mspd": mean("mspd", lambda model: 1, PIXELS),
            "mssd_mm": mean("mssd", lambda model: case["unit_mm"], MILLIMETRES)}


def nearest(scene, e):
    """The errors of a detection to the truth it is nearest to by MSSD, or None."""
    pairs = [pair for pair in scene["mssd"] if pair[0] == e]
    if not pairs:
        return None
    pair = min(pairs, key=lambda p: scene["mssd"][p])
    return {"truth": pair[1], "mssd": scene["mssd"][pair], "mspd": scene["mspd"].get(pair),
            "vsd": scene["vsd"].get(pair), "vsd_slack": scene["slack"].get(pair)}


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        case = json.load(file)
    measure(case)
    errors = [[nearest(scene, e) for e in range(len(scene["detections"]))]
              for scene in case["scenes"]]
    json.dump({"localization": localization(case), "detection": detection(case), "errors": errors},
              sys.stdout)


if __name__ == "__main__":
    main()
