#!/usr/bin/python3
"""The Python module as a wheel: what `pip install` puts in place without a compiler, with the library within; and the
same in the Blender add-on's zip.

usage: wheel.py LIBRARY FOLDER      LIBRARY needs only libc and what is packed with it (OpenMP's library)"""
import base64
import hashlib
import pathlib
import re
import subprocess
import sys
import sysconfig
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODULE = ROOT / "lib" / "python" / "shapebench"
OF_THE_SYSTEM = re.compile(r"(linux-vdso|ld-linux|lib(c|m|dl|pthread|rt))[.-]")
METADATA = """Metadata-Version: 2.1
Name: shapebench
Version: {version}
Summary: Deformable bodies by shape matching: fast lattices, octrees, and their references
License: MIT
Requires-Python: >=3.9
Requires-Dist: numpy
Provides-Extra: results
Requires-Dist: h5py; extra == "results"
Description-Content-Type: text/markdown

{readme}"""


def needed(library):
    """The libraries that it needs beside the system's own: names and places."""
    said = subprocess.run(["ldd", library], capture_output=True, text=True, check=True).stdout
    found = dict(re.findall(r"^\t(\S+)(?: => (\S+))?", said, re.MULTILINE))
    return {name: pathlib.Path(place) for name, place in found.items() if not OF_THE_SYSTEM.match(pathlib.Path(name).name)}


def module(library):
    """The module's files, by their names."""
    files = {f"shapebench/{path.name}": path.read_bytes() for path in sorted(MODULE.iterdir()) if path.is_file()}
    files["shapebench/libshapebench.so"] = library.read_bytes()
    for name, place in needed(library).items():
        files[f"shapebench/{name}"] = place.read_bytes()
    return files


def about_wheel(version, tag):
    """What a wheel says of itself."""
    files = {}
    about = f"shapebench-{version}.dist-info"
    readme = (ROOT / "lib" / "python" / "README.md").read_text(encoding="utf-8")
    files[f"{about}/METADATA"] = METADATA.format(version=version, readme=readme).encode()
    files[f"{about}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: shapebench\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    files[f"{about}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    return files


def record(name, data):
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(data)}\n"


def pack(archive, files):
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name)  # of 1980, so that the same files make the same archive
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            packed.writestr(entry, data)
    print(archive)


def main():
    library, folder = map(pathlib.Path, sys.argv[1:])
    tag = "py3-none-" + sysconfig.get_platform().replace("-", "_").replace(".", "_")
    header = (MODULE / "shapebench.h").read_text(encoding="utf-8")
    version = ".".join(re.findall(r"#define SHAPEBENCH_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header))
    own = module(library)
    files = own | about_wheel(version, tag)
    name = f"shapebench-{version}.dist-info/RECORD"
    files[name] = ("".join(record(*item) for item in files.items()) + f"{name},,\n").encode()
    pack(folder / f"shapebench-{version}-{tag}.whl", files)
    addon = {"__init__.py": (ROOT / "lib" / "python" / "blender" / "__init__.py").read_bytes()} | own
    pack(folder / f"shapebench-{version}-blender.zip", {f"shapebench_blender/{name}": data for name, data in addon.items()})


if __name__ == "__main__":
    main()
