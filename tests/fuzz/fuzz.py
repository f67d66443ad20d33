# SPDX-License-Identifier: Apache-2.0
"""Fuzzes with the targets of build-fuzz/, then reports how much of its code each one reached, using the targets of
build-fuzz-coverage/. Ends with status 1 on a finding, or if a target reaches fewer lines than it should.

    fuzz.py [--runs N] [TARGET...]
"""

import argparse
import concurrent.futures
import dataclasses
import json
import os
import pathlib
import re
import subprocess
import sys
import time

import volume_file_seeds

ROOT = pathlib.Path(__file__).resolve().parents[2]
OUT = ROOT / "out" / "fuzz"
KEPT = pathlib.Path(__file__).parent
SAY_SECONDS = 30


@dataclasses.dataclass(frozen=True)
class Target:
    """A target with its kept inputs and the sources that it tests: at least `least` per cent of their lines must be reached.
    Some of these files also contain the sender's side, which inputs do not reach."""
    name: str
    sources: tuple
    least: int
    kept: str = ""
    max_bytes: int = 65536


TARGETS = [
    Target("unpack", ("spu/stream/decode.cc",), 90, "corpus"),
    Target("print", ("spu/print/call_text.cc", "spu/print/record_text.cc"), 80, "corpus"),
    Target("trace", ("spu/stream/trace_file.cc",), 60),
    Target("remote", ("compositor/transport/tcp/tcp_message_reader.cc", "compositor/transport/tcp/handshake.cc",
                      "compositor/transport/tcp/block_codec.cc", "compositor/relay/render_relay.cc"), 50),
    Target("record", ("compositor/transport/tcp/record_opener.cc", "compositor/transport/tcp/record_sealer.cc"), 90),
    Target("node_message", ("compositor/service/node_protocol.cc", "compositor/service/request_message.cc",
                            "compositor/service/load_protocol.cc", "compositor/service/integral_parts.cc"), 80),
    Target("gl_server", ("spu/remote/gl_server_protocol.cc", "spu/remote/travelling_image.cc", "spu/remote/chunks.cc"), 50),
    Target("view_message", ("apps/understudy/view/view_message.cc",), 90, "view_corpus"),
    Target("volume_file", ("volume/file/nrrd.cc", "volume/file/meta_image.cc", "volume/file/header_fields.cc", "volume/file/nifti.cc", "volume/file/vti.cc", "volume/file/vti_header.cc",
                           "volume/file/volume_file.cc", "volume/file/zlib_blocks.cc", "volume/file/base64_source.cc",
                           "volume/file/gzip_source.cc"), 80),
    # Most of its time is spent in the GLSL front end.
    Target("program", ("spu/volume/program/",), 60, "program_corpus", 16384),
]


def folders(target):
    """The folder for inputs worth keeping, followed by the folders of initial inputs."""
    found = OUT / target.name
    found.mkdir(parents=True, exist_ok=True)
    begins = [OUT / "seeds" / target.name, *([KEPT / target.kept] if target.kept else [])]
    return [str(found), *(str(folder) for folder in begins if folder.is_dir())]


def write_seeds(bin_folder):
    subprocess.run([bin_folder / "write_seeds", OUT / "seeds"], check=True)
    folder = OUT / "seeds" / "volume_file"
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in volume_file_seeds.seeds().items():
        (folder / name).write_bytes(data)


def tell(name, log):
    """Prints libFuzzer's latest statistics."""
    lines = re.findall(r"^#(\d+)\s.*?cov: (\d+)", log.read_text(errors="replace"), re.M)
    if lines:
        print(f"{name}: {int(lines[-1][0]):,} inputs, {lines[-1][1]} edges", flush=True)


def fuzz(target, runs):
    """Returns whether there was no finding."""
    log = OUT / f"{target.name}.log"
    command = [ROOT / "build-fuzz" / "bin" / f"{target.name}_fuzzer", f"-runs={runs}",
               f"-max_len={target.max_bytes}", "-rss_limit_mb=2560", "-timeout=60", "-print_final_stats=1",
               f"-artifact_prefix={OUT}/{target.name}-", *folders(target)]
    with log.open("w") as text:
        process = subprocess.Popen(command, stdout=text, stderr=subprocess.STDOUT)
    asked = time.monotonic()
    while process.poll() is None:
        time.sleep(0.2)
        if time.monotonic() - asked > SAY_SECONDS:
            tell(target.name, log)
            asked = time.monotonic()
    tell(target.name, log)
    if process.returncode:
        print(f"{target.name}: FOUND something, status {process.returncode}: {log} ends with", flush=True)
        print("".join(log.read_text(errors="replace").splitlines(True)[-60:]))
    return process.returncode == 0


def reached(target):
    """Number of lines of its sources that all its inputs together reach, and their total number."""
    bin_folder = ROOT / "build-fuzz-coverage" / "bin"
    program = bin_folder / f"{target.name}_fuzzer"
    raw, profile = OUT / f"{target.name}.profraw", OUT / f"{target.name}.profdata"
    # Files are only run; a folder would be mutated. xargs keeps each command line short enough.
    inputs = [str(file) for folder in folders(target) for file in sorted(pathlib.Path(folder).iterdir())]
    arguments = OUT / f"{target.name}.inputs"
    arguments.write_text("\n".join(inputs))
    subprocess.run(["xargs", "-a", arguments, "-d", "\n", "-n", "2000", program],
                   env={**os.environ, "LLVM_PROFILE_FILE": str(raw) + ".%p"}, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL, check=True)
    parts = sorted(OUT.glob(raw.name + ".*"))
    subprocess.run(["llvm-profdata", "merge", "-sparse", "-o", profile, *parts], check=True)
    for part in parts:
        part.unlink()
    text = subprocess.run(["llvm-cov", "export", "-summary-only", f"-instr-profile={profile}", program],
                          stdout=subprocess.PIPE, check=True).stdout
    rows = {}
    for file in json.loads(text)["data"][0]["files"]:
        name = os.path.relpath(file["filename"], ROOT)
        if name.startswith(target.sources):
            rows[name] = (file["summary"]["lines"]["covered"], file["summary"]["lines"]["count"])
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1_000_000, help="inputs for each target")
    parser.add_argument("targets", nargs="*", metavar="TARGET", help="all where none is named")
    arguments = parser.parse_args()
    unknown = set(arguments.targets) - {target.name for target in TARGETS}
    if unknown:
        sys.exit(f"fuzz.py: no target named {', '.join(sorted(unknown))}; there are "
                 f"{', '.join(target.name for target in TARGETS)}")
    chosen = [target for target in TARGETS if not arguments.targets or target.name in arguments.targets]
    OUT.mkdir(parents=True, exist_ok=True)
    write_seeds(ROOT / "build-fuzz" / "bin")
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        well = all(list(pool.map(lambda target: fuzz(target, arguments.runs), chosen)))
    print(f"{'target':14} {'file':56} lines reached")
    for target in chosen:
        rows = reached(target)
        for name, (covered, count) in sorted(rows.items()):
            print(f"{target.name:14} {name:56} {covered:5} of {count:5} {100 * covered / max(count, 1):6.1f} %")
        share = 100 * sum(c for c, _ in rows.values()) / max(sum(n for _, n in rows.values()), 1)
        if share < target.least:
            print(f"{target.name}: reaches {share:.1f} % of the lines it is there for, not {target.least} %")
            well = False
    sys.exit(0 if well else 1)


if __name__ == "__main__":
    main()
