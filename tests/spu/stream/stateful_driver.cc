// SPDX-License-Identifier: Apache-2.0
#include "tests/spu/stream/stateful_driver.h"

#include <algorithm>
#include <cstring>

#include "dispatch/call_words.h"
#include "spu/stream/extent.h"
#include "spu/stream/pixels.h"

namespace understudy::spu::testing {
namespace {

thread_local StatefulDriver* driver = nullptr;

const std::byte* address(std::uint64_t word) {
  return reinterpret_cast<const std::byte*>(static_cast<std::uintptr_t>(word));
}

void append(std::vector<std::byte>& to, const std::byte* from, std::size_t bytes) {
  to.insert(to.end(), from, from + bytes);
}

/// The bytes that OpenGL reads through one pointer.
std::vector<std::byte> read(CallId call, std::size_t p, const std::uint64_t* words) {
  const CallShape& shape = call_shape(call);
  const ParameterShape& parameter = shape.parameters()[p];
  std::vector<std::byte> bytes;
  if (words[p] == 0 || !parameter.input) return bytes;
  switch (parameter.rule) {
    case ExtentRule::image: {
      const ImageShape image = image_shape(call, words);
      const PixelStore store = pixel_store(driver->table(), unpack_names);
      return image_extent(image, store) ? tight_image(image, store, address(words[p])) : bytes;
    }
    case ExtentRule::texts:
    case ExtentRule::index_lists: {
      const auto* list = reinterpret_cast<const std::uint64_t*>(address(words[p]));
      const std::uint8_t lengths_at =
          argument_named(shape, parameter.rule == ExtentRule::texts ? "length" : "count");
      const auto* lengths =
          lengths_at == no_argument ? nullptr : reinterpret_cast<const GLint*>(address(words[lengths_at]));
      for (std::int32_t i = 0; i < std::int32_t(words[parameter.counted_by]); ++i) {
        std::size_t length = lengths != nullptr && lengths[i] >= 0 ? std::size_t(lengths[i]) : 0;
        if (parameter.rule == ExtentRule::index_lists)
          length *= component_size(GLenum(words[argument_named(shape, "type")]));
        if (length == 0 && parameter.rule == ExtentRule::texts)
          length = std::strlen(reinterpret_cast<const char*>(address(list[i])));
        append(bytes, address(list[i]), length);
        bytes.push_back(std::byte(0xff));
      }
      return bytes;
    }
    case ExtentRule::client_array:
    case ExtentRule::address:
    case ExtentRule::unknown:
      return bytes;
    default:
      break;
  }
  append(bytes, address(words[p]), pointee_bytes(call, p, words).value_or(0));
  return bytes;
}

}  // namespace

struct StatefulDriver::Slots {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    ++driver->counted;
    if (driver->counts_only) return 0;
    SeenCall seen{.call = call, .values = {}, .read = {}};
    const auto parameters = call_shape(call).parameters();
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (parameters[p].pointer == 0) {
        seen.values.push_back(words[p]);
      } else {
        seen.read.push_back(read(call, p, words));
      }
    }
    driver->calls_.push_back(std::move(seen));
    return 0;
  }
  static void APIENTRY get_integer(GLenum name, GLint* value) { *value = driver->get(name); }
  static void APIENTRY set_pixel_store(GLenum name, GLint value) { driver->set(name, value); }
  static GLboolean APIENTRY is_enabled(GLenum name) { return GLboolean(driver->get(name) != 0); }
};

std::string text(const SeenCall& call) {
  std::string line = call_name(call.call);
  for (const std::uint64_t value : call.values) line += " " + std::to_string(value);
  for (const auto& bytes : call.read) line += " (" + std::to_string(bytes.size()) + " bytes)";
  return line;
}

StatefulDriver::StatefulDriver() {
  driver = this;
  AsWords<Slots>::fill(table_);
  table_.GetIntegerv = &Slots::get_integer;
  table_.PixelStorei = &Slots::set_pixel_store;
  table_.IsEnabled = &Slots::is_enabled;
  integers_[GL_UNPACK_ALIGNMENT] = 4;
  integers_[GL_PACK_ALIGNMENT] = 4;
}

StatefulDriver::~StatefulDriver() {
  driver = nullptr;
}

}  // namespace understudy::spu::testing
