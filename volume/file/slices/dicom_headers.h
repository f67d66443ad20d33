// SPDX-License-Identifier: Apache-2.0
// A cache of parsed DICOM headers, for opening the time steps of one folder in turn.
#pragma once

#include <sys/types.h>

#include <ctime>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "volume/file/readable_files.h"
#include "volume/file/slices/dicom_image.h"

namespace understudy::volume {

class DicomHeaders {
 public:
  /// The headers of `paths`, in their order, without files that contain no image. Only files that have changed
  /// are parsed again. Headers of other files are dropped. Throws FileError.
  std::vector<std::shared_ptr<const DicomHeader>> of(std::span<const std::string> paths,
                                                     const ReadableFiles& files);

 private:
  /// Detects whether a file was replaced or modified.
  struct Version {
    dev_t device = 0;
    ino_t number = 0;
    off_t bytes = 0;
    timespec written{};
    timespec changed{};  ///< time of the last write, rename or change of attributes

    bool operator==(const Version& other) const;
  };
  struct Known {
    Version version;
    std::shared_ptr<const DicomHeader> header;  ///< null: no image
  };

  static Version version_of(const std::string& path, const ReadableFiles& files);

  std::map<std::string, Known> known_;
};

}  // namespace understudy::volume
