// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/dicom_image.h"

#include <dcmtk/config/osconfig.h>
// Must precede the rest of DCMTK.
#include <dcmtk/dcmdata/dcfcache.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <mutex>
#include <new>
#include <stdexcept>

#include "volume/file/byte_source.h"
#include "volume/file/file_error.h"
#include "volume/file/header_fields.h"
#include "volume/file/slices/dicom_nesting.h"
#include "volume/file/slices/dicom_rle.h"
#include "volume/file/slices/jpeg2000.h"
#include "volume/file/slices/jpeg_header.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

namespace {

constexpr std::uint64_t preamble_bytes = 128;
constexpr int most_frames = 1 << 17;

/// By default, DCMTK also logs errors to the standard error stream.
void prepare_dcmtk() {
  static std::once_flag once;
  std::call_once(once, [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    // Archives write elements with unknown value representations, which DCMTK can look up.
    dcmEnableUnknownVRConversion.set(OFTrue);
    DJDecoderRegistration::registerCodecs();
    DJLSDecoderRegistration::registerCodecs();
  });
}

/// Converts exceptions caused by a damaged file to FileError.
template <typename Function>
auto with_dcmtk(const std::string& path, const Function& function) {
  prepare_dcmtk();
  try {
    return function();
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    fail_dicom(path, fmt::format("it is damaged ({}); get the file again", error.what()));
  }
}

/// An open file under a name that DCMTK can open, so that permissions are checked only once.
class OpenFile {
 public:
  OpenFile(const std::string& path, const ReadableFiles& files)
      : number_(files.open(path)), name_(fmt::format("/proc/self/fd/{}", number_)) {
    struct stat about {};
    if (::fstat(number_, &about) == 0 && S_ISREG(about.st_mode)) {
      bytes_ = std::uint64_t(about.st_size);
      return;
    }
    ::close(number_);
    throw FileError(fmt::format("{}: is no regular file; write its contents into one first", path));
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { ::close(number_); }

  OFFilename name() const { return OFFilename(name_.c_str()); }
  std::uint64_t bytes() const { return bytes_; }

 private:
  int number_;
  std::string name_;
  std::uint64_t bytes_ = 0;
};

using Numbers = std::vector<double>;

/// The numbers before the first invalid one, for any value representation.
Numbers numbers_of(DcmItem* item, const DcmTagKey& tag, std::size_t most) {
  Numbers found;
  OFString text;
  DcmElement* element = nullptr;
  // For type UN, the text would be that of bytes.
  if (item == nullptr || item->findAndGetElement(tag, element).bad() || element->ident() == EVR_UN ||
      element->getOFStringArray(text).bad())
    return found;
  for (const char* at = text.c_str(); *at != '\0' && found.size() < most;) {
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end == at || !std::isfinite(number)) break;
    found.push_back(number);
    while (*end == ' ') ++end;
    at = *end == '\\' ? end + 1 : end;
  }
  return found;
}

std::string text_of(DcmItem& item, const DcmTagKey& tag) {
  OFString text;
  return item.findAndGetOFString(tag, text).good() ? trimmed(text.c_str()) : std::string();
}

int integer_of(DcmItem& item, const DcmTagKey& tag, int otherwise) {
  Sint32 number = 0;
  return item.findAndGetSint32(tag, number).good() ? int(number) : otherwise;
}

unsigned short_of(DcmItem& item, const DcmTagKey& tag, unsigned otherwise) {
  Uint16 number = 0;
  return item.findAndGetUint16(tag, number).good() ? number : otherwise;
}

/// The first item of a sequence.
DcmItem* item_of(DcmItem* item, const DcmTagKey& sequence) {
  DcmItem* found = nullptr;
  return item != nullptr && item->findAndGetSequenceItem(sequence, found).good() ? found : nullptr;
}

/// How the bits of a pixel form a number.
struct PixelBits {
  unsigned allocated = 0;
  unsigned stored = 0;
  unsigned high = 0;
  bool with_sign = false;

  /// Whether the allocated bits are the number itself.
  bool fill_all() const { return stored == allocated; }
};

PixelBits bits_of(DcmItem& image) {
  PixelBits bits;
  bits.allocated = short_of(image, DCM_BitsAllocated, 0);
  bits.stored = short_of(image, DCM_BitsStored, bits.allocated);
  bits.high = short_of(image, DCM_HighBit, bits.stored - 1);
  bits.with_sign = short_of(image, DCM_PixelRepresentation, 0) == 1;
  return bits;
}

std::optional<ScalarType> scalar_type(const PixelBits& bits) {
  const bool possible = bits.stored >= 1 && bits.high < bits.allocated && bits.high + 1 >= bits.stored;
  if (!possible) return std::nullopt;
  switch (bits.allocated) {
    case 8:
      return bits.with_sign ? ScalarType::i8 : ScalarType::u8;
    case 16:
      return bits.with_sign ? ScalarType::i16 : ScalarType::u16;
    case 32:
      return bits.with_sign ? ScalarType::i32 : ScalarType::u32;
    default:
      return std::nullopt;
  }
}

/// The meaning of the Frame Increment Pointer.
enum class FrameOrder { by_place, by_time, unknown };

FrameOrder frame_order(DcmItem& image) {
  DcmElement* pointer = nullptr;
  if (image.findAndGetElement(DCM_FrameIncrementPointer, pointer).bad() || pointer->getVM() == 0)
    return FrameOrder::by_place;
  FrameOrder order = FrameOrder::by_place;
  for (unsigned long i = 0; i < pointer->getVM(); ++i) {
    DcmTagKey by;
    if (pointer->getTagVal(by, i).bad()) return FrameOrder::unknown;
    if (by == DCM_SliceVector || by == DCM_GridFrameOffsetVector) continue;
    const bool only_time = (by == DCM_FrameTime || by == DCM_FrameTimeVector) && pointer->getVM() == 1;
    if (!only_time) return FrameOrder::unknown;
    order = FrameOrder::by_time;
  }
  return order;
}

/// Why an image cannot be shown as scalars; empty if it can.
std::string trouble_with(DcmItem& image) {
  const std::string meaning = text_of(image, DCM_PhotometricInterpretation);
  if (short_of(image, DCM_SamplesPerPixel, 1) != 1 || (meaning != "MONOCHROME1" && meaning != "MONOCHROME2"))
    return fmt::format("its pixels are colours ({}), not scalars; extract one component first", meaning);
  const PixelBits bits = bits_of(image);
  if (!scalar_type(bits))
    return fmt::format("pixels of {} bits in {} are not read; write them with 8, 16 or 32 bits first",
                       bits.stored, bits.allocated);
  if (image.tagExists(DCM_ModalityLUTSequence))
    return "its values are told by a table (Modality LUT), which is not read; convert it first (dcm2niix)";
  if (integer_of(image, DCM_NumberOfFrames, 1) > 1 && frame_order(image) == FrameOrder::unknown)
    return "its frames follow each other in an order that is not read (Frame Increment Pointer); convert it "
           "first";
  OFString kind;
  if (image.findAndGetOFStringArray(DCM_ImageType, kind).good() && kind.find("MOSAIC") != OFString_npos)
    return "its slices lie beside each other in one image (MOSAIC); convert the series first (dcm2niix)";
  return {};
}

/// The elements of a multi-frame image: `macro` of one frame or of all frames, or the image itself.
class Frames {
 public:
  explicit Frames(DcmItem& image)
      : image_(image), shared_(item_of(&image, DCM_SharedFunctionalGroupsSequence)) {
    DcmSequenceOfItems* groups = nullptr;
    if (image.findAndGetSequence(DCM_PerFrameFunctionalGroupsSequence, groups).bad()) return;
    // Access by index would search from the first item every time.
    for (DcmObject* item = nullptr; (item = groups->nextInContainer(item)) != nullptr;)
      own_.push_back(dynamic_cast<DcmItem*>(item));
  }

  /// Number of frames with elements of their own.
  std::size_t own() const { return own_.size(); }

  Numbers numbers(std::size_t frame, const DcmTagKey& macro, const DcmTagKey& tag, std::size_t most) const {
    DcmItem* const own = frame < own_.size() ? item_of(own_[frame], macro) : nullptr;
    for (DcmItem* const item : {own, item_of(shared_, macro), &image_})
      if (Numbers found = numbers_of(item, tag, most); !found.empty()) return found;
    return {};
  }

 private:
  DcmItem& image_;
  DcmItem* shared_;
  std::vector<DcmItem*> own_;
};

std::optional<DicomPlane> plane_of(const Numbers& position, const Numbers& ways) {
  if (position.size() != 3 || ways.size() != 6) return std::nullopt;
  const Vec3 rows{ways[0], ways[1], ways[2]}, columns{ways[3], ways[4], ways[5]}, normal = cross(rows, columns);
  const double size = length(normal);
  constexpr double shortest = 0.5;  // 1 for perpendicular rows and columns
  if (!(size > shortest)) return std::nullopt;
  return DicomPlane{{position[0], position[1], position[2]},
                    scale(rows, 1 / length(rows)),
                    scale(columns, 1 / length(columns)),
                    scale(normal, 1 / size)};
}

/// Places frames without elements of their own along the normal of the first one, by the `offsets` of
/// radiotherapy; without these, their positions are unknown.
void place_by_offsets(std::vector<DicomFrame>& frames, const Numbers& offsets) {
  const std::optional<DicomPlane> first = frames.front().plane;
  const bool is_told = first && offsets.size() == frames.size();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].plane = is_told ? first : std::nullopt;
    if (is_told)
      frames[i].plane->position = add(first->position, scale(first->normal, offsets[i] - offsets[0]));
  }
}

std::vector<DicomFrame> frames_of(DcmItem& image, std::uint64_t file_bytes, const std::string& path) {
  // Each frame has at least a header if compressed, and its pixels otherwise.
  constexpr std::uint64_t least_bytes = 8;
  const int count = integer_of(image, DCM_NumberOfFrames, 1);
  const std::uint64_t pixels =
      std::uint64_t(short_of(image, DCM_Rows, 0)) * std::uint64_t(short_of(image, DCM_Columns, 0));
  if (count < 1 ||
      std::uint64_t(count) > file_bytes / std::min(least_bytes, std::max<std::uint64_t>(1, pixels)))
    fail_dicom(path, fmt::format("its header speaks of {} frames; get the file again", count));
  const Frames frames(image);
  const Numbers dose = numbers_of(&image, DCM_DoseGridScaling, 1);
  std::vector<DicomFrame> found(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < found.size(); ++i) {
    DicomFrame& frame = found[i];
    if (i == 0 || frames.own() == found.size())
      frame.plane = plane_of(frames.numbers(i, DCM_PlanePositionSequence, DCM_ImagePositionPatient, 3),
                             frames.numbers(i, DCM_PlaneOrientationSequence, DCM_ImageOrientationPatient, 6));
    if (const Numbers time = frames.numbers(i, DCM_FrameContentSequence, DCM_TemporalPositionIndex, 1);
        !time.empty())
      frame.time = time[0];
    const Numbers slope = frames.numbers(i, DCM_PixelValueTransformationSequence, DCM_RescaleSlope, 1);
    const Numbers intercept = frames.numbers(i, DCM_PixelValueTransformationSequence, DCM_RescaleIntercept, 1);
    if (!slope.empty() && !intercept.empty() && slope[0] != 0) {
      frame.slope = slope[0];
      frame.intercept = intercept[0];
    } else if (!dose.empty() && dose[0] != 0) {
      frame.slope = dose[0];
    }
  }
  if (found.size() > 1 && frames.own() != found.size())
    place_by_offsets(found, numbers_of(&image, DCM_GridFrameOffsetVector, found.size()));
  return found;
}

std::array<double, 5> order_in_time(DcmItem& image) {
  const auto first = [&](const DcmTagKey& tag) {
    const Numbers number = numbers_of(&image, tag, 1);
    return number.empty() ? 0.0 : number[0];
  };
  return {first(DCM_TemporalPositionIdentifier), first(DCM_AcquisitionNumber), first(DCM_TriggerTime),
          first(DCM_EchoNumbers), first(DCM_InstanceNumber)};
}

Vec3 spacing_of(DcmItem& image) {
  const Frames frames(image);
  const auto first = [&](const DcmTagKey& tag, std::size_t most) {
    return frames.numbers(0, DCM_PixelMeasuresSequence, tag, most);
  };
  Numbers pixels = first(DCM_PixelSpacing, 2);
  if (pixels.size() != 2) pixels = numbers_of(&image, DCM_ImagerPixelSpacing, 2);
  if (pixels.size() != 2) pixels = {1, 1};
  Numbers slices = first(DCM_SpacingBetweenSlices, 1);
  if (slices.empty()) slices = first(DCM_SliceThickness, 1);
  // DICOM lists the spacing between rows first, which is along y.
  return {believable_spacing(pixels[1]), believable_spacing(pixels[0]),
          believable_spacing(slices.empty() ? 1 : slices[0])};
}

DicomHeader header_of(DcmItem& image, std::uint64_t file_bytes, const std::string& path) {
  DicomHeader header;
  header.path = path;
  header.file_bytes = file_bytes;
  header.series = text_of(image, DCM_SeriesInstanceUID);
  header.image = text_of(image, DCM_SOPInstanceUID);
  header.description =
      fmt::format("series {} '{}'", text_of(image, DCM_SeriesNumber), text_of(image, DCM_SeriesDescription));
  header.trouble = trouble_with(image);
  if (!header.trouble.empty()) return header;
  header.order = order_in_time(image);
  header.frames_are_times = frame_order(image) == FrameOrder::by_time;
  header.size = {int(short_of(image, DCM_Columns, 0)), int(short_of(image, DCM_Rows, 0))};
  header.type = *scalar_type(bits_of(image));
  header.frames = frames_of(image, file_bytes, path);
  checked_bytes({header.size[0], header.size[1], 1}, header.type, path);
  header.spacing = spacing_of(image);
  return header;
}

/// Extracts numbers from the stored bits, in place.
template <typename Unsigned>
void extract(const PixelBits& bits, std::span<std::byte> pixels) {
  constexpr unsigned width = std::numeric_limits<Unsigned>::digits;
  const unsigned above = bits.allocated - 1 - bits.high, unused = width - bits.stored;
  for (std::size_t at = 0; at + sizeof(Unsigned) <= pixels.size(); at += sizeof(Unsigned)) {
    Unsigned pixel;
    std::memcpy(&pixel, pixels.data() + at, sizeof pixel);
    pixel = Unsigned(pixel << above);  // moves the highest used bit to the top
    if (bits.with_sign)
      pixel = Unsigned(std::make_signed_t<Unsigned>(pixel) >> unused);
    else
      pixel = Unsigned(pixel >> unused);
    std::memcpy(pixels.data() + at, &pixel, sizeof pixel);
  }
}

}  // namespace

void fail_dicom(const std::string& path, const std::string& what) {
  throw FileError(fmt::format("{}: DICOM: {}", path, what));
}

bool is_dicom(const std::string& path, const ReadableFiles& files) {
  std::array<char, preamble_bytes + 4> begin{};
  const std::unique_ptr<ByteSource> file = open_file(path, files);
  const std::size_t got = file->read(0, std::as_writable_bytes(std::span(begin)));
  const std::string_view text(begin.data(), got);
  if (text.substr(std::min(got, std::size_t(preamble_bytes))) == "DICM") return true;
  // Elements of group 8 come first, in little-endian order.
  return has_extension(path, ".dcm") && text.substr(0, 2) == std::string_view("\x08\0", 2);
}

std::optional<DicomHeader> dicom_header(const std::string& path, const ReadableFiles& files) {
  return with_dcmtk(path, [&]() -> std::optional<DicomHeader> {
    constexpr int deepest = 32;  // reports are deeply nested, images hardly
    if (!sequences_nest_within(*open_file(path, files), deepest))
      fail_dicom(path, fmt::format(
                           "its header is damaged: elements of no type, or sequences more than {} deep in each "
                           "other; get the file again",
                           deepest));
    const OpenFile open(path, files);
    DcmMetaInfo meta;
    OFString syntax;
    // The whole file would have to be inflated to read its header.
    if (meta.loadFile(open.name()).good() && meta.findAndGetOFString(DCM_TransferSyntaxUID, syntax).good() &&
        trimmed(syntax.c_str()) == UID_DeflatedExplicitVRLittleEndianTransferSyntax) {
      DicomHeader header;
      header.path = path;
      header.trouble = "it is deflated, which is not read; write it without (gdcmconv --raw)";
      return header;
    }
    DcmFileFormat file;
    const OFCondition read = file.loadFileUntilTag(open.name(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength,
                                                   ERM_autoDetect, DCM_PixelData);
    if (read.bad())
      fail_dicom(path, fmt::format("its header is damaged ({}); get the file again", read.text()));
    DcmItem& image = *file.getDataset();
    const bool is_image =
        image.tagExists(DCM_Rows) && image.tagExists(DCM_Columns) && image.tagExists(DCM_BitsAllocated);
    if (!is_image) return std::nullopt;
    return header_of(image, open.bytes(), path);
  });
}

class DicomFrames::Decoder {
 public:
  Decoder(const DicomHeader& header, const ReadableFiles& files) : header_(header), open_(header.path, files) {
    // Pixels stay in the file until they are requested.
    constexpr std::uint16_t group = 0x7fe0, behind_pixels = 0x0011;
    const OFCondition read = file_.loadFileUntilTag(open_.name(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength,
                                                    ERM_autoDetect, DcmTagKey(group, behind_pixels));
    if (read.bad()) fail(read.text());
    bits_ = bits_of(*file_.getDataset());
    DcmElement* pixels = nullptr;
    file_.getDataset()->findAndGetElement(DCM_PixelData, pixels);
    pixels_ = dynamic_cast<DcmPixelData*>(pixels);
    if (pixels_ == nullptr) fail("there are none");
  }

  const std::string& path() const { return header_.path; }

  void read(int frame, std::span<std::byte> scalars) {
    try {
      decode(frame, scalars);
    } catch (const std::runtime_error& error) {
      fail(error.what());
    }
    if (bits_.fill_all()) return;
    if (bits_.allocated == 8) extract<std::uint8_t>(bits_, scalars);
    if (bits_.allocated == 16) extract<std::uint16_t>(bits_, scalars);
    if (bits_.allocated == 32) extract<std::uint32_t>(bits_, scalars);
  }

 private:
  // These throw std::runtime_error with the reason.

  void decode(int frame, std::span<std::byte> scalars) {
    const E_TransferSyntax syntax = file_.getDataset()->getOriginalXfer();
    if (DcmXfer(syntax).isEncapsulated()) {
      const std::vector<std::byte> image = fragments_of(frame);
      if (syntax == EXS_RLELossless) return decode_dicom_rle(image, bytes_per_scalar(header_.type), scalars);
      if (syntax == EXS_JPEG2000LosslessOnly || syntax == EXS_JPEG2000) return read_jpeg2000(image, scalars);
      if (syntax >= EXS_JPEGProcess1 && syntax <= EXS_JPEGProcess14SV1) check_jpeg(image);
    }
    read_by_dcmtk(frame, scalars);
  }

  /// DCMTK decodes as many bytes as the JPEG header specifies, so it must match the DICOM header.
  void check_jpeg(std::span<const std::byte> image) const {
    const std::optional<JpegFrame> found = first_jpeg_frame(image);
    if (!found) throw std::runtime_error("its JPEG header is damaged");
    constexpr unsigned bits_of_byte = 8;
    if (found->components != 1 || found->columns != unsigned(header_.size[0]) ||
        found->rows != unsigned(header_.size[1]) ||
        (found->bits > bits_of_byte) != (bits_.allocated > bits_of_byte))
      throw std::runtime_error(fmt::format("its JPEG image is one of {} x {} pixels of {} bits", found->columns,
                                           found->rows, found->bits));
  }

  void read_by_dcmtk(int frame, std::span<std::byte> scalars) {
    buffer_.resize(scalars.size() + scalars.size() % 2);  // DCMTK requires room for an even number of bytes
    OFString colours;
    // For compressed pixels, the first fragment of the frame: from a table, or searched.
    Uint32 fragment = header_.frames.size() > 1 ? Uint32(frame) + 1 : 0;
    const OFCondition done = pixels_->getUncompressedFrame(
        file_.getDataset(), Uint32(frame), fragment, buffer_.data(), Uint32(buffer_.size()), colours, &cache_);
    if (done.bad()) throw std::runtime_error(done.text());
    std::copy_n(buffer_.begin(), scalars.size(), scalars.begin());
    // DCMTK converts 16-bit words to native order, and here two of them form a pixel.
    if (bits_.allocated == 32 && file_.getDataset()->getOriginalXfer() == EXS_BigEndianExplicit)
      for (std::size_t at = 0; at + 4 <= scalars.size(); at += 4)
        std::swap_ranges(scalars.begin() + std::ptrdiff_t(at), scalars.begin() + std::ptrdiff_t(at + 2),
                         scalars.begin() + std::ptrdiff_t(at + 2));
  }

  void read_jpeg2000(std::span<const std::byte> image, std::span<std::byte> scalars) const {
    const std::vector<std::int32_t> samples = decode_jpeg2000(image, header_.size);
    const std::size_t scalar = bytes_per_scalar(header_.type);
    // Copies the lowest bytes; bits above the stored ones are extended later.
    static_assert(std::endian::native == std::endian::little);
    for (std::size_t i = 0; i < samples.size(); ++i)
      std::memcpy(scalars.data() + i * scalar, &samples[i], scalar);
  }

  /// The compressed bytes of a frame: its one fragment, or all fragments of the only frame.
  std::vector<std::byte> fragments_of(int frame) {
    DcmPixelSequence* sequence = nullptr;
    const E_TransferSyntax syntax = file_.getDataset()->getOriginalXfer();
    const OFCondition found = pixels_->getEncapsulatedRepresentation(syntax, nullptr, sequence);
    const std::size_t frames = header_.frames.size();
    // The first item is a table of frame offsets.
    const std::size_t fragments = found.good() && sequence->card() > 0 ? sequence->card() - 1 : 0;
    if (fragments < frames || (fragments != frames && frames != 1))
      throw std::runtime_error("its frames lie in several fragments");
    std::vector<std::byte> bytes;
    const std::size_t first = std::size_t(frame), end = frames == 1 ? fragments : first + 1;
    for (std::size_t i = first; i < end; ++i) {
      DcmPixelItem* item = nullptr;
      Uint8* part = nullptr;
      if (sequence->getItem(item, static_cast<unsigned long>(i + 1)).bad() || item->getUint8Array(part).bad() ||
          part == nullptr)
        throw std::runtime_error("a fragment cannot be read");
      const auto* const begin = reinterpret_cast<const std::byte*>(part);
      bytes.insert(bytes.end(), begin, begin + item->getLength());
    }
    return bytes;
  }

  [[noreturn]] void fail(const std::string& why) const {
    fail_dicom(path(),
               fmt::format("its pixels cannot be decoded ({}): they are damaged, or compressed in a way that "
                           "is not read; get the file again, or write it without compression "
                           "(gdcmconv --raw)",
                           why));
  }

  DicomHeader header_;
  OpenFile open_;
  DcmFileFormat file_;
  DcmFileCache cache_;
  DcmPixelData* pixels_ = nullptr;
  PixelBits bits_;
  std::vector<std::byte> buffer_;
};

DicomFrames::DicomFrames(const DicomHeader& header, const ReadableFiles& files)
    : decoder_(with_dcmtk(header.path, [&] { return std::make_unique<Decoder>(header, files); })) {}

DicomFrames::~DicomFrames() = default;

const std::string& DicomFrames::path() const {
  return decoder_->path();
}

void DicomFrames::read(int frame, std::span<std::byte> scalars) {
  with_dcmtk(path(), [&] { decoder_->read(frame, scalars); });
}

}  // namespace understudy::volume
