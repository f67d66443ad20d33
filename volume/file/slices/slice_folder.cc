// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/slice_folder.h"

#include <dirent.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "volume/file/byte_source.h"
#include "volume/file/file_error.h"
#include "volume/file/series.h"
#include "volume/file/slices/dicom_image.h"
#include "volume/file/slices/dicom_series.h"
#include "volume/file/slices/tiff_image.h"
#include "volume/file/slices/tiff_stack.h"

namespace understudy::volume {

namespace {

constexpr std::size_t most_files = std::size_t(1) << 20;

struct CloseFolder {
  void operator()(DIR* folder) const { ::closedir(folder); }
};
using OpenFolder = std::unique_ptr<DIR, CloseFolder>;

[[noreturn]] void fail_folder(const std::string& folder, const std::string& what) {
  throw FileError(fmt::format("{}: {}", folder, what));
}

/// Null if `path` is not a folder.
OpenFolder open_folder(const std::string& path, const ReadableFiles& readable) {
  const int number = readable.open(path);
  DIR* const folder = ::fdopendir(number);
  if (folder == nullptr) ::close(number);
  return OpenFolder(folder);
}

bool is_regular(DIR* folder, const dirent& entry) {
  if (entry.d_type != DT_UNKNOWN && entry.d_type != DT_LNK) return entry.d_type == DT_REG;
  struct stat about {};
  return ::fstatat(::dirfd(folder), entry.d_name, &about, 0) == 0 && S_ISREG(about.st_mode);
}

/// If two names differ in only one run of digits, the difference of these numbers; otherwise 0.
long long counted_on(const std::string& before, const std::string& name) {
  const auto is_decimal = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, k = 0;
  long long step = 0;
  while (i < before.size() && k < name.size()) {
    if (!is_decimal(before[i]) || !is_decimal(name[k])) {
      if (before[i++] != name[k++]) return 0;
      continue;
    }
    const std::size_t i_end = std::min(before.size(), before.find_first_not_of("0123456789", i));
    const std::size_t k_end = std::min(name.size(), name.find_first_not_of("0123456789", k));
    const std::string a = before.substr(i, i_end - i), b = name.substr(k, k_end - k);
    constexpr std::size_t most_digits = 18;
    if (a != b) {
      if (step != 0 || std::max(a.size(), b.size()) > most_digits) return 0;
      step = std::stoll(b) - std::stoll(a);
    }
    i = i_end;
    k = k_end;
  }
  return i >= before.size() && k >= name.size() ? step : 0;
}

void check_that_they_follow(const std::vector<std::string>& files) {
  long long first_step = 0;
  for (std::size_t i = 1; i < files.size(); ++i) {
    const std::string before = std::filesystem::path(files[i - 1]).filename();
    const long long step = counted_on(before, std::filesystem::path(files[i]).filename());
    if (i == 1) first_step = step;
    if (step <= 0 || step != first_step)
      fail_folder(files[i],
                  fmt::format("does not follow {}: one number in the names of slices counts on, by {} here, "
                              "and all else is the same; put those of one volume into a folder of their own",
                              before, std::max(1LL, first_step)));
  }
}

}  // namespace

std::vector<std::string> files_in_folder(const std::string& folder, const ReadableFiles& readable) {
  const OpenFolder open = open_folder(folder, readable);
  if (!open) fail_folder(folder, fmt::format("is no folder that can be read: {}", std::strerror(errno)));
  std::vector<std::string> files;
  while (const dirent* const entry = ::readdir(open.get())) {
    if (entry->d_name[0] == '.' || !is_regular(open.get(), *entry)) continue;
    files.push_back((std::filesystem::path(folder) / entry->d_name).string());
    if (files.size() > most_files)
      fail_folder(folder, "more files lie in this folder than a volume has slices; name a file");
  }
  std::ranges::sort(files, comes_before);
  return files;
}

std::unique_ptr<VolumeFile> open_slice_folder(const std::string& folder, int time_step,
                                              const ReadableFiles& readable, DicomHeaders& headers) {
  std::vector<std::string> dicom, tiff;
  for (const std::string& file : files_in_folder(folder, readable)) {
    if (is_dicom(file, readable))
      dicom.push_back(file);
    else if (is_tiff(file, readable))
      tiff.push_back(file);
    else if (has_extension(file, ".tif") || has_extension(file, ".tiff"))
      fail_folder(file, "is named as a TIFF file, but is none; get it again, or remove it");
  }
  if (!dicom.empty() && !tiff.empty())
    fail_folder(folder, fmt::format("{} DICOM and {} TIFF files lie in this folder; name a file of the volume",
                                    dicom.size(), tiff.size()));
  check_that_they_follow(tiff);
  if (!tiff.empty()) return open_tiff_stack(folder, std::move(tiff), readable);
  if (dicom.empty())
    fail_folder(
        folder,
        "is a folder without slices in DICOM or TIFF files; name the volume file in it, or the folder in "
        "it that holds slices");
  return open_dicom_series(folder, dicom, "", time_step, readable, headers);
}

std::unique_ptr<VolumeFile> open_series_of_file(const std::string& file, int time_step,
                                                const ReadableFiles& readable, DicomHeaders& headers) {
  const std::filesystem::path parent = std::filesystem::path(file).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  std::vector<std::string> dicom;
  for (const std::string& beside : files_in_folder(folder, readable))
    if (is_dicom(beside, readable)) dicom.push_back(beside);
  return open_dicom_series(folder, dicom, file, time_step, readable, headers);
}

}  // namespace understudy::volume
