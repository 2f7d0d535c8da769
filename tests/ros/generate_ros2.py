# SPDX-License-Identifier: BSD-3-Clause
"""Makes C++ structs of ROS 2 from message definitions, with Debian's rosidl.

generate_ros2.py OUT     writes OUT/old/include and OUT/new/include

The definitions of MoveIt are those of msgs; the request of `old` ends as that of ROS 2 Humble does,
that of `new` has the members of Iron and later. Those of the other packages are in ros2.txt, since
Debian has no messages of ROS 2.
"""
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
LATER = ("cartesian_speed_limited_link", "max_cartesian_speed")
SCALES = "float64 max_velocity_scaling_factor\nfloat64 max_acceleration_scaling_factor\n"


def definitions():
    """{(package, kind, name): text}"""
    found = {}
    for file in HERE.glob("msgs/*/*/*"):
        found[file.parts[-3], file.parts[-2], file.name] = file.read_text()
    for part in re.split(r"^=== ", (HERE / "ros2.txt").read_text(), flags=re.MULTILINE)[1:]:
        title, text = part.split("\n", 1)
        package, name = title.split("/")
        found[package, "msg", name + ".msg"] = text
    return found


def request_of(text, new):
    request, response = text.split("---\n")
    lines = [line for line in request.splitlines() if line.split()[1] not in LATER]
    if new:
        lines += SCALES.splitlines() + ["string " + LATER[0], "float64 " + LATER[1]]
    return "\n".join(lines) + "\n---\n" + response


def generate(out, new):
    packages = {}
    for (package, kind, name), text in definitions().items():
        if kind == "srv":
            text = request_of(text, new)
        file = out / "share" / package / kind / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        packages.setdefault(package, []).append(f"{kind}/{name}")
    for package, names in sorted(packages.items()):
        subprocess.run(
            ["rosidl", "generate", "-o", str(out / "include" / package), "-t", "cpp", "-I",
             str(out / "share"), package, *sorted(names)],
            check=True, cwd=out / "share" / package, stdout=subprocess.DEVNULL,
        )


for version in ("old", "new"):
    generate(pathlib.Path(sys.argv[1]).resolve() / version, version == "new")
