#!/usr/bin/env python3
"""Recognize a scan and print what was found. Needs Python 3 alone.

usage: recognize.py SCAN [--url http://127.0.0.1:8080] [--deadline SECONDS] [NAME=VALUE ...]
as:    recognize.py scan.ply min-score=0.9
       recognize.py depth.png camera=525,525,319.5,239.5,0.001
The parameters are those of /v1/openapi.json.
"""
import argparse
import json
import sys
import time
import urllib.error
import urllib.parse
import urllib.request


def recognize(url, scan, file_format, parameters, deadline_s):
    """Post a scan; returns the answer. A busy service is asked again until the deadline.

    Raises RuntimeError with the service's reason.
    """
    query = urllib.parse.urlencode({"format": file_format, **parameters}, safe=",")
    end = time.monotonic() + deadline_s
    while True:
        left = end - time.monotonic()
        if left <= 0:
            raise RuntimeError(f"no answer within {deadline_s} s")
        request = urllib.request.Request(f"{url}/v1/recognize?{query}", scan,
                                         {"Content-Type": "application/octet-stream", "X-Deadline-Ms": str(1000 * left)})
        try:
            with urllib.request.urlopen(request, timeout=left + 1) as answer:
                return json.load(answer)
        except urllib.error.HTTPError as error:
            reason = json.load(error)["error"]
            if error.code != 503:
                raise RuntimeError(f"{error.code}: {reason}") from None
            time.sleep(min(float(error.headers.get("Retry-After", 1)), max(0, end - time.monotonic())))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scan")
    parser.add_argument("parameters", nargs="*", metavar="NAME=VALUE")
    parser.add_argument("--url", default="http://127.0.0.1:8080")
    parser.add_argument("--deadline", type=float, default=30, metavar="SECONDS")
    arguments = parser.parse_intermixed_args()
    parameters = dict(pair.split("=", 1) for pair in arguments.parameters)
    with open(arguments.scan, "rb") as file:
        scan = file.read()
    try:
        answer = recognize(arguments.url, scan, arguments.scan.rsplit(".", 1)[-1].lower(), parameters,
                           arguments.deadline)
    except (RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
    print(f"{'model':20} {'score':>6} {'x':>10} {'y':>10} {'z':>10}")
    for found in answer["scenes"][0]["detections"]:
        x, y, z = (row[3] for row in found["T_scene_model"][:3])
        print(f"{found['model']:20} {found['score']:6.3f} {x:10.4f} {y:10.4f} {z:10.4f}")


if __name__ == "__main__":
    main()
