#!/usr/bin/env python3
"""Recognize an array of points by the Open Inference Protocol, with binary tensors. Needs numpy.

usage: infer.py POINTS.npy [--url http://127.0.0.1:8080] [NAME=VALUE ...]      an array [N, 3]
"""
import argparse
import json
import urllib.request

import numpy as np


def infer(url, points, parameters):
    """Find models in points [N, 3]. Returns poses [M, 4, 4], scores [M] and names."""
    points = np.ascontiguousarray(points, dtype="<f4")
    header = json.dumps({
        "parameters": {"binary_data_output": True, **parameters},
        "inputs": [{"name": "points", "datatype": "FP32", "shape": list(points.shape),
                    "parameters": {"binary_data_size": points.nbytes}}],
    }).encode()
    with urllib.request.urlopen(f"{url}/v1/models") as answer:
        library = json.load(answer)["library"].rsplit(".", 1)[0]
    request = urllib.request.Request(f"{url}/v2/models/{library}/infer", header + points.tobytes(),
                                     {"Content-Type": "application/octet-stream",
                                      "Inference-Header-Content-Length": str(len(header))})
    with urllib.request.urlopen(request) as answer:
        size = int(answer.headers["Inference-Header-Content-Length"])
        header, tensors = json.loads(answer.read(size)), answer.read()
    outputs = {}
    for output in header["outputs"]:
        size = output["parameters"]["binary_data_size"]
        data, tensors = tensors[:size], tensors[size:]
        if output["datatype"] == "FP32":
            outputs[output["name"]] = np.frombuffer(data, "<f4").reshape(output["shape"])
            continue
        texts = []  # each behind its length in four bytes
        while data:
            end = 4 + int.from_bytes(data[:4], "little")
            texts.append(data[4:end].decode())
            data = data[end:]
        outputs[output["name"]] = texts
    return outputs["poses"], outputs["scores"], outputs["models"]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("points")
    parser.add_argument("parameters", nargs="*", metavar="NAME=VALUE")
    parser.add_argument("--url", default="http://127.0.0.1:8080")
    arguments = parser.parse_intermixed_args()
    options = dict(pair.split("=", 1) for pair in arguments.parameters)
    for pose, score, model in zip(*infer(arguments.url, np.load(arguments.points), options)):
        print(f"{model:20} {score:6.3f} {pose[0, 3]:10.4f} {pose[1, 3]:10.4f} {pose[2, 3]:10.4f}")
