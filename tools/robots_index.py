#!/usr/bin/env python3
"""Writes robots/index.json, the list of all robots, including those that an install may lack.

    tools/robots_index.py [--check]     --check: only check that the file is up to date

Names, descriptions and licences come from each robot.json. Packages exclude the robots in robots/unverified.
"""

import json
import pathlib
import sys

ROBOTS = pathlib.Path(__file__).resolve().parents[1] / "robots"


def index():
    robots = []
    for profile in ROBOTS.glob("**/robot.json"):
        texts = json.loads(profile.read_text())
        robots.append({
            "name": profile.parent.name,
            "description": texts["description"],
            "licence": texts["licence"],
            "in_packages": profile.parent.parent == ROBOTS,
        })
    robots.sort(key=lambda robot: robot["name"])
    return json.dumps({"robots": robots}, indent=2) + "\n"


def main():
    file = ROBOTS / "index.json"
    if sys.argv[1:] == ["--check"]:
        if not file.is_file() or file.read_text() != index():
            sys.exit(f"{file} is not up to date: run tools/robots_index.py")
        return
    file.write_text(index())


if __name__ == "__main__":
    main()
