// SPDX-License-Identifier: Apache-2.0
#include "volume/hierarchy/byte_planes.h"

#include <zstd.h>

#include <bit>
#include <memory>
#include <stdexcept>

namespace understudy::volume {
namespace {

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

// Planes are in order from the least significant byte.
std::size_t byte_in_memory(std::size_t plane, std::size_t width) {
  return std::endian::native == std::endian::little ? plane : width - 1 - plane;
}

}  // namespace

std::vector<std::byte> packed_planes(std::span<const std::byte> residuals, std::size_t width, int effort) {
  const std::size_t count = residuals.size() / width;
  std::vector<std::byte> planes(residuals.size());
  for (std::size_t plane = 0; plane < width; ++plane) {
    const std::size_t byte = byte_in_memory(plane, width);
    for (std::size_t i = 0; i < count; ++i) planes[plane * count + i] = residuals[i * width + byte];
  }
  std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, effort);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::vector<std::byte> packed(ZSTD_compressBound(planes.size()));
  const std::size_t bytes =
      ZSTD_compress2(context.get(), packed.data(), packed.size(), planes.data(), planes.size());
  if (ZSTD_isError(bytes)) throw std::runtime_error(ZSTD_getErrorName(bytes));
  packed.resize(bytes);
  packed.shrink_to_fit();
  return packed;
}

bool unpack_planes(std::span<const std::byte> packed, std::size_t width, std::span<std::byte> residuals) {
  std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  if (!context) throw std::bad_alloc();
  std::vector<std::byte> planes(width == 1 ? 0 : residuals.size());
  std::byte* const to = width == 1 ? residuals.data() : planes.data();
  const std::size_t bytes =
      ZSTD_decompressDCtx(context.get(), to, residuals.size(), packed.data(), packed.size());
  if (ZSTD_isError(bytes) || bytes != residuals.size()) return false;
  const std::size_t count = residuals.size() / width;
  for (std::size_t plane = 0; plane < width && width > 1; ++plane) {
    const std::size_t byte = byte_in_memory(plane, width);
    for (std::size_t i = 0; i < count; ++i) residuals[i * width + byte] = planes[plane * count + i];
  }
  return true;
}

std::size_t most_packed_bytes(std::size_t bytes) {
  return ZSTD_compressBound(bytes);
}

}  // namespace understudy::volume
