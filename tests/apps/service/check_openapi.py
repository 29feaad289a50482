"""Hold a running service to its own description.

usage: check_openapi.py PORT SCAN QUERY ROUTES
SCAN     a depth image of which the service recognizes something
QUERY    the parameters that it is recognized with
ROUTES   the folder of the sources that have the tables of routes
"""
import http.client
import json
import pathlib
import re
import sys
import time

import jsonschema

port, scan_file, query, routes_folder = int(sys.argv[1]), sys.argv[2], sys.argv[3], sys.argv[4]
scan = open(scan_file, "rb").read()
faults = []


def fault(text):
    faults.append(text)


def ask(method, target, body=None, headers=None):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request(method, target, body, headers or {})
    answer = connection.getresponse()
    return answer.status, answer.getheader("Content-Type"), answer.read(), answer


document = json.loads(ask("GET", "/v1/openapi.json")[2])
components = document["components"]


def resolve(node):
    while "$ref" in node:
        at = document
        for key in node["$ref"].removeprefix("#/").split("/"):
            at = at[key]
        node = at
    return node


def validator(schema):
    return jsonschema.Draft202012Validator({**schema, "components": components})


def check_document():
    def walk(node, path):
        if isinstance(node, dict):
            if "$ref" in node:
                try:
                    resolve(node)
                except KeyError:
                    fault(f"{path}: {node['$ref']} is not there")
            for key, value in node.items():
                walk(value, f"{path}/{key}")
        elif isinstance(node, list):
            for index, value in enumerate(node):
                walk(value, f"{path}/{index}")

    walk(document, "")
    for name, schema in components["schemas"].items():
        jsonschema.Draft202012Validator.check_schema(schema)
        if "example" in schema:
            for error in validator(schema).iter_errors(schema["example"]):
                fault(f"example of {name}: {error.message}")
    for name, parameter in components["parameters"].items():
        schema = parameter["schema"]
        for value in [schema[k] for k in ("default",) if k in schema] + [parameter[k] for k in ("example",) if k in parameter]:
            if list(validator(schema).iter_errors(value)):
                fault(f"parameter {name}: {value} breaks its own schema")
    ids = [op["operationId"] for path in document["paths"].values() for op in path.values()]
    if len(ids) != len(set(ids)):
        fault("an operationId is there twice")


def check_routes():
    """Every route of the program is described, and the other way round."""
    files = sorted(pathlib.Path(routes_folder).glob("*_routes.cpp"))
    sources = "".join(file.read_text() for file in files)
    routes = re.findall(r'\{"(GET|POST|PUT|PATCH|DELETE)", "(/[^"]*)", (true|false), ', sources)
    if len(routes) < 10:
        fault(f"{routes_folder}: expected a table of routes")
    described = {(method.upper(), path) for path, ops in document["paths"].items() for method in ops}
    for method, path, is_prefix in routes:
        fits = lambda text: text.startswith(path) if is_prefix == "true" else text == path
        if path != "/" and not any(m == method and fits(p) for m, p in described):
            fault(f"{method} {path} is not described")
    for method, path in described:
        if not any(m == method and path != "/" and p != "/" and
                   (path.startswith(p) if is_prefix == "true" else path == p) for m, p, is_prefix in routes):
            fault(f"{method} {path} is described, but no route")


answered = {}


def expect(status, method, template, target=None, body=None, headers=None):
    """The answer has this status, and the description allows all of it."""
    target = target or template
    got, content_type, content, answer = ask(method, target, body, headers)
    where = f"{method} {target[:80]} -> {got}"
    answered.setdefault((method, template), set()).add(got)
    if got != status:
        fault(f"{where}, expected {status}: {content[:200]}")
    responses = document["paths"][template][method.lower()]["responses"]
    if str(got) not in responses:
        return fault(f"{where}: the status is not described")
    response = resolve(responses[str(got)])
    kind = content_type.split(";")[0]
    if kind not in response["content"]:
        return fault(f"{where}: {kind} is not described")
    for name, header in response.get("headers", {}).items():
        if not answer.getheader(name) and header.get("required", True):
            fault(f"{where}: expected the header {name}")
    if kind == "application/json":
        for error in validator(response["content"][kind]["schema"]).iter_errors(json.loads(content)):
            fault(f"{where}: {'/'.join(map(str, error.path))}: {error.message[:200]}")
    elif not content:
        fault(f"{where}: expected a body")
    return content


def when(method, template, is_so):
    """The answer as soon as it is so."""
    for _ in range(600):
        answer = json.loads(expect(200, method, template))
        if is_so(answer):
            return answer
        time.sleep(0.1)
    fault(f"{template} never came to what was waited for")
    return answer


def check_parts():
    part, model = "/v1/parts/{name}", "/v1/models/{name}"
    mesh = ask("GET", "/v1/models/" + json.loads(ask("GET", "/v1/models")[2])["models"][0]["name"] + "/mesh.ply")[2]
    new = "/v1/parts/new?file=new.ply&unit="
    expect(202, "PUT", part, new + "m", mesh)
    expect(400, "PUT", part, new + "inch", mesh)
    trained = when("GET", "/v1/parts", lambda answer: answer["parts"][0]["state"] == "trained")["parts"][0]
    expect(200, "GET", part + "/mesh.ply", "/v1/parts/new/mesh.ply")
    expect(404, "GET", part + "/mesh.ply", "/v1/parts/old/mesh.ply")
    expect(200, "GET", part + "/near-symmetry", "/v1/parts/new/near-symmetry")
    expect(404, "GET", part + "/near-symmetry", "/v1/parts/old/near-symmetry")
    expect(400, "PATCH", part, "/v1/parts/new")
    declared = {"declaration": trained["model"]["symmetry"]["declaration"]}
    expect(202, "PATCH", part, "/v1/parts/new", json.dumps(declared))
    when("GET", "/v1/parts", lambda answer: answer["parts"][0]["state"] == "trained")
    expect(200, "PUT", model, "/v1/models/new")
    expect(409, "PUT", model, "/v1/models/new")
    expect(200, "PATCH", model, "/v1/models/new?name=newer")
    expect(200, "DELETE", model, "/v1/models/newer")
    expect(409, "DELETE", model, "/v1/models/newer")
    expect(202, "PUT", part, new + "mm", b"no mesh")
    expect(202, "DELETE", part, "/v1/parts/new")
    expect(404, "DELETE", part, "/v1/parts/new")


def check_live(scan):
    with open("in/scan.png", "wb") as file:
        file.write(scan)
    when("GET", "/v1/live", lambda answer: answer["scans"])
    for what in ("answer", "scan"):
        template = "/v1/live/{number}/" + what
        expect(200, "GET", template, template.replace("{number}", "1"))
        expect(404, "GET", template, template.replace("{number}", "9"))


def check_robot_poses(detections):
    """All conventions that have a label, those alone, and both kinds of doubts."""
    words = json.loads(expect(200, "GET", "/v1/words"))
    described = components["schemas"]["RobotRequest"]["properties"]["convention"]["enum"]
    if list(words["robot_conventions"]) != described:
        fault(f"expected words for {described}")
    far = [[1, 0, 0, 900], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    asked = {"scene": "scan", "unit": "m", "frame": {"name": "robot", "T_robot_scene": far},
             "grasps": {one["model"]: {"top": far} for one in detections}, "detections": detections}
    for convention in described:
        expect(200, "POST", "/v1/robot-poses", body=json.dumps(asked | {"convention": convention}))
    expect(400, "POST", "/v1/robot-poses", body=json.dumps(asked | {"convention": "plc"}))
    expect(400, "POST", "/v1/robot-poses", body="[]")


def check_answers():
    recognize = "/v1/recognize?" + query
    found = json.loads(expect(200, "POST", "/v1/recognize", recognize, scan))
    if not found["scenes"][0]["detections"]:
        fault("expected detections, or nothing is tested")
    expect(200, "POST", "/v1/recognize", recognize + "&rejected=9", scan)
    edge = "--edge\r\nContent-Disposition: form-data; name=scene; filename="
    form = edge.encode() + b"a.png\r\n\r\n" + scan + b"\r\n" + edge.encode() + b"b.png\r\n\r\n" + scan + b"\r\n--edge--\r\n"
    unformatted = re.sub("format=[a-z]+&?", "", query)
    multipart = {"Content-Type": "multipart/form-data; boundary=edge"}
    expect(200, "POST", "/v1/recognize", "/v1/recognize?" + unformatted, form, multipart)
    expect(400, "POST", "/v1/recognize", recognize + "&min-score=2", scan)
    expect(415, "POST", "/v1/recognize", recognize, scan, {"Content-Encoding": "br"})
    expect(504, "POST", "/v1/recognize", recognize, scan, {"X-Deadline-Ms": "0.1"})
    expect(431, "GET", "/v1/models", headers={"X-Long": "x" * 9000})
    reading = re.sub("method=[a-z]+&?", "", query)
    expect(200, "POST", "/v1/points", "/v1/points?max-points=1000&" + reading, scan)
    expect(400, "POST", "/v1/points", "/v1/points?max-points=0&" + reading, scan)
    models = json.loads(expect(200, "GET", "/v1/models"))["models"]
    for view in ("thumbnail", "mesh"):
        template = "/v1/models/{name}/" + models[0][view].rsplit("/", 1)[1]
        expect(200, "GET", template, models[0][view])
        expect(404, "GET", template, template.replace("{name}", "spoon"))
    near = "/v1/models/{name}/near-symmetry"
    expect(200, "GET", near, near.replace("{name}", models[0]["name"]))
    expect(404, "GET", near, near.replace("{name}", "spoon"))
    examples = json.loads(expect(200, "GET", "/v1/examples"))["examples"]
    expect(200, "GET", "/v1/examples/{number}", examples[0]["url"])
    expect(404, "GET", "/v1/examples/{number}", "/v1/examples/99")
    expect(200, "GET", "/v1/score-parts")
    check_robot_poses(found["scenes"][0]["detections"])
    check_parts()
    check_live(scan)
    kept, truth = "/v1/session/scans/{scan}", "/v1/session/scans/{scan}/truth"
    answer, run = "/v1/session/runs/{run}/{scan}", "/v1/session/runs/{run}"
    expect(200, "PUT", kept, "/v1/session/scans/a?" + reading, scan)
    expect(409, "PUT", kept, "/v1/session/scans/a?" + reading, scan)
    expect(400, "PUT", kept, "/v1/session/scans/.a?" + reading, scan)
    expect(200, "GET", kept, "/v1/session/scans/a")
    expect(200, "PUT", answer, "/v1/session/runs/A/a", json.dumps(found))
    expect(200, "GET", answer, "/v1/session/runs/A/a")
    right = [{key: one[key] for key in ("model", "T_scene_model")} for one in found["scenes"][0]["detections"]]
    expect(200, "PUT", truth, "/v1/session/scans/a/truth", json.dumps({"truth": right}))
    expect(404, "PUT", truth, "/v1/session/scans/b/truth", '{"truth": null}')
    stale = {"If-Match": '"of before"'}
    expect(409, "PUT", truth, "/v1/session/scans/a/truth", json.dumps({"truth": right}), stale)
    expect(409, "PUT", answer, "/v1/session/runs/A/a", json.dumps(found), stale)
    expect(200, "GET", "/v1/session")
    expect(200, "GET", "/v1/session/archive")
    expect(200, "DELETE", run, "/v1/session/runs/A")
    expect(404, "DELETE", run, "/v1/session/runs/A")
    expect(200, "DELETE", kept, "/v1/session/scans/a")
    expect(200, "GET", "/v1/openapi.json")
    expect(200, "POST", "/v1/library/reload")
    expect(200, "GET", "/v2")
    expect(200, "GET", "/v2/health/live")
    expect(200, "GET", "/v2/health/ready")
    expect(200, "GET", "/v2/models/stats")
    expect(200, "POST", "/v2/repository/index")
    expect(200, "POST", "/v2/repository/index", body='{"ready": true}')
    expect(400, "POST", "/v2/repository/index", body="[]")
    models = json.loads(ask("GET", "/v1/models")[2])
    library = "/v2/models/" + models["library"].rsplit(".", 1)[0]
    version = f"/versions/{models['generation']}"
    points = {"name": "points", "datatype": "FP32", "shape": [1, 3], "data": [0, 0, 1]}
    for described, path in (("", ""), ("/versions/{version}", version)):
        template, path = "/v2/models/{library}" + described, library + path
        expect(200, "GET", template, path)
        expect(404, "GET", template, path.replace(library, "/v2/models/spoon"))
        for view in ("/ready", "/config", "/stats"):
            expect(200, "GET", template + view, path + view)
        asked = {"id": "7", "parameters": {"method": "ppf", "timeout": 0}, "inputs": [points]}
        infer = template + "/infer"
        expect(200, "POST", infer, path + "/infer", json.dumps(asked))
        asked["parameters"]["binary_data_output"] = True
        expect(200, "POST", infer, path + "/infer", json.dumps(asked))
        asked["outputs"] = [{"name": "scores", "parameters": {"binary_data": False}}]
        expect(200, "POST", infer, path + "/infer", json.dumps(asked))
        asked["outputs"] = [{"name": "spoons"}]
        expect(400, "POST", infer, path + "/infer", json.dumps(asked))
    expect(200, "GET", "/metrics")
    for path, operations in document["paths"].items():
        for method in operations:
            if not answered.get((method.upper(), path), set()) & {200, 202}:
                fault(f"{method} {path} was not asked")


check_document()
check_routes()
check_answers()
print("\n".join(faults))
sys.exit(1 if faults else 0)
