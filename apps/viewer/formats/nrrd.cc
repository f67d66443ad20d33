// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/formats/nrrd.h"

#include <fmt/format.h>
#include <teem/nrrd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>

#include "apps/viewer/formats/widen.h"
#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

struct FreeNrrd {
  void operator()(Nrrd* nrrd) const { nrrdNuke(nrrd); }
};
struct FreeIoState {
  void operator()(NrrdIoState* state) const { nrrdIoStateNix(state); }
};
using NrrdPointer = std::unique_ptr<Nrrd, FreeNrrd>;

// teem reports one line per call level; the innermost one, which is last, says what is wrong with the file.
std::string teem_message() {
  const std::unique_ptr<char, decltype(&std::free)> text(biffGetDone(NRRD), &std::free);
  std::string lines = text ? text.get() : "unknown error";
  while (!lines.empty() && lines.back() == '\n') lines.pop_back();
  const std::size_t last = lines.rfind('\n');
  return last == std::string::npos ? lines : lines.substr(last + 1);
}

NrrdPointer load(const std::string& path, bool header_only) {
  NrrdPointer nrrd(nrrdNew());
  const std::unique_ptr<NrrdIoState, FreeIoState> state(nrrdIoStateNew());
  if (header_only) nrrdIoStateSet(state.get(), nrrdIoStateSkipData, AIR_TRUE);
  if (nrrdLoad(nrrd.get(), path.c_str(), state.get()))
    throw Error(ExitCode::bad_file,
                fmt::format("{}: not a readable NRRD file: {}; get the file again or check its header", path,
                            teem_message()));
  return nrrd;
}

struct Axes {
  VolumeSize size;
  Vec3 spacing;
};

Axes axes_of(const Nrrd& nrrd, const std::string& path) {
  std::vector<unsigned> spatial;
  for (unsigned axis = 0; axis < nrrd.dim; ++axis)
    if (nrrd.dim == 3 || nrrd.axis[axis].size != 1) spatial.push_back(axis);
  if (spatial.size() != 3)
    throw Error(ExitCode::bad_file, fmt::format("{}: {} axes are longer than 1, but a scalar volume has 3 "
                                                "axes; slice it first, for example with `unu slice`",
                                                path, spatial.size()));
  Axes axes{};
  for (int i = 0; i < 3; ++i) {
    axes.size[i] = static_cast<std::int64_t>(
        std::min<std::size_t>(nrrd.axis[spatial[i]].size, static_cast<std::size_t>(max_edge_voxels) + 1));
    double spacing = AIR_NAN;
    double direction[NRRD_SPACE_DIM_MAX];
    nrrdSpacingCalculate(&nrrd, spatial[i], &spacing, direction);
    axes.spacing[i] = std::isfinite(spacing) && spacing != 0 ? std::abs(spacing) : 1.0;
  }
  return axes;
}

}  // namespace

bool is_nrrd(const std::string& path) {
  char magic[4]{};
  std::ifstream(path, std::ios::binary).read(magic, sizeof magic);
  return std::memcmp(magic, "NRRD", 4) == 0;
}

Volume load_nrrd(const std::string& path) {
  // Reads the header first: its sizes are checked before teem allocates memory for them.
  const NrrdPointer header = load(path, true);
  volume_bytes(axes_of(*header, path).size, ScalarType::f32, path);

  const NrrdPointer nrrd = load(path, false);
  const Axes axes = axes_of(*nrrd, path);
  Volume volume;
  volume.size = axes.size;
  volume.spacing = axes.spacing;
  const std::size_t bytes = nrrdElementNumber(nrrd.get()) * nrrdElementSize(nrrd.get());
  const auto* data = static_cast<const std::byte*>(nrrd->data);
  volume.voxels.assign(data, data + bytes);
  volume.type = ScalarType::f32;
  switch (nrrd->type) {
    case nrrdTypeUChar:
      volume.type = ScalarType::u8;
      break;
    case nrrdTypeChar:
      volume.type = ScalarType::i8;
      break;
    case nrrdTypeUShort:
      volume.type = ScalarType::u16;
      break;
    case nrrdTypeShort:
      volume.type = ScalarType::i16;
      break;
    case nrrdTypeFloat:
      break;
    case nrrdTypeUInt:
      volume.voxels = as_float32<unsigned>(volume.voxels);
      break;
    case nrrdTypeInt:
      volume.voxels = as_float32<int>(volume.voxels);
      break;
    case nrrdTypeULLong:
      volume.voxels = as_float32<unsigned long long>(volume.voxels);
      break;
    case nrrdTypeLLong:
      volume.voxels = as_float32<long long>(volume.voxels);
      break;
    case nrrdTypeDouble:
      volume.voxels = as_float32<double>(volume.voxels);
      break;
    default:
      throw Error(
          ExitCode::bad_file,
          fmt::format("{}: voxels of type {} cannot be drawn; convert them, for example with `unu convert`",
                      path, airEnumStr(nrrdType, nrrd->type)));
  }
  return volume;
}

}  // namespace viewer
