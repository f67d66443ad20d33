# SPDX-License-Identifier: Apache-2.0
"""Generates what is known of each command at run time: its shape, its names, and conversions between arguments and words."""

from registry import OBJECT_KINDS, VALUE_TYPES

EXTENT_RULES = [
    "value", "counted", "counted_or_unpack", "text", "text_or_counted", "texts", "parameter_values", "image", "image_out",
    "one_texel", "clear_value", "client_array", "indices", "index_lists", "indirect", "list_names", "map_points",
    "retained", "address", "unknown",
]

# The arguments that specify an image's size and format, by their possible names in a command.
IMAGE_ARGUMENTS = {"width": ("width", "w", "count"), "height": ("height", "h"), "depth": ("depth",), "format": ("format",), "type": ("type",)}


class Texts:
    """One long text and offsets into it, so that there are no pointers for the loader to relocate."""

    def __init__(self):
        self.offsets, self.texts, self.end = {}, [], 0

    def at(self, text):
        if text not in self.offsets:
            self.offsets[text] = self.end
            self.texts.append(text)
            self.end += len(text) + 1
        return self.offsets[text]

    def literal(self):
        return "\n".join(f'    "{t}\\0"' for t in self.texts)


def rows(values, per_row):
    return "\n".join("    " + ", ".join(values[i : i + per_row]) + "," for i in range(0, len(values), per_row))


def stable_id(name):
    """FNV-1a hash of the name: the same in every version of the registry, whatever is added to it."""
    value = 0x811C9DC5
    for byte in name.encode():
        value = (value ^ byte) * 0x01000193 & 0xFFFFFFFF
    return value


def is_plain(command):
    """No result, and every argument is a value or an array whose length the registry fixes. This only concerns the
    signature: glDrawArrays is plain although it may read arrays in the caller's memory."""
    return command.result == "void" and all(
        (p.pointer == 0 and VALUE_TYPES[p.base] != "address")
        or (p.pointer == 1 and p.input and p.extent.rule == "counted" and not p.extent.argument)
        for p in command.parameters
    )


def plain_words(command):
    """Words of a plain call's record: header, one word per argument, and {bytes, data} for every array."""
    if not is_plain(command):
        return 0
    words = 1 + len(command.parameters)
    for p in command.parameters:
        if p.pointer:
            words += 1 + -(-SIZES[VALUE_TYPES[p.base]] * p.extent.factor // 8)
    if words > 255:
        raise SystemExit(f"{command.name}: its record has {words} words: widen plain_words in shapes.py")
    return words


ID_SLOTS = 1 << 13  # more than twice the number of commands, so that probe sequences stay short


def id_slots(commands):
    """An open-addressing table from stable ids to commands."""
    if 2 * len(commands) > ID_SLOTS:
        raise SystemExit(f"{len(commands)} commands are too many for {ID_SLOTS} slots: double ID_SLOTS in shapes.py")
    slots = ["no_call"] * ID_SLOTS
    for number, command in enumerate(commands):
        position = stable_id(command.name) % ID_SLOTS
        while slots[position] != "no_call":
            position = (position + 1) % ID_SLOTS
        slots[position] = str(number)
    return slots


def shape_header():
    kinds = "\n".join(f"  {kind}," for kind in OBJECT_KINDS)
    types = list(dict.fromkeys(VALUE_TYPES.values()))
    rules = "\n".join(f"  {rule}," for rule in EXTENT_RULES)
    return f"""\
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dispatch/call_id.h"

namespace understudy::spu {{

enum class ValueType : std::uint8_t {{
  none,
{chr(10).join(f"  {t}," for t in types)}
}};

inline constexpr std::uint8_t value_sizes[] = {{
    0,
{rows([str(SIZES[t]) for t in types], 12)}
}};

/// Bytes of one value; 1 for untyped, 0 for none.
constexpr std::size_t value_size(ValueType type) noexcept {{ return value_sizes[static_cast<std::size_t>(type)]; }}

/// The name space that an object name belongs to.
enum class ObjectKind : std::uint8_t {{
{kinds}
}};

/// How much a pointer argument points at: see spu/dispatch/arguments.txt.
enum class ExtentRule : std::uint8_t {{
{rules}
}};

constexpr std::uint8_t no_argument = 0xff;

struct ParameterShape {{
  std::uint32_t name_offset;
  ValueType type;
  std::uint8_t pointer;  ///< 0: a value, 1: T*, 2: T**
  bool input;            ///< a pointer to const
  ObjectKind object;
  std::uint16_t enum_group;  ///< for enum_name; 0: none
  ExtentRule rule;
  std::uint8_t counted_by;  ///< argument; no_argument: a fixed count
  std::uint16_t factor;
  std::uint16_t divisor;
  /// The argument that is null wherever OpenGL gives a null pointer here a meaning, perhaps this one itself;
  /// no_argument where a null pointer has none.
  std::uint8_t null_with;

  const char* name() const noexcept;
}};

/// Which arguments describe the image of a command; no_argument where it has none.
struct ImageArguments {{
  std::uint8_t width = no_argument;
  std::uint8_t height = no_argument;
  std::uint8_t depth = no_argument;
  std::uint8_t format = no_argument;
  std::uint8_t type = no_argument;
}};

struct CallShape {{
  std::uint32_t first_parameter;
  std::uint8_t parameter_count;
  ValueType result;
  std::uint8_t result_pointer;  ///< 0: a value, 1: T*
  ObjectKind result_object;
  /// Words of the call's record in a stream when the call is plain, 0 when it is not. Plain: no result, and every
  /// argument is a value or an array of fixed length; nothing else is read or written.
  std::uint8_t plain_words;
  ImageArguments image;

  bool plain() const noexcept {{ return plain_words != 0; }}
  std::span<const ParameterShape> parameters() const noexcept;
}};

// Read for every call of a frame, hence from here and not by functions elsewhere.
extern const ParameterShape parameter_shapes[];
extern const CallShape call_shapes[call_count];
extern const std::uint32_t stable_ids[call_count];

inline std::span<const ParameterShape> CallShape::parameters() const noexcept {{
  return {{parameter_shapes + first_parameter, parameter_count}};
}}

inline const CallShape& call_shape(CallId call) noexcept {{ return call_shapes[static_cast<std::size_t>(call)]; }}

/// The number that stands for a command in streams: made from its name alone, so it never changes.
inline std::uint32_t stable_id(CallId call) noexcept {{ return stable_ids[static_cast<std::size_t>(call)]; }}

/// A call stands in the slot of its stable id, or in the next one that was free.
constexpr std::uint16_t no_call = 0xffff;
extern const std::uint16_t id_slots[{ID_SLOTS}];

inline std::optional<CallId> find_stable_id(std::uint32_t id) noexcept {{
  for (std::size_t position = id;; ++position) {{
    const std::uint16_t call = id_slots[position % {ID_SLOTS}];
    if (call == no_call) return std::nullopt;
    if (stable_ids[call] == id) return static_cast<CallId>(call);
  }}
}}

/// "GL_TEXTURE_2D", preferably a name of the group; null when no enumerant has the value.
const char* enum_name(std::uint32_t value, std::uint16_t group) noexcept;

/// Most words an argument list has.
constexpr std::size_t max_parameters = 24;

}}  // namespace understudy::spu
"""


def shape_source(commands, enumerants):
    texts = Texts()
    texts.at("")
    groups = {"": 0}
    for e in enumerants:
        for g in e.groups:
            groups.setdefault(g, len(groups))

    def number(command, name):
        return next((i for i, p in enumerate(command.parameters) if p.name == name), 255)

    def index(command, name):
        for number, p in enumerate(command.parameters):
            if p.name == name and p.pointer == 0:
                return number
        return 255

    shapes, parameters = [], []
    for c in commands:
        image = [255] * 5
        if any(p.extent.rule in ("image", "image_out", "one_texel") for p in c.parameters):
            for position, names in enumerate(IMAGE_ARGUMENTS.values()):
                image[position] = next((i for i in (index(c, n) for n in names) if i != 255), 255)
        if len(c.parameters) > 24:
            raise SystemExit(f"{c.name} has {len(c.parameters)} arguments: raise max_parameters in shapes.py")
        result = "none" if c.result == "void" else VALUE_TYPES[c.result.replace("const ", "").replace(" *", "")]
        shapes.append(
            f"{{{len(parameters)}, {len(c.parameters)}, ValueType::{result}, {c.result.count('*')}, ObjectKind::{c.object}, "
            f"{plain_words(c)}, {{{', '.join(map(str, image))}}}}}"
        )
        for p in c.parameters:
            e = p.extent
            if e.rule not in EXTENT_RULES:
                raise SystemExit(f"arguments.txt: {c.name} {p.name}: no rule is named {e.rule}")
            counted_by = index(c, e.argument) if e.argument else 255
            if e.argument and counted_by == 255:
                raise SystemExit(f"arguments.txt: {c.name} {p.name}: {e.argument} is not a value")
            parameters.append(
                f"{{{texts.at(p.name)}, ValueType::{VALUE_TYPES[p.base]}, {p.pointer}, {str(p.input).lower()}, "
                f"ObjectKind::{p.object}, {groups.get(p.group, 0)}, ExtentRule::{e.rule}, {counted_by}, {e.factor}, {e.divisor}, "
                f"{number(c, p.null_with) if p.pointer else 255}}}"
            )
    if len({stable_id(c.name) for c in commands}) != len(commands):
        raise SystemExit("two commands share a stable id: another hash is needed")
    memberships, enum_rows = [], []
    for e in enumerants:
        enum_rows.append(f"{{{e.value:#x}u, {texts.at(e.name)}, {len(memberships)}, {len(e.groups)}}}")
        memberships += [str(groups[g]) for g in e.groups]
    return f"""\
#include "dispatch/call_shape.h"

#include <algorithm>
#include <iterator>

namespace understudy::spu {{
namespace {{

constexpr char texts[] =
{texts.literal()};

struct Enumerant {{
  std::uint32_t value;
  std::uint32_t name_offset;
  std::uint16_t first_group;
  std::uint16_t groups;
}};

constexpr Enumerant enumerants[] = {{
{rows(enum_rows, 3)}
}};

constexpr std::uint16_t memberships[] = {{
{rows(memberships, 20)}
}};

}}  // namespace

const char* ParameterShape::name() const noexcept {{ return texts + name_offset; }}

constinit const ParameterShape parameter_shapes[] = {{
{rows(parameters, 1)}
}};

constinit const CallShape call_shapes[call_count] = {{
{rows(shapes, 1)}
}};

constinit const std::uint32_t stable_ids[call_count] = {{
{rows([f"{stable_id(c.name):#x}u" for c in commands], 8)}
}};

constinit const std::uint16_t id_slots[] = {{
{rows(id_slots(commands), 16)}
}};

const char* enum_name(std::uint32_t value, std::uint16_t group) noexcept {{
  const auto* first = std::lower_bound(std::begin(enumerants), std::end(enumerants), value,
                                       [](const Enumerant& entry, std::uint32_t wanted) {{ return entry.value < wanted; }});
  const char* name = nullptr;
  for (const auto* e = first; e != std::end(enumerants) && e->value == value; ++e) {{
    if (name == nullptr) name = texts + e->name_offset;
    const auto* member = memberships + e->first_group;
    if (group != 0 && std::find(member, member + e->groups, group) != member + e->groups) return texts + e->name_offset;
  }}
  return name;
}}

}}  // namespace understudy::spu
"""


SIZES = {
    "boolean": 1, "enumeration": 4, "bitfield": 4, "int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4, "uint32": 4,
    "int64": 8, "uint64": 8, "float16": 2, "float32": 4, "float64": 8, "fixed": 4, "character": 1, "untyped": 1,
    "address": 8,
}


def every_slot(commands):
    """The table of a class that has a function for each command, and fill(), which sets every slot."""
    functions = ",\n".join(f"      &{c.name}" for c in commands)
    return f"""\
  /// As data: thousands of assignments take the compiler up to 20 s, and each of them instructions.
  static constexpr DispatchTable all{{
{functions}}};

  /// Sets every slot.
  static void fill(DispatchTable& table) {{ table = all; }}"""


def words_header(commands):
    functions = []
    for c in commands:
        handed_on = f"Handler::call(CallId::{c.member}, " + ("words)" if c.parameters else "nullptr)")
        array = f"    const std::uint64_t words[] = {{{', '.join(f'word({p.name})' for p in c.parameters)}}};\n" if c.parameters else ""
        end = f"    {handed_on};\n" if c.result == "void" else f"    return argument<{c.result}>({handed_on});\n"
        functions.append(f"  static UNDERSTUDY_FORWARDING {c.result} APIENTRY {c.name}({c.parameter_list}) {{\n{array}{end}  }}")
    plain_fills = "\n".join(
        f'    if constexpr (Handler::chooses("{c.name}")) table.{c.member} = &{c.name};' for c in commands if is_plain(c))
    return f"""\
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

#include "dispatch/call_id.h"
#include "dispatch/call_shape.h"
#include "dispatch/forwarding.h"
#include "dispatch/table.h"

namespace understudy::spu {{

/// An argument as one word: integers extended to 64 bits by their own sign, GLfloat as its 32 bits, GLdouble as its 64,
/// pointers as addresses.
template <class T>
std::uint64_t word(T value) noexcept {{
  if constexpr (std::is_pointer_v<T>) {{
    return reinterpret_cast<std::uintptr_t>(value);
  }} else if constexpr (std::is_same_v<T, float>) {{
    return std::bit_cast<std::uint32_t>(value);
  }} else if constexpr (std::is_same_v<T, double>) {{
    return std::bit_cast<std::uint64_t>(value);
  }} else {{
    return static_cast<std::uint64_t>(value);
  }}
}}

/// The value that `word` made the word from.
template <class T>
T argument(std::uint64_t word) noexcept {{
  if constexpr (std::is_pointer_v<T>) {{
    return reinterpret_cast<T>(static_cast<std::uintptr_t>(word));
  }} else if constexpr (std::is_same_v<T, float>) {{
    return std::bit_cast<float>(static_cast<std::uint32_t>(word));
  }} else if constexpr (std::is_same_v<T, double>) {{
    return std::bit_cast<double>(word);
  }} else {{
    return static_cast<T>(word);
  }}
}}

/// By command: makes a call of its signature with argument words.
using Invoker = std::uint64_t (*)(AnyFunction function, const std::uint64_t* words);
extern const Invoker invokers[call_count];

/// Makes the call on `table` with argument words, as many as the command's shape has; answers the result's word, 0 for
/// void. The slot must not be null.
inline std::uint64_t invoke(const DispatchTable& table, CallId call, const std::uint64_t* words) {{
  return invokers[static_cast<std::size_t>(call)](slot(table, call), words);
}}

/// Functions with the commands' signatures that hand every call on as words:
/// `static std::uint64_t Handler::call(CallId, const std::uint64_t* words)`, which answers the result's word.
template <class Handler>
struct AsWords {{
{chr(10).join(functions)}

{every_slot(commands)}

  /// Sets the slots of those plain commands whose names `static constexpr bool Handler::chooses(std::string_view)`
  /// chooses, and leaves the others alone.
  static void fill_chosen(DispatchTable& table) {{
{plain_fills}
  }}

  /// Sets the slots that are not null in `table`: a command that the next unit lacks stays lacking.
  static void fill_present(DispatchTable& table) {{
    for (std::size_t call = 0; call < call_count; ++call) {{
      if (slot(table, static_cast<CallId>(call)) != nullptr) {{
        set_slot(table, static_cast<CallId>(call), slot(all, static_cast<CallId>(call)));
      }}
    }}
  }}
}};

}}  // namespace understudy::spu
"""


def words_source(commands):
    invokers = rows([f"&invoke_as<{', '.join([c.result, *(p.type for p in c.parameters)])}>" for c in commands], 1)
    return f"""\
#include "dispatch/call_words.h"

#include <utility>

namespace understudy::spu {{
namespace {{

template <class Result, class... Arguments>
std::uint64_t invoke_as(AnyFunction function, [[maybe_unused]] const std::uint64_t* words) {{
  const auto call = reinterpret_cast<Result(APIENTRY*)(Arguments...)>(function);
  return [&]<std::size_t... Position>(std::index_sequence<Position...>) -> std::uint64_t {{
    if constexpr (std::is_void_v<Result>) {{
      call(argument<Arguments>(words[Position])...);
      return 0;
    }} else {{
      return word(call(argument<Arguments>(words[Position])...));
    }}
  }}(std::index_sequence_for<Arguments...>{{}});
}}

}}  // namespace

constinit const Invoker invokers[call_count] = {{
{invokers}
}};

}}  // namespace understudy::spu
"""
