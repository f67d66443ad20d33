// From records back to calls.
//
// A stream of this process (pack and unpack in one chain) may hold addresses of this process; one from a file
// or another machine may not, and nothing in it is believed: every length is checked against what OpenGL would
// read for the arguments at hand, names of objects are translated, answers go to memory of our own. Where the
// other end waits for the answers (a linked stream), they are kept for it, and names are the ones given here.
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
#include "spu/stream/call_answer.h"
#include "spu/stream/client_arrays.h"
#include "spu/stream/object_names.h"
#include "spu/stream/pixels.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// What became of a record.
struct Decoded {
  std::uint64_t result = 0;
  std::string error;  ///< empty, or what is wrong with the record
};

enum class StreamOrigin {
  this_process,
  elsewhere,  ///< recorded: what it asks was answered when it was
  linked,     ///< another process, which is told what its calls answer
};

class Decoder {
 public:
  /// `shared` are the names of a share group of contexts; a decoder serves one context.
  Decoder(StreamOrigin origin, std::shared_ptr<ObjectNames> shared)
      : origin_(origin), shared_names_(std::move(shared)) {}
  /// For streams of this process, whose names need no translation.
  Decoder() : Decoder(StreamOrigin::this_process, nullptr) {}

  /// Makes the call, or does what the event says, on `gl`. Events about contexts, threads and frames are the
  /// caller's: they are an error here.
  Decoded decode(const Record& record, const DispatchTable& gl);

  /// The call that a record holds, as words whose pointers lead into the record or to memory of the decoder
  /// that the next decode() reuses. For readers that print or count; makes no call.
  std::string arguments(const Record& record, CallId& call, std::uint64_t* words);

  /// Pixels that the last call read into memory of the decoder (glReadPixels of a stream from elsewhere); empty
  /// when it read none.
  struct ReadImage {
    ImageShape shape;
    std::vector<std::byte> pixels;
  };
  const ReadImage& read_image() const { return read_image_; }

  /// What the last call of a linked stream has answered.
  const CallAnswer& call_answer() const { return call_answer_; }

 private:
  struct Call;

  static bool answers_into_buffer(const Call& call);
  ObjectNames& names(ObjectKind kind);
  std::string read_arguments(const Record& record, Call& call);
  std::string read_bytes(const Record& record, Call& call, std::size_t parameter);
  std::string read_strings(const Record& record, Call& call, std::size_t parameter);
  std::string read_lists(const Record& record, Call& call, std::size_t parameter);
  bool translate(Call& call);
  std::string provide_outputs(Call& call, const DispatchTable& gl);
  std::string provide_image(Call& call, std::size_t parameter, const DispatchTable& gl);
  Decoded make_and_answer(Call& call, const DispatchTable& gl);
  void answer_result(const Call& call, std::uint64_t result);
  void answer_outputs(const Call& call);
  void answer_feedback(const Call& call, GLint mode);
  std::string check_arrays(Call& call, const DispatchTable& gl);
  Decoded make(Call& call, const DispatchTable& gl);
  void forget_mappings(const Call& call, const DispatchTable& gl);
  void remember_answer(const Call& call, std::uint64_t result, const DispatchTable& gl);
  Decoded begin_arrays(const Record& record, const DispatchTable& gl);
  void end_arrays(const DispatchTable& gl);
  Decoded take_answers(const Record& record);
  Decoded write_mapped(const Record& record);
  /// Memory that lasts until the next record.
  std::uint64_t* scratch(std::size_t bytes);

  const StreamOrigin origin_;
  BeginAndEnd begin_and_end_;
  bool client_memory_ = false;  ///< an array was pointed at the sender's memory
  std::vector<ClientArray> arrays_;
  std::vector<std::uint64_t> array_words_;  ///< copies of the elements that arrays_ point at
  ElementRange arrays_range_;
  std::vector<std::vector<std::uint64_t>> scratch_;
  std::size_t scratch_used_ = 0;
  std::vector<std::vector<std::uint64_t>> retained_;
  std::size_t feedback_ = 0;   ///< number, from 1, of what glFeedbackBuffer was given last
  std::size_t selection_ = 0;  ///< the same of glSelectBuffer
  std::shared_ptr<ObjectNames> shared_names_;
  ObjectNames own_names_;  ///< of kinds that contexts do not share
  bool arrays_active_ = false;
  ReadImage read_image_;
  CallAnswer call_answer_;

  /// What the last call answered here, until the stream tells what it had answered there.
  struct Answer {
    CallId call{};
    std::uint64_t result = 0;
    std::uint64_t program = 0;  ///< for locations
    std::size_t mapped_bytes = 0;
    std::vector<std::vector<std::uint32_t>> names;  ///< of every output that names objects
  } answer_;
};

}  // namespace understudy::spu
