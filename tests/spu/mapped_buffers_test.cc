// SPDX-License-Identifier: Apache-2.0
// What an application writes into mapped buffers, however the mappings end.
#include "spu/trace/mapped_buffers.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <array>
#include <cstring>
#include <map>
#include <vector>

#include "dispatch/call_words.h"
#include "spu/stream/event.h"
#include "tests/spu/mock_driver.h"

namespace understudy::spu {
namespace {

using testing::MockDriver;

/// Memory of a driver, which is inaccessible after its mapping has ended.
class DriverMemory {
 public:
  DriverMemory()
      : first_(static_cast<std::byte*>(
            mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0))) {}
  ~DriverMemory() { munmap(first_, bytes); }
  DriverMemory(const DriverMemory&) = delete;
  DriverMemory& operator=(const DriverMemory&) = delete;

  std::byte* first() const { return first_; }
  void vanish() const { mprotect(first_, bytes, PROT_NONE); }

  static constexpr std::size_t bytes = 4096;

 private:
  std::byte* first_;
};

std::map<GLuint, std::byte*> mappings_of_driver;
GLuint bound_in_driver = 0;

class MappedBuffersTest : public ::testing::Test {
 protected:
  MappedBuffersTest() {
    mappings_of_driver.clear();
    bound_in_driver = 0;
    DispatchTable& slots = driver_.slots();
    slots.GetIntegerv = [](GLenum, GLint* value) { *value = GLint(bound_in_driver); };
    slots.BindBuffer = [](GLenum, GLuint buffer) { bound_in_driver = buffer; };
    slots.IsBuffer = [](GLuint buffer) { return GLboolean(buffer != 0); };
    slots.GetBufferPointerv = [](GLenum, GLenum, void** first) {
      *first = mappings_of_driver.contains(bound_in_driver) ? mappings_of_driver[bound_in_driver] : nullptr;
    };
    slots.GetBufferParameteriv = [](GLenum, GLenum, GLint* value) { *value = GLint(DriverMemory::bytes); };
  }

  void map(GLuint buffer, const DriverMemory& memory, GLbitfield access) {
    bound_in_driver = buffer;
    mappings_of_driver[buffer] = memory.first();
    const std::uint64_t words[] = {GL_ARRAY_BUFFER, 0, DriverMemory::bytes, access};
    buffers_.after(driver_.table(), CallId::MapBufferRange, words, word(memory.first()));
  }
  void before(CallId call, std::vector<std::uint64_t> words) {
    words.resize(8);
    buffers_.before(driver_.table(), call, words.data(), records_);
  }
  void delete_buffer(GLuint buffer) {
    before(CallId::DeleteBuffers, {1, word(&buffer)});
    mappings_of_driver.erase(buffer);
  }
  /// How many writes were recorded since the last call.
  std::size_t writes() {
    std::size_t count = 0;
    for (std::size_t at = 0; at < records_.words().size();) {
      const auto record = record_at(records_.words(), at, records_.payload());
      count += record->id == event::mapped_write ? 1 : 0;
      at += record->words.size();
    }
    records_.clear();
    return count;
  }

  static constexpr GLbitfield persistent = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;

  MockDriver driver_;
  MappedBuffers buffers_{MappedMemory::of_driver};
  Records records_;
};

TEST_F(MappedBuffersTest, AreRecordedWhenTheirContentsTakeEffect) {
  const DriverMemory memory;
  map(5, memory, persistent);
  before(CallId::DrawArrays, {GL_POINTS, 0, 1});
  EXPECT_EQ(writes(), 0U) << "nothing was written";
  memory.first()[7] = std::byte(1);
  before(CallId::DrawArrays, {GL_POINTS, 0, 1});
  EXPECT_EQ(writes(), 1U);
  memory.first()[9] = std::byte(1);
  before(CallId::UnmapBuffer, {GL_ARRAY_BUFFER});
  EXPECT_EQ(writes(), 1U);
  before(CallId::DrawArrays, {GL_POINTS, 0, 1});
  EXPECT_EQ(writes(), 0U);
}

TEST_F(MappedBuffersTest, AreNotReadAfterTheirBufferWasDeleted) {
  const DriverMemory memory;
  const DriverMemory other;
  map(5, memory, persistent);
  map(6, other, persistent);
  delete_buffer(5);
  memory.vanish();
  other.first()[1] = std::byte(1);
  before(CallId::DrawArrays, {GL_POINTS, 0, 1});
  EXPECT_EQ(writes(), 1U) << "of the buffer that is left";
}

TEST_F(MappedBuffersTest, AreNotReadAfterAnotherContextHasDeletedTheirBuffer) {
  const DriverMemory memory;
  map(5, memory, persistent);
  mappings_of_driver.erase(5);
  memory.vanish();
  before(CallId::DrawArrays, {GL_POINTS, 0, 1});
  before(CallId::UnmapBuffer, {GL_ARRAY_BUFFER});
  EXPECT_EQ(writes(), 0U);
  EXPECT_EQ(bound_in_driver, 5U) << "the application's binding";
}

TEST_F(MappedBuffersTest, AreNotReadAfterTheirBufferHasGotNewStorage) {
  const DriverMemory memory;
  for (const CallId call : {CallId::BufferData, CallId::BufferStorage, CallId::NamedBufferData,
                            CallId::NamedBufferDataEXT, CallId::NamedBufferStorage}) {
    map(5, memory, GL_MAP_WRITE_BIT);
    before(call, {call == CallId::BufferData || call == CallId::BufferStorage ? GLuint(GL_ARRAY_BUFFER) : 5U});
    before(CallId::UnmapBuffer, {GL_ARRAY_BUFFER});
    EXPECT_EQ(writes(), 0U) << call_name(call);
  }
}

TEST_F(MappedBuffersTest, AreMappedAgainWithTheirNewSize) {
  const DriverMemory memory;
  map(5, memory, GL_MAP_WRITE_BIT);
  // Another context unmaps the buffer, and this one maps a part of it at the same address.
  const std::uint64_t words[] = {GL_ARRAY_BUFFER, 0, 16, GL_MAP_WRITE_BIT};
  buffers_.after(driver_.table(), CallId::MapBufferRange, words, word(memory.first()));
  before(CallId::UnmapBuffer, {GL_ARRAY_BUFFER});
  const auto record = record_at(records_.words(), 0, records_.payload());
  ASSERT_TRUE(record);
  EXPECT_EQ(record->bytes(record->arguments()[2])->size(), 16U);
  EXPECT_EQ(writes(), 1U);
}

TEST_F(MappedBuffersTest, KeepWhatTheApplicationIsJustWriting) {
  const DriverMemory memory;
  map(5, memory, persistent | GL_MAP_READ_BIT);
  std::vector<std::byte> contents(DriverMemory::bytes);
  contents[3] = std::byte(1);
  memory.first()[8] = std::byte(2);
  EXPECT_TRUE(buffers_.refresh(5, contents));
  EXPECT_EQ(memory.first()[3], std::byte(1));
  EXPECT_EQ(memory.first()[8], std::byte(2));
  before(CallId::DrawArrays, {GL_POINTS, 0, 1});
  const auto record = record_at(records_.words(), 0, records_.payload());
  ASSERT_TRUE(record);
  EXPECT_EQ(record->arguments()[1], 8U) << "only the application's write is recorded";
  EXPECT_EQ(record->bytes(record->arguments()[2])->size(), 1U);
  EXPECT_FALSE(buffers_.refresh(6, contents));
}

}  // namespace
}  // namespace understudy::spu
