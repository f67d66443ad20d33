// SPDX-License-Identifier: Apache-2.0
// Decodes records to calls.
//
// A stream of this process (pack and unpack in one chain) may contain addresses of this process. A stream from
// a file or another machine may not, and nothing in it is trusted. A pointer in it is one of three things:
// bytes of the stream, whose size is checked against what the call reads; memory of ours for answers; or an
// offset into a buffer object, checked against the buffer's size (checked_pointers.cc, brought_arrays.h,
// provided_outputs.cc). Anything else is an error that names the call, and the call is not made. Names of
// objects are translated. If the sender waits for answers (a linked stream), they are kept for it, and it uses
// the names that are created here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dispatch/call_shape.h"
#include "dispatch/table.h"
#include "spu/stream/begin_and_end.h"
#include "spu/stream/bound_buffers.h"
#include "spu/stream/brought_arrays.h"
#include "spu/stream/call_answer.h"
#include "spu/stream/object_names.h"
#include "spu/stream/pixels.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// The outcome of a record.
struct Decoded {
  std::uint64_t result = 0;
  std::string error;  ///< an error in the record, or empty
};

enum class StreamOrigin {
  this_process,
  elsewhere,  ///< recorded: its queries were answered when it was recorded
  linked,     ///< from another process, which gets the answers of its calls
};

class Decoder {
 public:
  /// `shared` are the names of a share group of contexts; a decoder is for one context.
  Decoder(StreamOrigin origin, std::shared_ptr<ObjectNames> shared)
      : origin_(origin), shared_names_(std::move(shared)) {}
  /// For streams of this process, whose names need no translation.
  Decoder() : Decoder(StreamOrigin::this_process, nullptr) {}

  /// Makes the call, or executes the event, on `gl`. Events about contexts, threads and frames are handled by
  /// the caller and are not allowed here.
  Decoded decode(const Record& record, const DispatchTable& gl);

  /// The call in a record.
  struct ReadCall {
    CallId id{};
    /// Pointers refer to the record, or to memory of the decoder that the next decode() reuses, unless their
    /// kind is address or output: those are numbers to be printed and never dereferenced.
    std::array<std::uint64_t, max_parameters> words{};
    std::array<ReferenceKind, max_parameters> kinds{};
  };
  /// Reads a record without making its call, for printing or counting. Returns an error in the record, or an
  /// empty string.
  std::string read(const Record& record, ReadCall& call);

  /// Pixels that the last call read into memory of the decoder (glReadPixels of a stream from elsewhere); empty
  /// if it read none.
  struct ReadImage {
    ImageShape shape;
    std::vector<std::byte> pixels;
  };
  const ReadImage& read_image() const { return read_image_; }

  /// The answer of the last call of a linked stream.
  const CallAnswer& call_answer() const { return call_answer_; }

 private:
  struct Call;

  static bool answers_into_buffer(const Call& call);
  bool believes() const { return origin_ == StreamOrigin::this_process; }
  ObjectNames& names(ObjectKind kind);
  std::string read_arguments(const Record& record, Call& call);
  std::string read_references(const Record& record, Call& call);
  std::string read_lists_of(const Record& record, Call& call);
  std::string read_bytes(const Record& record, Call& call, std::size_t parameter);
  std::string read_strings(const Record& record, Call& call, std::size_t parameter);
  std::string read_lists(const Record& record, Call& call, std::size_t parameter);
  std::string measure(Call& call, std::size_t parameter);
  static std::string refuse_null(const Call& call, std::size_t parameter);
  void give_room(Call& call, std::size_t parameter);
  bool translate(Call& call);
  std::string check_pointers(Call& call, const DispatchTable& gl);
  std::string check_pointer(Call& call, std::size_t parameter, const DispatchTable& gl);
  std::string check_offset(Call& call, std::size_t parameter, GLenum target, const DispatchTable& gl);
  std::string check_memory(Call& call, std::size_t parameter);
  std::string provide_outputs(Call& call, const DispatchTable& gl);
  std::string provide_output(Call& call, std::size_t parameter, const DispatchTable& gl);
  std::string provide_image(Call& call, std::size_t parameter, const DispatchTable& gl);
  void read_image(Call& call, std::size_t parameter, const DispatchTable& gl);
  void forget_retained(CallId call, const DispatchTable& gl);
  Decoded make_and_answer(Call& call, const DispatchTable& gl);
  void answer_result(const Call& call, std::uint64_t result);
  void answer_outputs(const Call& call);
  bool tells_address_of_ours(const Call& call) const;
  void answer_feedback(const Call& call, GLint mode, const DispatchTable& gl);
  Decoded make(Call& call, const DispatchTable& gl);
  Decoded decode_event(const Record& record, const DispatchTable& gl);
  Decoded decode_unbelieved(Call& call, const DispatchTable& gl);
  void forget_mappings(const Call& call, const DispatchTable& gl);
  void remember_answer(const Call& call, std::uint64_t result, const DispatchTable& gl);
  Decoded take_answers(const Record& record);
  Decoded write_mapped(const Record& record, const DispatchTable& gl);
  /// Returns memory that stays valid until the next record.
  std::uint64_t* scratch(std::size_t bytes);

  const StreamOrigin origin_;
  BeginAndEnd begin_and_end_;
  BroughtArrays arrays_;
  bool query_buffer_ = false;  ///< a query buffer was bound, which may receive answers of queries
  std::vector<std::vector<std::uint64_t>> scratch_;
  std::size_t scratch_used_ = 0;
  /// The buffers given to glFeedbackBuffer and glSelectBuffer, the last one at the end. The driver may keep an
  /// earlier one if it rejects a call.
  std::vector<std::vector<std::uint64_t>> feedback_;
  std::vector<std::vector<std::uint64_t>> selection_;
  std::shared_ptr<ObjectNames> shared_names_;
  ObjectNames own_names_;  ///< names of kinds that contexts do not share
  ReadImage read_image_;
  CallAnswer call_answer_;

  /// The answer of the last call here, kept until the stream reports the recorded answer.
  struct Answer {
    CallId call{};
    std::uint64_t result = 0;
    std::uint64_t program = 0;  ///< for locations
    ObjectNames::Mapping mapped;
    std::vector<std::vector<std::uint32_t>> names;  ///< for every output that names objects
  } answer_;
};

}  // namespace understudy::spu
