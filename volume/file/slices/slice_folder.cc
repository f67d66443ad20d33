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

/// Null where `path` is no folder.
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

/// Whether two names are those of neighbouring slices: one run of digits counts on, and all else is the same.
bool follows(const std::string& before, const std::string& name) {
  std::size_t i = 0, k = 0;
  int counted = 0;
  const auto is_decimal = [](char c) { return c >= '0' && c <= '9'; };
  while (i < before.size() && k < name.size()) {
    if (!is_decimal(before[i]) || !is_decimal(name[k])) {
      if (before[i++] != name[k++]) return false;
      continue;
    }
    const std::size_t i_end = std::min(before.size(), before.find_first_not_of("0123456789", i));
    const std::size_t k_end = std::min(name.size(), name.find_first_not_of("0123456789", k));
    constexpr std::size_t most_digits = 18;
    if (i_end - i > most_digits || k_end - k > most_digits) return false;
    const long long a = std::stoll(before.substr(i, i_end - i)), b = std::stoll(name.substr(k, k_end - k));
    if (b != a && b != a + 1) return false;
    counted += b == a + 1 ? 1 : 0;
    i = i_end;
    k = k_end;
  }
  return i >= before.size() && k >= name.size() && counted == 1;
}

void check_that_they_follow(const std::vector<std::string>& files) {
  for (std::size_t i = 1; i < files.size(); ++i) {
    const std::string before = std::filesystem::path(files[i - 1]).filename();
    const std::string name = std::filesystem::path(files[i]).filename();
    if (!follows(before, name))
      fail_folder(files[i], fmt::format("does not follow {}: names of slices count on by one, and are the same "
                                        "otherwise; put those of one volume into a folder of their own",
                                        before));
  }
}

}  // namespace

bool is_folder(const std::string& path, const ReadableFiles& readable) {
  try {
    return open_folder(path, readable) != nullptr;
  } catch (const FileError&) {
    return false;  // whoever reads it says why
  }
}

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
                                              const ReadableFiles& readable) {
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
  return open_dicom_series(folder, dicom, "", time_step, readable);
}

std::unique_ptr<VolumeFile> open_series_of_file(const std::string& file, int time_step,
                                                const ReadableFiles& readable) {
  const std::filesystem::path parent = std::filesystem::path(file).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  std::vector<std::string> dicom;
  for (const std::string& beside : files_in_folder(folder, readable))
    if (is_dicom(beside, readable)) dicom.push_back(beside);
  return open_dicom_series(folder, dicom, file, time_step, readable);
}

}  // namespace understudy::volume
