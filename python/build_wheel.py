# SPDX-License-Identifier: BSD-3-Clause
"""What pip calls to build the package (PEP 517): CMake builds and installs the component `python`,
and this packs it as a wheel.

CMAKE_ARGS, as elsewhere, are more arguments for CMake. The build folder is build/pip, so that a
second call builds what changed. The package has the pages of report() where node, npm and their
network are there; CMAKE_ARGS=-DSWIVEL_REPORT=ON makes it fail without them, OFF leaves them out.
"""
import base64
import hashlib
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def version():
    return re.search(
        r"project\(swivel VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()
    ).group(1)


def metadata():
    text = (ROOT / "pyproject.toml").read_text()
    description = re.search(r'^description = "(.*)"$', text, re.MULTILINE).group(1)
    lines = [
        "Metadata-Version: 2.1", "Name: swivel", f"Version: {version()}", f"Summary: {description}",
        "License: BSD-3-Clause", "Requires-Python: >=3.9", "Requires-Dist: numpy",
        "Description-Content-Type: text/markdown", ""
    ]
    return "\n".join(lines) + "\n" + (ROOT / "README.md").read_text()


def run(*command):
    print("+", shlex.join(map(str, command)), flush=True)
    subprocess.run(list(map(str, command)), check=True)


def jobs():
    """As many compilers as cores, but no more than one for each 1.5 GB of memory."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return max(1, min(os.cpu_count() or 1, int(memory / 1.5e9)))


def build_package(folder):
    build = ROOT / "build" / "pip"
    arguments = [
        "-DCMAKE_BUILD_TYPE=Release", "-DSWIVEL_PYTHON=ON", "-DSWIVEL_PYTHON_DIR=.",
        f"-DPython_EXECUTABLE={sys.executable}", "-DBUILD_SHARED_LIBS=OFF", "-DSWIVEL_TESTS=OFF",
        "-DSWIVEL_BENCH=OFF", "-DSWIVEL_REPORT=AUTO"
    ]
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    forget_missing_pages(build)
    # --fresh: a virtual environment of an earlier call may be gone.
    run(
        "cmake", "--fresh", "-S", ROOT, "-B", build, *generator, *arguments,
        *shlex.split(os.environ.get("CMAKE_ARGS", ""))
    )
    run("cmake", "--build", build, "--target", "swivel_python", "--parallel", jobs())
    run("cmake", "--install", build, "--component", "python", "--prefix", folder, "--strip")
    add_notices(build, Path(folder) / "swivel")


def has_pages(build):
    """Whether the pages of report() were bundled: their files are empty where that failed."""
    page = build / "report" / "web" / "report.html"
    return page.exists() and page.stat().st_size > 0


def forget_missing_pages(build):
    """Makes the next build try again to bundle pages that an earlier one could not."""
    if not has_pages(build):
        (build / "report" / "web" / "report.html").unlink(missing_ok=True)


def add_notices(build, package):
    """Says whether the package has pages; if so, adds the licences of what they are made of."""
    cache = (build / "CMakeCache.txt").read_text()
    off = re.search(r"^SWIVEL_REPORT:\w+=(OFF|NO|FALSE|N|0)$", cache, re.MULTILINE)
    without = re.search(r"^SWIVEL_(NODE|NPM):\w+=.*-NOTFOUND$", cache, re.MULTILINE)
    if has_pages(build) and not off and not without:
        shutil.copy(build / "report" / "web" / "THIRD-PARTY.txt", package)
        print("swivel: this package has the pages of report() and show()", flush=True)
        return
    why = "SWIVEL_REPORT is OFF" if off else "node, npm or their network is missing"
    print(
        f"swivel: this package has no pages, since {why}: report() and show() will say so",
        file=sys.stderr, flush=True
    )


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def information():
    """Name of the wheel's dist-info folder, and its files but for RECORD."""
    files = {
        "METADATA": metadata().encode(),
        "LICENSE": (ROOT / "LICENSE").read_bytes(),
        "WHEEL": (
            "Wheel-Version: 1.0\nGenerator: swivel\nRoot-Is-Purelib: false\n"
            f"Tag: {tag()}\n"
        ).encode(),
    }
    return f"swivel-{version()}.dist-info", files


def get_requires_for_build_wheel(config_settings=None):
    return ["numpy"]  # the build imports the package to write its type stubs


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    info, files = information()
    (Path(metadata_directory) / info).mkdir()
    for name, content in files.items():
        (Path(metadata_directory) / info / name).write_bytes(content)
    return info


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    name, (info, about) = f"swivel-{version()}-{tag()}.whl", information()
    with tempfile.TemporaryDirectory() as folder:
        build_package(folder)
        files = {
            str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(Path(folder).rglob("*"))
            if path.is_file()
        }
    files |= {f"{info}/{file}": content for file, content in about.items()}
    record = ""
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            digest = (
                base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            )
            record += f"{path},sha256={digest},{len(content)}\n"
            wheel.writestr(path, content)
        wheel.writestr(f"{info}/RECORD", record + f"{info}/RECORD,,\n")
    return name


def build_sdist(sdist_directory, config_settings=None):
    """The files that git knows."""
    base = f"swivel-{version()}"
    listed = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files", "-z"], check=True, capture_output=True
    ).stdout.decode()
    with tempfile.TemporaryDirectory() as folder, tarfile.open(
        Path(sdist_directory) / f"{base}.tar.gz", "w:gz"
    ) as archive:
        information = Path(folder) / "PKG-INFO"
        information.write_text(metadata())
        archive.add(information, f"{base}/PKG-INFO")
        for name in filter(None, listed.split("\0")):
            archive.add(ROOT / name, f"{base}/{name}", recursive=False)
    return f"{base}.tar.gz"
