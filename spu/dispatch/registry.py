# SPDX-License-Identifier: Apache-2.0
"""Reads the Khronos registry, and arguments.txt beside this file, into plain values."""

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase

# The type of each value in the stream; a type that is missing here stops the generator.
VALUE_TYPES = {
    "GLboolean": "boolean", "GLenum": "enumeration", "GLbitfield": "bitfield",
    "GLbyte": "int8", "GLubyte": "uint8", "GLshort": "int16", "GLushort": "uint16", "GLint": "int32", "GLuint": "uint32",
    "GLsizei": "int32", "GLint64": "int64", "GLint64EXT": "int64", "GLuint64": "uint64", "GLuint64EXT": "uint64",
    "GLintptr": "int64", "GLintptrARB": "int64", "GLsizeiptr": "int64", "GLsizeiptrARB": "int64",
    "GLhalfNV": "float16", "GLfloat": "float32", "GLclampf": "float32", "GLdouble": "float64", "GLclampd": "float64",
    "GLfixed": "fixed", "GLclampx": "fixed", "GLchar": "character", "GLcharARB": "character", "void": "untyped",
    "GLhandleARB": "uint32", "GLvdpauSurfaceNV": "int64",
    # Addresses in this process, which are meaningless in a stored or sent stream.
    "GLsync": "address", "GLeglImageOES": "address", "GLeglClientBufferEXT": "address", "GLVULKANPROCNV": "address",
    "GLDEBUGPROC": "address", "GLDEBUGPROCARB": "address", "GLDEBUGPROCKHR": "address", "GLDEBUGPROCAMD": "address",
    "struct _cl_context": "address", "struct _cl_event": "address",
}

# Name spaces of object names. Shaders share one with programs; assembly programs have their own.
OBJECT_KINDS = [
    "none", "texture", "buffer", "program", "assembly_program", "framebuffer", "renderbuffer", "vertex_array", "query",
    "sampler", "transform_feedback", "program_pipeline", "sync", "display_list",
]

# The registry specifies the length 1 for `name`, but it is a string whose length is another argument.
WRONG_LENGTHS = {
    "glProgramNamedParameter4dNV", "glProgramNamedParameter4dvNV",
    "glProgramNamedParameter4fNV", "glProgramNamedParameter4fvNV",
}


@dataclass(frozen=True)
class Extent:
    """How much memory a pointer argument refers to: one of the rules described in arguments.txt."""
    rule: str
    argument: str = ""  # the argument that the rule counts by
    factor: int = 1
    divisor: int = 1


@dataclass(frozen=True)
class Parameter:
    type: str    # "const GLfloat *"
    name: str
    length: str  # the registry's `len`, "" if it has none
    group: str = ""
    object: str = "none"
    extent: Extent = Extent("value")
    null_with: str = ""  # the argument that must be null for this one to be null; its own name: no condition

    @property
    def base(self):
        return re.sub(r"\bconst\b|\*", "", self.type).strip()

    @property
    def pointer(self):
        return self.type.count("*")

    @property
    def input(self):
        return self.pointer > 0 and self.type.startswith("const")


@dataclass(frozen=True)
class Command:
    name: str    # "glClear"
    result: str  # "void"
    parameters: tuple
    object: str = "none"  # the kind of object that the result names

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


@dataclass(frozen=True)
class Enumerant:
    name: str
    value: int
    groups: tuple


def object_kind(command, element, type):
    if type == "GLsync":
        return "sync"
    if type.replace(" *", "") == "GLhandleARB" or element.get("class") in ("program", "shader"):
        assembly = re.search(r"Programs?(NV|ARB)$", command) and not command.startswith("glUseProgram")
        return "assembly_program" if assembly else "program"
    if element.get("group") == "List":
        return "display_list"
    kind = element.get("class", "none").replace(" ", "_")
    return kind if kind in OBJECT_KINDS else "none"


def read_rules(path):
    """Lines of `command-pattern argument-pattern rule [counted-by]`; # starts a comment."""
    rules = []
    for line in path.read_text().splitlines():
        words = line.split("#")[0].split()
        if words:
            rules.append(words)
    return rules


def extent(command, parameter, names, rules):
    for command_pattern, name_pattern, rule, *counted_by in rules:
        if rule == "or_null" or (parameter.pointer == 0 and rule != "address"):
            continue
        if fnmatchcase(command, command_pattern) and fnmatchcase(parameter.name, name_pattern):
            argument, factor = (counted_by[0].split("*") + ["1"])[:2] if counted_by else ("", "1")
            if argument.isdigit():
                return Extent(rule, "", int(argument))
            if argument and argument not in names:
                raise SystemExit(f"arguments.txt: {command} has no argument {argument}")
            return Extent(rule, argument, int(factor))
    if parameter.pointer == 0:
        return Extent("value")
    if command in WRONG_LENGTHS and parameter.name == "name":
        return Extent("counted", "len")
    counted = re.fullmatch(r"(\w+?)(?:\s*([*/])\s*(\d+))?", parameter.length)
    if parameter.length.isdigit():
        return Extent("counted", "", int(parameter.length))
    if counted and counted[1] in names:
        factor = int(counted[3] or 1)
        rule = "texts" if parameter.pointer == 2 and parameter.base in ("GLchar", "GLcharARB") else "counted"
        return Extent(rule, counted[1], *((factor, 1) if counted[2] != "/" else (1, factor)))
    if parameter.input and parameter.base in ("GLchar", "GLcharARB") and parameter.pointer == 1:
        return Extent("text")
    if parameter.length == "COMPSIZE(pname)" and parameter.input:
        return Extent("parameter_values", "pname" if "pname" in names else "")
    return Extent("unknown")


def null_with(command, parameter, rules):
    for command_pattern, name_pattern, rule, *other in rules:
        if rule == "or_null" and fnmatchcase(command, command_pattern) and fnmatchcase(parameter.name, name_pattern):
            return other[0] if other else parameter.name
    return ""


def read_commands(registry, rules=()):
    """Every command of the registry, sorted by name, regardless of the version or extension that introduced it."""

    def text_before_name(element):
        text = "".join(element.itertext())
        before = text[: text.rindex(element.find("name").text)]
        return re.sub(r"\s+", " ", before.replace("*", " *")).strip()

    commands = []
    for element in ElementTree.parse(registry).getroot().findall("commands/command"):
        proto = element.find("proto")
        name = proto.find("name").text
        elements = element.findall("param")
        names = {p.find("name").text for p in elements if "*" not in "".join(p.itertext())}
        parameters = []
        for p in elements:
            type = text_before_name(p)
            plain = Parameter(type, p.find("name").text, p.get("len", ""), p.get("group", ""), object_kind(name, p, type))
            parameters.append(replace(plain, extent=extent(name, plain, names, rules), null_with=null_with(name, plain, rules)))
        result = text_before_name(proto)
        commands.append(Command(name, result, tuple(parameters), object_kind(name, proto, result)))
    return sorted(commands, key=lambda command: command.name)


def read_enumerants(registry):
    """GL's enumerants, sorted by value and then by name, without those of other interfaces and those of 64 bits."""
    found = {}
    for block in ElementTree.parse(registry).getroot().findall("enums"):
        for element in block.findall("enum"):
            if element.get("api", "gl") not in ("gl", "glcore"):
                continue
            value = int(element.get("value"), 0) & 0xFFFFFFFFFFFFFFFF
            groups = {g for g in (element.get("group", "") + "," + block.get("group", "")).split(",") if g}
            if value <= 0xFFFFFFFF:
                found.setdefault(element.get("name"), Enumerant(element.get("name"), value, tuple(sorted(groups))))
    return sorted(found.values(), key=lambda e: (e.value, bool(re.search(r"_[A-Z]+$", e.name)) and len(e.name), e.name))


def read_egl_commands(header):
    """The commands declared in <EGL/egl.h>, one per line: `EGLAPI EGLint EGLAPIENTRY eglGetError (void);`."""
    commands = []
    declaration = re.compile(r"^EGLAPI (.+?) ?EGLAPIENTRY (egl\w+) \((.*)\);$", re.MULTILINE)
    for result, name, parameters in declaration.findall(header.read_text()):
        split = [re.fullmatch(r"(.*?)(\w+)", p.strip()) for p in parameters.split(",") if p.strip() != "void"]
        commands.append(Command(name, result, tuple(Parameter(p[1].strip(), p[2], "") for p in split)))
    return sorted(commands, key=lambda command: command.name)
