#!/usr/bin/env python3
"""Writes the C++ that follows from the Khronos registry: the dispatch table, and all that has one piece a command.

    generate.py --gl gl.xml --glx glx.xml --egl egl.h --out DIRECTORY

Files written (README.md in this folder says who uses which):

    table.h           DispatchTable: one function pointer a command
    call_id.h, .cc    CallId: one number a command, in alphabetical order, and the way between number, name and slot
    pass_through.h    PassThrough<Before>: for every command "do this first, then call the next table"
    packed_call.h, .cc  pack_X and replay for the commands whose arguments are plain values
    gl_entry_N.cc     the exported gl* functions of the door, in a few files so that they compile in parallel
    glx_entry.cc, egl_entry.cc  the exported glX* and egl* functions that the door does not write by hand

Python's standard library only. The registry is Debian's package khronos-api, which lacks EGL's: EGL's commands are read
from its header, which the registry's own generator writes. Nothing generated is ever committed.
"""

import argparse
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

GL_ENTRY_FILES = 6  # compiled in parallel

# Written by hand in interceptor/glx.cc and egl.cc: they change which context is current, end a frame, or hand out
# addresses.
BY_HAND = {
    "glXCopySubBufferMESA", "glXCreateContext", "glXCreateContextAttribsARB", "glXCreateContextWithConfigSGIX",
    "glXCreateNewContext", "glXDestroyContext", "glXFreeContextEXT", "glXGetCurrentContext", "glXGetCurrentDisplay",
    "glXGetCurrentDisplayEXT", "glXGetCurrentDrawable", "glXGetCurrentReadDrawable", "glXGetCurrentReadDrawableSGI",
    "glXGetProcAddress", "glXGetProcAddressARB", "glXImportContextEXT", "glXMakeContextCurrent", "glXMakeCurrent",
    "glXMakeCurrentReadSGI", "glXSwapBuffers", "glXSwapBuffersMscOML", "glXWaitGL",
    "eglCopyBuffers", "eglCreateContext", "eglDestroyContext", "eglGetCurrentContext", "eglGetCurrentDisplay",
    "eglGetCurrentSurface", "eglGetProcAddress", "eglMakeCurrent", "eglReleaseThread", "eglSwapBuffers",
    "eglTerminate", "eglWaitClient", "eglWaitGL",
}

# Types of IRIX's video and digital-media libraries: no header of ours has them, no Linux driver has the commands.
FOREIGN_TYPES = {"DMparams", "DMbuffer", "VLServer", "VLPath", "VLNode"}

# Values that are addresses of this process: they mean nothing in a stored or sent stream.
ADDRESS_TYPES = {
    "GLsync", "GLeglImageOES", "GLeglClientBufferEXT", "GLVULKANPROCNV",
    "GLDEBUGPROC", "GLDEBUGPROCARB", "GLDEBUGPROCKHR", "GLDEBUGPROCAMD",
}

# The registry gives their `name` the length 1; it is a string whose length is another argument.
WRONG_LENGTHS = {
    "glProgramNamedParameter4dNV", "glProgramNamedParameter4dvNV",
    "glProgramNamedParameter4fNV", "glProgramNamedParameter4fvNV",
}

# In the registry, but not in every <GL/glext.h>. Saying a typedef twice is legal while both say the same.
TYPES_OF_OUR_OWN = """\
typedef khronos_int32_t GLclampx;
typedef khronos_int32_t GLfixed;
typedef void* GLeglClientBufferEXT;
typedef void* GLeglImageOES;
typedef void(APIENTRY* GLVULKANPROCNV)(void);
typedef GLDEBUGPROC GLDEBUGPROCKHR;
struct _cl_context;
struct _cl_event;
"""


@dataclass(frozen=True)
class Parameter:
    type: str    # "const GLfloat *"
    name: str
    length: str  # the registry's `len`, "" when it has none

    @property
    def pointee(self):
        """T for `const T *`, else None."""
        match = re.fullmatch(r"const (\w+) \*", self.type)
        return match[1] if match else None

    @property
    def field(self):
        """How the value lies in a packed record, or None when it cannot."""
        if "*" not in self.type:
            return None if self.type in ADDRESS_TYPES else self.type
        if self.pointee and self.pointee != "void" and self.length.isdigit():
            return f"FixedArray<{self.pointee}, {self.length}>"
        return None


@dataclass(frozen=True)
class Command:
    name: str    # "glClear"
    result: str  # "void"
    parameters: tuple

    @property
    def member(self):
        """glClear -> Clear"""
        return self.name.removeprefix("gl")

    @property
    def parameter_list(self):
        return ", ".join(f"{p.type} {p.name}" for p in self.parameters)

    @property
    def arguments(self):
        return ", ".join(p.name for p in self.parameters)

    @property
    def packable(self):
        return (
            self.result == "void"
            and self.name not in WRONG_LENGTHS
            and all(p.field for p in self.parameters)
        )


def read_commands(registry):
    """Every command of the registry, sorted by name, whatever version or extension brought it."""

    def text_before_name(element):
        text = "".join(element.itertext())
        before = text[: text.rindex(element.find("name").text)]
        return re.sub(r"\s+", " ", before.replace("*", " *")).strip()

    commands = []
    for element in ElementTree.parse(registry).getroot().findall("commands/command"):
        proto = element.find("proto")
        parameters = tuple(
            Parameter(text_before_name(p), p.find("name").text, p.get("len", "")) for p in element.findall("param")
        )
        commands.append(Command(proto.find("name").text, text_before_name(proto), parameters))
    return sorted(commands, key=lambda command: command.name)


def read_egl_commands(header):
    """The commands that <EGL/egl.h> declares: one line each, `EGLAPI EGLint EGLAPIENTRY eglGetError (void);`."""
    commands = []
    declaration = re.compile(r"^EGLAPI (.+?) ?EGLAPIENTRY (egl\w+) \((.*)\);$", re.MULTILINE)
    for result, name, parameters in declaration.findall(header.read_text()):
        split = [re.fullmatch(r"(.*?)(\w+)", p.strip()) for p in parameters.split(",") if p.strip() != "void"]
        commands.append(Command(name, result, tuple(Parameter(p[1].strip(), p[2], "") for p in split)))
    return sorted(commands, key=lambda command: command.name)


def write(path, text):
    """Leaves a file alone whose text is the same, so that nothing is compiled again for nothing."""
    text = "// Generated by spu/dispatch/generate.py from the Khronos registry.\n" + text
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def table(commands):
    members = "\n".join(f"  {c.result}(APIENTRY* {c.member})({c.parameter_list});" for c in commands)
    return f"""\
#pragma once

#include <GL/gl.h>
#include <GL/glext.h>
#include <KHR/khrplatform.h>

{TYPES_OF_OUR_OWN}
namespace understudy::spu {{

/// OpenGL as a value: one pointer a command, named as in the registry without its "gl".
struct DispatchTable {{
{members}
}};

}}  // namespace understudy::spu
"""


def call_id_header(commands):
    enumerators = "\n".join(f"  {c.member}," for c in commands)
    return f"""\
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include "dispatch/table.h"

namespace understudy::spu {{

/// One number a command, in alphabetical order: it is also the command's position in DispatchTable.
enum class CallId : std::uint16_t {{
{enumerators}
}};

constexpr std::size_t call_count = {len(commands)};

/// "glClear" for CallId::Clear; "?" for a number that is no command.
const char* call_name(CallId call) noexcept;

/// CallId::Clear for "glClear"; nothing for a name that the registry does not know.
std::optional<CallId> find_call(std::string_view name) noexcept;

/// A command's function without its signature.
using AnyFunction = void (*)();
static_assert(sizeof(DispatchTable) == call_count * sizeof(AnyFunction));

/// Where a command's pointer lies in a DispatchTable, in bytes.
constexpr std::size_t slot_offset(CallId call) {{ return static_cast<std::size_t>(call) * sizeof(AnyFunction); }}

inline AnyFunction slot(const DispatchTable& table, CallId call) noexcept {{
  AnyFunction function;
  std::memcpy(&function, reinterpret_cast<const char*>(&table) + slot_offset(call), sizeof function);
  return function;
}}

inline void set_slot(DispatchTable& table, CallId call, AnyFunction function) noexcept {{
  std::memcpy(reinterpret_cast<char*>(&table) + slot_offset(call), &function, sizeof function);
}}

}}  // namespace understudy::spu
"""


def call_id_source(commands):
    # One long text and offsets into it: no pointers that the loader would have to relocate.
    offsets, position = [], 0
    for c in commands:
        offsets.append(position)
        position += len(c.name) + 1
    names = "\n".join(f'    "{c.name}\\0"' for c in commands)
    rows = "\n".join("    " + ", ".join(map(str, offsets[i : i + 14])) + "," for i in range(0, len(offsets), 14))
    return f"""\
#include "dispatch/call_id.h"

namespace understudy::spu {{
namespace {{

constexpr char names[] =
{names};

constexpr std::uint32_t offsets[call_count] = {{
{rows}
}};

}}  // namespace

const char* call_name(CallId call) noexcept {{
  const auto index = static_cast<std::size_t>(call);
  return index < call_count ? names + offsets[index] : "?";
}}

std::optional<CallId> find_call(std::string_view name) noexcept {{
  std::size_t first = 0;
  std::size_t last = call_count;
  while (first < last) {{
    const std::size_t middle = first + (last - first) / 2;
    const int order = name.compare(names + offsets[middle]);
    if (order == 0) return static_cast<CallId>(middle);
    if (order < 0) {{
      last = middle;
    }} else {{
      first = middle + 1;
    }}
  }}
  return std::nullopt;
}}

}}  // namespace understudy::spu
"""


def pass_through(commands):
    functions = "\n".join(
        f"  static {c.result} APIENTRY {c.name}({c.parameter_list}) {{\n"
        f"    return Before::before(CallId::{c.member}).{c.member}({c.arguments});\n"
        f"  }}"
        for c in commands
    )
    slots = "\n".join(f"    table.{c.member} = &{c.name};" for c in commands)
    return f"""\
#pragma once

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {{

/// A table in which every command does one thing first and is then forwarded with its arguments:
/// `static const DispatchTable& Before::before(CallId)` is told the command and answers with the table to forward to.
template <class Before>
struct PassThrough {{
{functions}

  /// Sets every slot.
  static void fill(DispatchTable& table) {{
{slots}
  }}
}};

}}  // namespace understudy::spu
"""


def packed_call_header(commands):
    packable = [c for c in commands if c.packable]
    bits = [0] * ((len(commands) + 63) // 64)
    for number, c in enumerate(commands):
        if c.packable:
            bits[number // 64] |= 1 << (number % 64)
    words = "\n".join("    " + ", ".join(f"0x{b:016x}u" for b in bits[i : i + 5]) + "," for i in range(0, len(bits), 5))

    def stored(p):
        return f"{p.field}{{{p.name}}}" if p.pointee else p.name

    packers = "\n".join(
        f"inline void pack_{c.member}(PackedCalls& calls{''.join(f', {p.type} {p.name}' for p in c.parameters)}) {{\n"
        f"  calls.append(CallId::{c.member}{''.join(f', {stored(p)}' for p in c.parameters)});\n"
        f"}}"
        for c in packable
    )
    slots = "\n".join(
        f"  static void APIENTRY {c.name}({c.parameter_list}) {{\n"
        f"    pack_{c.member}({', '.join(['Sink::sink()', *(p.name for p in c.parameters)])});\n"
        f"  }}"
        for c in packable
    )
    fills = "\n".join(f"    table.{c.member} = &{c.name};" for c in packable)
    return f"""\
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dispatch/call_id.h"
#include "dispatch/table.h"
#include "spu/dispatch/packed_calls.h"

namespace understudy::spu {{

inline constexpr std::uint64_t packable_bits[] = {{
{words}
}};

/// True when a command returns nothing and each argument is a value or an array of a length that the registry fixes.
/// This is about the signature alone: glDrawArrays is packable, though what it reads may lie in the caller's arrays.
constexpr bool is_packable(CallId call) {{
  const auto number = static_cast<std::size_t>(call);
  return number < call_count && (packable_bits[number / 64] >> (number % 64) & 1) != 0;
}}

/// Makes the calls again, in order, on `table`; stops at the first record that is not right.
ReplayEnd replay(std::span<const std::uint64_t> words, const DispatchTable& table);
inline ReplayEnd replay(const PackedCalls& calls, const DispatchTable& table) {{ return replay(calls.words(), table); }}

{packers}

/// Functions with the commands' signatures that pack the call into `Sink::sink()`, a PackedCalls&, and do no more.
template <class Sink>
struct PackInto {{
{slots}

  /// Sets the slots of the packable commands, leaves the others alone.
  static void fill(DispatchTable& table) {{
{fills}
  }}
}};

}}  // namespace understudy::spu
"""


def packed_call_source(commands):
    rows = "\n".join(
        f"    record_shape<{', '.join(p.field for p in c.parameters)}>," if c.packable else "    {},"
        for c in commands
    )
    return f"""\
#include "dispatch/packed_call.h"

namespace understudy::spu {{
namespace {{

constexpr RecordShape shapes[call_count] = {{
{rows}
}};

}}  // namespace

ReplayEnd replay(std::span<const std::uint64_t> words, const DispatchTable& table) {{
  return replay_records(words, table, shapes);
}}

}}  // namespace understudy::spu
"""


def gl_entries(commands):
    functions = "\n".join(
        f"UNDERSTUDY_ENTRY {c.result} APIENTRY {c.name}({c.parameter_list}) {{\n"
        f"  const auto call = entered_table().{c.member};\n"
        f"  if (call == nullptr) [[unlikely]] return missing<{c.result}>(CallId::{c.member});\n"
        f"  return call({c.arguments});\n"
        f"}}"
        for c in commands
    )
    return f"""\
#include "interceptor/entry_point.h"

using namespace understudy::interceptor;
using understudy::spu::CallId;

{functions}
"""


def window_system_entries(commands, system, header):
    passed_on = [
        c for c in commands
        if c.name not in BY_HAND and not any(t in f"{c.result} {c.parameter_list}" for t in FOREIGN_TYPES)
    ]
    functions = "\n".join(
        f"UNDERSTUDY_ENTRY {c.result} {c.name}({c.parameter_list}) {{\n"
        f"  using Function = {c.result} (*)({', '.join(p.type for p in c.parameters)});\n"
        f"  static constinit RealFunction<Function> real{{WindowSystem::{system}, \"{c.name}\"}};\n"
        f"  return real({c.arguments});\n"
        f"}}"
        for c in passed_on
    )
    return f"""\
#include <{header}>

#include "interceptor/real_function.h"

using namespace understudy::interceptor;

{functions}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gl", type=Path, required=True, help="gl.xml of the Khronos registry")
    parser.add_argument("--glx", type=Path, required=True, help="glx.xml of the Khronos registry")
    parser.add_argument("--egl", type=Path, required=True, help="<EGL/egl.h>")
    parser.add_argument("--out", type=Path, required=True, help="folder to write to")
    arguments = parser.parse_args()

    gl = read_commands(arguments.gl)
    glx = read_commands(arguments.glx)
    egl = read_egl_commands(arguments.egl)
    if len(gl) < 3000 or len(gl) >= 1 << 16:
        raise SystemExit(f"{arguments.gl}: {len(gl)} commands where some 3,300 were expected. Is it Khronos's gl.xml?")
    if len(egl) < 40:
        raise SystemExit(f"{arguments.egl}: {len(egl)} commands where 44 were expected. Is it Khronos's EGL 1.5 header?")

    out = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    write(out / "table.h", table(gl))
    write(out / "call_id.h", call_id_header(gl))
    write(out / "call_id.cc", call_id_source(gl))
    write(out / "pass_through.h", pass_through(gl))
    write(out / "packed_call.h", packed_call_header(gl))
    write(out / "packed_call.cc", packed_call_source(gl))
    share = -(-len(gl) // GL_ENTRY_FILES)
    for number in range(GL_ENTRY_FILES):
        write(out / f"gl_entry_{number}.cc", gl_entries(gl[number * share : (number + 1) * share]))
    write(out / "glx_entry.cc", window_system_entries(glx, "glx", "GL/glx.h"))
    write(out / "egl_entry.cc", window_system_entries(egl, "egl", "EGL/egl.h"))


if __name__ == "__main__":
    main()
