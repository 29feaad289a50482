"""The bill of materials that scripts/sbom writes of the built program. TRIVET_PROGRAM names it, in the folder of its build."""

import json
import os
import pathlib
import subprocess

import pytest

SOURCES = pathlib.Path(__file__).parents[2]
PROGRAM = pathlib.Path(os.environ["TRIVET_PROGRAM"])
LOCK_FILE = SOURCES / "web/package-lock.json"
pytestmark = pytest.mark.skipif(not pathlib.Path("/var/lib/dpkg/status").exists(), reason="not a system of Debian")


def write(file):
    subprocess.run([SOURCES / "scripts/sbom", PROGRAM.parents[1], "trivet", "0.1.0", PROGRAM, file, LOCK_FILE], check=True)
    return file.read_bytes()


@pytest.fixture(scope="module")
def bill(tmp_path_factory):
    return json.loads(write(tmp_path_factory.mktemp("sbom") / "bill.json"))


def use_of(bill, name):
    return [component["properties"][-1]["value"] for component in bill["components"] if component["name"] == name]


def test_has_the_form_of_cyclonedx(bill):
    assert (bill["bomFormat"], bill["specVersion"], bill["version"]) == ("CycloneDX", "1.5", 1)
    assert bill["serialNumber"].startswith("urn:uuid:")
    root = bill["metadata"]["component"]
    assert (root["type"], root["name"], root["version"]) == ("application", "trivet", "0.1.0")
    references = [component["bom-ref"] for component in bill["components"]]
    assert len(set(references)) == len(references)
    for component in bill["components"]:
        assert component["type"] == "library" and component["name"] and component["version"]
        assert component["purl"].startswith(("pkg:deb/debian/", "pkg:npm/")) and "+" not in component["purl"]
    (dependencies,) = bill["dependencies"]
    assert dependencies["ref"] == root["bom-ref"] and set(dependencies["dependsOn"]) <= set(references)


def test_names_what_is_linked_compiled_in_and_bundled(bill):
    assert use_of(bill, "libhdf5-103-1") == ["linked"]
    assert use_of(bill, "libeigen3-dev") == ["compiled in"]
    assert use_of(bill, "three") == ["bundled in the page"]
    assert not use_of(bill, "vite") and not use_of(bill, "libgtest-dev")


def test_reads_versions_from_the_system_and_from_npm(bill):
    version = subprocess.run(["dpkg-query", "--show", "--showformat=${Version}", "libfmt9"], check=True, capture_output=True, text=True)
    three = json.loads(LOCK_FILE.read_text())["packages"]["node_modules/three"]["version"]
    versions = {component["name"]: component["version"] for component in bill["components"]}
    assert (versions["libfmt9"], versions["three"]) == (version.stdout, three)


def test_writes_the_same_bytes_again(tmp_path):
    assert write(tmp_path / "first.json") == write(tmp_path / "second.json")
