// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/dicom_headers.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include "volume/file/file_error.h"

namespace understudy::volume {

bool DicomHeaders::Version::operator==(const Version& other) const {
  const auto same = [](const timespec& a, const timespec& b) {
    return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec;
  };
  return device == other.device && number == other.number && bytes == other.bytes &&
         same(written, other.written) && same(changed, other.changed);
}

DicomHeaders::Version DicomHeaders::version_of(const std::string& path, const ReadableFiles& files) {
  const int file = files.open(path);
  struct stat about {};
  const int failed = ::fstat(file, &about);
  const int error = errno;
  ::close(file);
  if (failed != 0) throw FileError(fmt::format("{}: cannot be looked at: {}", path, std::strerror(error)));
  return {about.st_dev, about.st_ino, about.st_size, about.st_mtim, about.st_ctim};
}

std::vector<std::shared_ptr<const DicomHeader>> DicomHeaders::of(std::span<const std::string> paths,
                                                                 const ReadableFiles& files) {
  std::map<std::string, Known> known;
  std::vector<std::shared_ptr<const DicomHeader>> headers;
  for (const std::string& path : paths) {
    const Version version = version_of(path, files);
    const auto before = known_.find(path);
    Known now{version, nullptr};
    if (before != known_.end() && before->second.version == version)
      now.header = before->second.header;
    else if (std::optional<DicomHeader> parsed = dicom_header(path, files))
      now.header = std::make_shared<const DicomHeader>(std::move(*parsed));
    if (now.header) headers.push_back(now.header);
    known.emplace(path, std::move(now));
  }
  known_ = std::move(known);
  return headers;
}

}  // namespace understudy::volume
