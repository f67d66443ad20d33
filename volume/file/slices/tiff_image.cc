// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/tiff_image.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <bit>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "volume/file/byte_source.h"
#include "volume/file/file_error.h"
#include "volume/file/slices/tiff_description.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

namespace {

// Limits single allocations by libtiff caused by a damaged header.
constexpr tmsize_t most_memory = tmsize_t(1) << 30;
constexpr std::size_t most_pages = std::size_t(1) << 20;

/// A file as libtiff reads it, and libtiff's error message.
struct Client {
  std::unique_ptr<ByteSource> file;
  std::uint64_t position = 0;
  std::string trouble;
};

// No exception may propagate through libtiff.
tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t count) {
  auto* const client = static_cast<Client*>(handle);
  try {
    const std::span<std::byte> bytes(static_cast<std::byte*>(to), std::size_t(std::max<tmsize_t>(0, count)));
    const std::size_t got = client->file->read(client->position, bytes);
    client->position += got;
    return tmsize_t(got);
  } catch (const std::exception& error) {
    client->trouble = error.what();
    return -1;
  }
}

toff_t seek(thandle_t handle, toff_t offset, int from) {
  auto* const client = static_cast<Client*>(handle);
  const std::uint64_t base = from == SEEK_SET   ? 0
                             : from == SEEK_END ? client->file->size().value_or(0)
                                                : client->position;
  return client->position = base + offset;
}

toff_t size_of(thandle_t handle) {
  return static_cast<Client*>(handle)->file->size().value_or(0);
}

int keep_error(TIFF* /*tiff*/, void* user, const char* /*module*/, const char* format, va_list words) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, words);
  static_cast<Client*>(user)->trouble = text.data();
  return 1;
}

int ignore_warning(TIFF* /*tiff*/, void* /*user*/, const char* /*module*/, const char* /*format*/,
                   va_list /*words*/) {
  return 1;
}

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

Tiff opened_by_libtiff(Client& client) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                 &TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_error, &client);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore_warning, nullptr);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), most_memory);
  // m: never map the file.
  return {TIFFClientOpenExt(
              client.file->path().c_str(), "rm", &client, read_bytes,
              [](thandle_t, void*, tmsize_t) -> tmsize_t { return 0; }, seek, [](thandle_t) { return 0; },
              size_of, nullptr, nullptr, options.get()),
          &TIFFClose};
}

template <typename Value>
Value field(TIFF* tiff, std::uint32_t tag, Value otherwise) {
  Value value{};
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : otherwise;
}

std::optional<ScalarType> scalar_type(int format, int bits) {
  using enum ScalarType;
  if (format == SAMPLEFORMAT_IEEEFP)
    return bits == 32 ? std::optional(f32) : bits == 64 ? std::optional(f64) : std::nullopt;
  if (format != SAMPLEFORMAT_UINT && format != SAMPLEFORMAT_INT && format != SAMPLEFORMAT_VOID)
    return std::nullopt;
  const bool with_sign = format == SAMPLEFORMAT_INT;
  switch (bits) {
    case 8:
      return with_sign ? i8 : u8;
    case 16:
      return with_sign ? i16 : u16;
    case 32:
      return with_sign ? i32 : u32;
    case 64:
      return with_sign ? i64 : u64;
    default:
      return std::nullopt;
  }
}

/// The properties of the current page.
struct Page {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  ScalarType type = ScalarType::u8;

  bool operator==(const Page&) const = default;
};

Page page_of(TIFF* tiff, const std::string& path) {
  const auto samples = field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  const auto meaning = field<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  if (samples != 1 || (meaning != PHOTOMETRIC_MINISBLACK && meaning != PHOTOMETRIC_MINISWHITE))
    fail_tiff(path, "its pixels are colours, not scalars; extract one component first");
  const auto bits = field<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1);
  const auto format = field<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  const std::optional<ScalarType> type = scalar_type(format, bits);
  if (!type)
    fail_tiff(path,
              fmt::format("pixels of {} bits in sample format {} are not read; write integers of 8 to 64 bits, "
                          "or floats of 32 or 64",
                          bits, format));
  return {field<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0), field<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0),
          *type};
}

/// Refuses dialects of microscopes, whose data after the first page other programs cannot find.
void check_dialect(TIFF* tiff, const std::string& path) {
  constexpr std::uint32_t metamorph = 33629, zeiss = 34412;
  std::uint32_t count = 0;
  const void* data = nullptr;
  for (const auto& [tag, name] : {std::pair{metamorph, "MetaMorph (STK)"}, std::pair{zeiss, "Zeiss (LSM)"}})
    if (TIFFGetField(tiff, tag, &count, &data) == 1)
      fail_tiff(path, fmt::format("it is a stack of {}, which is not read; write it as OME-TIFF", name));
  if (field<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) != ORIENTATION_TOPLEFT)
    fail_tiff(path,
              "its rows or columns go backwards (its orientation); write it with the first row at the top");
}

bool is_thumbnail(TIFF* tiff) {
  return (field<std::uint32_t>(tiff, TIFFTAG_SUBFILETYPE, 0) & FILETYPE_REDUCEDIMAGE) != 0;
}

}  // namespace

bool is_tiff(const std::string& path, const ReadableFiles& files) {
  std::array<char, 4> mark{};
  const std::unique_ptr<ByteSource> file = open_file(path, files);
  const std::size_t got = file->read(0, std::as_writable_bytes(std::span(mark)));
  const std::string_view text(mark.data(), got);
  using namespace std::string_view_literals;
  return text == "II*\0"sv || text == "MM\0*"sv || text == "II+\0"sv || text == "MM\0+"sv;
}

class TiffFile::Pages {
 public:
  Pages(const std::string& path, const ReadableFiles& files)
      : client_{.file = open_file(path, files), .trouble = {}}, tiff_(opened_by_libtiff(client_)) {
    if (!tiff_) fail_tiff(path, trouble("its header is damaged"));
    header_.path = path;
    const char* words = nullptr;
    const TiffDescription described = TIFFGetField(tiff_.get(), TIFFTAG_IMAGEDESCRIPTION, &words) == 1
                                          ? tiff_description(words, path)
                                          : TiffDescription();
    check_dialect(tiff_.get(), path);
    find_pages(described);
    arrange(described);
    checked_bytes({first_.width, first_.height, header_.slices}, header_.type, path);
    header_.size = {int(first_.width), int(first_.height)};
    const tmsize_t piece =
        TIFFIsTiled(tiff_.get()) != 0 ? TIFFTileSize(tiff_.get()) : TIFFStripSize(tiff_.get());
    if (piece < 0 || piece > most_memory)
      fail_tiff(path,
                fmt::format("its strips or tiles have more than {} bytes; write smaller ones", most_memory));
    header_.piece_bytes = std::size_t(piece);
  }

  const TiffHeader& header() const { return header_; }
  std::uint64_t bytes_read() const { return client_.file->bytes_from_file(); }

  void read(int slice, int time_step, int channel, std::span<std::byte> scalars) {
    const std::size_t number =
        std::size_t(slice * description_.slice_stride + time_step * description_.step_stride +
                    channel * description_.channel_stride);
    if (contiguous_from_) return read_contiguous(number, scalars);
    if (TIFFSetSubDirectory(tiff_.get(), places_[number]) != 1)
      fail_tiff(header_.path, trouble("a page is damaged"));
    TIFFIsTiled(tiff_.get()) != 0 ? read_tiles(scalars) : read_strips(scalars);
  }

 private:
  std::string trouble(const std::string& otherwise) const {
    return fmt::format("{}; get the file again", client_.trouble.empty() ? otherwise : client_.trouble);
  }

  /// Finds the offset of each page.
  void find_pages(const TiffDescription& described) {
    do {
      if (is_thumbnail(tiff_.get())) continue;
      const Page page = page_of(tiff_.get(), header_.path);
      if (places_.empty()) first_ = page;
      if (page != first_)
        fail_tiff(header_.path,
                  fmt::format("page {} has {} x {} pixels of {}, where the first one has {} x {} of {}; "
                              "write slices of one size and type",
                              places_.size(), page.width, page.height, name_of(page.type), first_.width,
                              first_.height, name_of(first_.type)));
      places_.push_back(TIFFCurrentDirOffset(tiff_.get()));
      if (places_.size() > most_pages) fail_tiff(header_.path, "it has too many pages for a volume; cut it");
    } while (TIFFReadDirectory(tiff_.get()) == 1);
    if (!client_.trouble.empty()) fail_tiff(header_.path, trouble(""));
    if (places_.empty()) fail_tiff(header_.path, "it has no image; give another file");
    if (TIFFSetSubDirectory(tiff_.get(), places_.front()) != 1)
      fail_tiff(header_.path, trouble("its first page is damaged"));
    header_.type = first_.type;
    // ImageJ writes stacks beyond 4 GB as a single page, followed directly by the pixels of the others.
    std::uint64_t* offsets = nullptr;
    if (described.by_imagej && places_.size() == 1 && described.images() > 1 &&
        field<std::uint16_t>(tiff_.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE) == COMPRESSION_NONE &&
        TIFFGetField(tiff_.get(), TIFFTAG_STRIPOFFSETS, &offsets) == 1 && offsets != nullptr)
      contiguous_from_ = offsets[0];
  }

  /// Assigns pages to slices and time steps.
  void arrange(const TiffDescription& described) {
    const std::int64_t pages = contiguous_from_ ? described.images() : std::int64_t(places_.size());
    if (described.slices > 0 && described.images() != pages)
      fail_tiff(header_.path,
                fmt::format("it speaks of {} images, but has {}: the others may lie in other files; write "
                            "them into one",
                            described.images(), pages));
    header_.spacing = described.spacing;
    if (described.by_imagej) {
      // Resolution is in pixels per unit of length, the same unit as that of the slice distance.
      const float across = field<float>(tiff_.get(), TIFFTAG_XRESOLUTION, 1);
      const float down = field<float>(tiff_.get(), TIFFTAG_YRESOLUTION, 1);
      header_.spacing[0] = believable_spacing(1 / double(across));
      header_.spacing[1] = believable_spacing(1 / double(down));
    }
    header_.channels = int(described.channels);
    description_ = described;
    header_.time_steps = checked_time_steps(described.slices > 0 ? described.time_steps : 1, header_.path);
    const std::int64_t slices = described.slices > 0 ? described.slices : pages;
    header_.slices = int(std::min<std::int64_t>(slices, std::numeric_limits<int>::max()));
  }

  void read_contiguous(std::size_t number, std::span<std::byte> scalars) {
    const std::size_t got = client_.file->read(*contiguous_from_ + number * scalars.size(), scalars);
    if (got != scalars.size()) fail_tiff(header_.path, "it is truncated; get the file again");
    const std::size_t scalar = bytes_per_scalar(header_.type);
    if (TIFFIsByteSwapped(tiff_.get()) == 0 || scalar == 1) return;
    for (std::size_t at = 0; at + scalar <= scalars.size(); at += scalar)
      std::reverse(scalars.begin() + std::ptrdiff_t(at), scalars.begin() + std::ptrdiff_t(at + scalar));
  }

  void read_strips(std::span<std::byte> scalars) {
    const std::size_t strip = std::size_t(std::max<tmsize_t>(0, TIFFStripSize(tiff_.get())));
    const std::uint32_t strips = TIFFNumberOfStrips(tiff_.get());
    std::size_t at = 0;
    for (std::uint32_t i = 0; i < strips && at < scalars.size(); ++i) {
      const std::size_t wanted = std::min(strip, scalars.size() - at);
      const tmsize_t got = TIFFReadEncodedStrip(tiff_.get(), i, scalars.data() + at, tmsize_t(wanted));
      if (got < 0 || std::size_t(got) != wanted) fail_tiff(header_.path, trouble("a strip is damaged"));
      at += wanted;
    }
    if (at != scalars.size()) fail_tiff(header_.path, trouble("it has fewer rows than its header says"));
  }

  void read_tiles(std::span<std::byte> scalars) {
    const std::size_t scalar = bytes_per_scalar(header_.type);
    const auto width = field<std::uint32_t>(tiff_.get(), TIFFTAG_TILEWIDTH, 0);
    const auto height = field<std::uint32_t>(tiff_.get(), TIFFTAG_TILELENGTH, 0);
    std::vector<std::byte> tile(header_.piece_bytes);
    if (tile.size() != std::size_t(width) * height * scalar || tile.empty())
      fail_tiff(header_.path, "its tiles are not of the size that its header says; get the file again");
    for (std::uint32_t y = 0; y < first_.height; y += height)
      for (std::uint32_t x = 0; x < first_.width; x += width) {
        const std::uint32_t number = TIFFComputeTile(tiff_.get(), x, y, 0, 0);
        if (TIFFReadEncodedTile(tiff_.get(), number, tile.data(), tmsize_t(tile.size())) !=
            tmsize_t(tile.size()))
          fail_tiff(header_.path, trouble("a tile is damaged"));
        const std::size_t columns = std::min(width, first_.width - x) * scalar;
        for (std::uint32_t row = 0; row < std::min(height, first_.height - y); ++row)
          std::copy_n(tile.data() + std::size_t(row) * width * scalar, columns,
                      scalars.data() + (std::size_t(y + row) * first_.width + x) * scalar);
      }
  }

  Client client_;
  Tiff tiff_;
  TiffHeader header_;
  TiffDescription description_;
  Page first_;
  std::vector<std::uint64_t> places_;
  std::optional<std::uint64_t> contiguous_from_;
};

TiffFile::TiffFile(const std::string& path, const ReadableFiles& files)
    : pages_(std::make_unique<Pages>(path, files)) {}

TiffFile::~TiffFile() = default;

const TiffHeader& TiffFile::header() const {
  return pages_->header();
}

void TiffFile::read(int slice, int time_step, int channel, std::span<std::byte> scalars) {
  pages_->read(slice, time_step, channel, scalars);
}

std::uint64_t TiffFile::bytes_read() const {
  return pages_->bytes_read();
}

}  // namespace understudy::volume
