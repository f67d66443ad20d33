// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/jpeg2000.h"

#include <openjpeg.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>

namespace understudy::volume {

namespace {

/// The bytes of an image, as a stream for OpenJPEG.
struct Memory {
  std::span<const std::byte> bytes;
  std::size_t at = 0;
};

OPJ_SIZE_T read_memory(void* to, OPJ_SIZE_T count, void* user) {
  auto* const memory = static_cast<Memory*>(user);
  const std::size_t got = std::min<std::size_t>(count, memory->bytes.size() - memory->at);
  if (got == 0) return static_cast<OPJ_SIZE_T>(-1);  // end of stream
  std::memcpy(to, memory->bytes.data() + memory->at, got);
  memory->at += got;
  return got;
}

OPJ_OFF_T skip_memory(OPJ_OFF_T count, void* user) {
  auto* const memory = static_cast<Memory*>(user);
  if (count < 0) return -1;
  const std::size_t passed = std::min(std::size_t(count), memory->bytes.size() - memory->at);
  memory->at += passed;
  return OPJ_OFF_T(passed);
}

OPJ_BOOL seek_memory(OPJ_OFF_T place, void* user) {
  auto* const memory = static_cast<Memory*>(user);
  if (place < 0 || std::size_t(place) > memory->bytes.size()) return OPJ_FALSE;
  memory->at = std::size_t(place);
  return OPJ_TRUE;
}

// Streams and codecs are both void*.
using Stream = std::unique_ptr<opj_stream_t, decltype(&opj_stream_destroy)>;
using Codec = std::unique_ptr<opj_codec_t, decltype(&opj_destroy_codec)>;
using Decoded = std::unique_ptr<opj_image_t, decltype(&opj_image_destroy)>;

/// A codestream begins with a marker, a JP2 file with the length of its first box.
OPJ_CODEC_FORMAT format_of(std::span<const std::byte> image) {
  return !image.empty() && image.front() == std::byte{0xFF} ? OPJ_CODEC_J2K : OPJ_CODEC_JP2;
}

}  // namespace

std::vector<std::int32_t> decode_jpeg2000(std::span<const std::byte> image, const std::array<int, 2>& size) {
  Memory memory{image};
  const Stream stream(opj_stream_default_create(OPJ_TRUE), &opj_stream_destroy);
  const Codec codec(opj_create_decompress(format_of(image)), &opj_destroy_codec);
  if (!stream || !codec) throw std::bad_alloc();
  opj_stream_set_user_data(stream.get(), &memory, nullptr);
  opj_stream_set_user_data_length(stream.get(), image.size());
  opj_stream_set_read_function(stream.get(), read_memory);
  opj_stream_set_skip_function(stream.get(), skip_memory);
  opj_stream_set_seek_function(stream.get(), seek_memory);
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  opj_image_t* header = nullptr;
  if (opj_setup_decoder(codec.get(), &parameters) == OPJ_FALSE ||
      opj_read_header(stream.get(), codec.get(), &header) == OPJ_FALSE)
    throw std::runtime_error("its JPEG 2000 header is damaged");
  const Decoded decoded(header, &opj_image_destroy);
  const auto fits = [&] {
    return decoded->numcomps == 1 && decoded->comps[0].w == unsigned(size[0]) &&
           decoded->comps[0].h == unsigned(size[1]);
  };
  // Checked before memory is allocated according to the header.
  if (!fits()) throw std::runtime_error("its JPEG 2000 image has another size");
  if (opj_decode(codec.get(), stream.get(), decoded.get()) == OPJ_FALSE || !fits() ||
      decoded->comps[0].data == nullptr)
    throw std::runtime_error("its JPEG 2000 image is damaged");
  const std::size_t count = std::size_t(size[0]) * std::size_t(size[1]);
  return {decoded->comps[0].data, decoded->comps[0].data + count};
}

}  // namespace understudy::volume
