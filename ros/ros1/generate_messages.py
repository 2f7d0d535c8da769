#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes headers and Python modules of ROS 1 from message definitions, with Debian's gencpp and
genpy.

generate_messages.py MESSAGES OUT

MESSAGES: a folder with PACKAGE/msg/*.msg and PACKAGE/srv/*.srv. Writes
OUT/include/PACKAGE/NAME.h and OUT/python/PACKAGE/{msg,srv}. Messages of other packages are those of
/usr/share/PACKAGE/msg.
"""
import pathlib
import subprocess
import sys

SHARE = pathlib.Path("/usr/share")
OTHERS = ("std_msgs", "geometry_msgs", "sensor_msgs", "shape_msgs", "trajectory_msgs")


def run(program, *arguments):
    subprocess.run([sys.executable, program, *map(str, arguments)], check=True)


def main(messages, out):
    packages = sorted(folder.name for folder in messages.iterdir() if folder.is_dir())
    where = []
    for name in packages:
        where += ["-I", f"{name}:{messages / name / 'msg'}"]
    for name in OTHERS:
        where += ["-I", f"{name}:{SHARE / name / 'msg'}"]
    for name in packages:
        headers, modules = out / "include" / name, out / "python" / name
        for folder in (headers, modules / "msg", modules / "srv"):
            folder.mkdir(parents=True, exist_ok=True)
        (modules / "__init__.py").touch()
        for kind in ("msg", "srv"):
            files = sorted((messages / name / kind).glob("*." + kind))
            for file in files:
                run("/usr/lib/gencpp/gen_cpp.py", file, *where, "-p", name, "-o", headers, "-e",
                    SHARE / "gencpp")
            if files:
                run(f"/usr/lib/genpy/gen{kind}_py.py", *where, "-p", name, "-o", modules / kind,
                    *files)
            run("/usr/lib/genpy/genmsg_py.py", "-p", name, "-o", modules / kind, "--initpy")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
