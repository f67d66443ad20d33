#include "spu/dispatch/packed_calls.h"

namespace understudy::spu {

std::byte* PackedCalls::append_record(CallId call, std::size_t words) {
  const std::size_t start = words_.size();
  words_.resize(start + words);
  auto* record = reinterpret_cast<std::byte*>(words_.data() + start);
  const RecordHeader header{static_cast<std::uint16_t>(call), static_cast<std::uint16_t>(words)};
  std::memcpy(record, &header, sizeof header);
  return record;
}

ReplayEnd replay_records(std::span<const std::uint64_t> words, const DispatchTable& table,
                         std::span<const RecordShape, call_count> shapes) {
  ReplayEnd end;
  while (end.words < words.size()) {
    const auto* record = reinterpret_cast<const std::byte*>(words.data() + end.words);
    RecordHeader header;
    std::memcpy(&header, record, sizeof header);
    if (header.call >= call_count) {
      end.error = "the record's call number is not in this registry";
      return end;
    }
    const RecordShape& shape = shapes[header.call];
    if (shape.words == 0) {
      end.error = "the record's call cannot be packed";
      return end;
    }
    if (header.words != shape.words) {
      end.error = "the record's length is not that of its call";
      return end;
    }
    if (header.words > words.size() - end.words) {
      end.error = "the stream ends within the record";
      return end;
    }
    const AnyFunction function = slot(table, static_cast<CallId>(header.call));
    if (function == nullptr) {
      end.error = "the table to replay on lacks the record's call";
      return end;
    }
    shape.call(function, record);
    end.words += header.words;
    ++end.calls;
  }
  return end;
}

}  // namespace understudy::spu
