"""Writes the licences of all crates that fabc links, with their texts, to standard output.

licences.py       reads `cargo metadata` of the folder it runs in; needs no package besides Python

Out: a list of crates with version, licence and authors, then each text once, under the crates that carry it. A crate
without a licence file is listed with the common text of its licence. A crate that declares no licence is an error.
"""

import json
import pathlib
import subprocess
import sys

TARGET = "x86_64-unknown-linux-gnu"
NAMES = ("license", "licence", "copying", "copyright", "notice", "unlicense", "ofl")


def metadata():
    command = ["cargo", "metadata", "--locked", "--features", "tags", "--format-version", "1", "--filter-platform", TARGET]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def linked(workspace):
    """Returns the packages that end up in the binary: normal dependencies, without procedural macros."""
    packages = {package["id"]: package for package in workspace["packages"]}
    nodes = {node["id"]: node for node in workspace["resolve"]["nodes"]}
    root = next(package["id"] for package in workspace["packages"] if package["name"] == "fabc")
    reached, waiting = set(), [root]
    while waiting:
        name = waiting.pop()
        kinds = {kind for target in packages[name]["targets"] for kind in target["kind"]}
        if name in reached or "proc-macro" in kinds:
            continue
        reached.add(name)
        for dependency in nodes[name]["deps"]:
            if any(kind["kind"] is None for kind in dependency["dep_kinds"]):
                waiting.append(dependency["pkg"])
    outside = [packages[name] for name in reached if packages[name]["source"]]
    return sorted(outside, key=lambda package: (package["name"], package["version"]))


def texts(package):
    """Returns the texts of the licence files in a package's folder."""
    folder = pathlib.Path(package["manifest_path"]).parent
    files = [file for file in folder.iterdir() if file.is_file() and file.name.lower().startswith(NAMES)]
    if package["license_file"]:
        files.append(folder / package["license_file"])
    return [file.read_text(errors="replace").strip() for file in sorted(set(files)) if file.suffix != ".rs"]


def main():
    packages = linked(metadata())
    carriers, without = {}, []
    print("Crates that are compiled into fabc, with their licences. The source of each is at https://crates.io/crates/NAME.\n")
    for package in packages:
        title = f"{package['name']} {package['version']}"
        if not (package["license"] or package["license_file"]):
            sys.exit(f"{title} declares no licence")
        print(f"{title}: {package['license'] or 'see its text'}; {', '.join(package['authors']) or 'its authors'}")
        found = texts(package)
        if not found:
            without.append(title)
        for text in found:
            carriers.setdefault(text, []).append(title)
    if without:
        print("\nThese carry no text; the texts of their licences are below: " + ", ".join(without))
    for text, titles in carriers.items():
        print("\n" + "=" * 80 + "\n" + ", ".join(dict.fromkeys(titles)) + "\n" + "=" * 80 + "\n\n" + text)


main()
