// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/program_binaries.h"

#include <cstddef>
#include <span>
#include <vector>

#include "spu/track/share_group.h"
#include "spu/volume/observation/draw_observer.h"

namespace understudy::spu {
namespace {

void APIENTRY known_program_binary(GLuint program, GLenum format, const void* binary, GLsizei length) {
  DrawObserver& observer = DrawObserver::current();
  const DispatchTable& next = observer.next();
  if (binary == nullptr || length <= 0) return next.ProgramBinary(program, format, binary, length);
  const std::span bytes(static_cast<const std::byte*>(binary), std::size_t(length));
  if (observer.chain().group().programs().knows_binary(bytes))
    return next.ProgramBinary(program, format, binary, length);
  // Makes the driver itself refuse: passes as many bytes that are not a program.
  const std::vector<std::byte> no_program(bytes.size());
  next.ProgramBinary(program, format, no_program.data(), length);
}

}  // namespace

void fill_program_binary_slots(DispatchTable& table) {
  table.ProgramBinary = known_program_binary;
}

}  // namespace understudy::spu
