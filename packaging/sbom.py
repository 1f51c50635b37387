"""Prints what is built into the program for a target, as CycloneDX 1.5; the same bytes for the same sources.

packaging/sbom.py TARGET
"""

import json
import subprocess
import sys

import tomllib

ROOT = "droptower"


def reference(package):
    """The address of a package by its name and version."""
    return f"pkg:cargo/{package['name']}@{package['version']}"


def component(package, sums):
    """A package with its licence and, of the registry, the sum of its archive."""
    found = {
        "type": "library",
        "bom-ref": reference(package),
        "name": package["name"],
        "version": package["version"],
        "purl": reference(package),
    }
    if package["license"]:
        found["licenses"] = [{"expression": package["license"].replace("/", " OR ").replace("  ", " ")}]
    if checksum := sums.get((package["name"], package["version"])):
        found["hashes"] = [{"alg": "SHA-256", "content": checksum}]
    return found


def main():
    command = ["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", sys.argv[1]]
    metadata = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    packages = {package["id"]: package for package in metadata["packages"]}
    with open("Cargo.lock", "rb") as lock:
        locked = tomllib.load(lock)["package"]
    sums = {(package["name"], package["version"]): package.get("checksum") for package in locked}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    root = next(id for id, package in packages.items() if package["name"] == ROOT)

    # What is built in: neither what builds nor what tests need.
    def needed(id):
        kinds = ((one["pkg"], {kind["kind"] for kind in one["dep_kinds"]}) for one in nodes[id]["deps"])
        return sorted(package for package, of in kinds if None in of)

    seen, waiting = {root}, [root]
    while waiting:
        new = [id for id in needed(waiting.pop()) if id not in seen]
        seen.update(new)
        waiting.extend(new)
    order = sorted(seen, key=lambda id: reference(packages[id]))
    own = component(packages[root], sums)
    bom = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": {**own, "type": "application"}},
        "components": [component(packages[id], sums) for id in order if id != root],
        "dependencies": [
            {"ref": reference(packages[id]), "dependsOn": sorted({reference(packages[one]) for one in needed(id)})}
            for id in order
        ],
    }
    print(json.dumps(bom, indent=1))


if __name__ == "__main__":
    main()
