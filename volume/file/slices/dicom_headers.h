// SPDX-License-Identifier: Apache-2.0
// Headers of DICOM files that were parsed before, for those who open the time steps of one folder in turn.
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
  /// Those of `paths`, in their order, without the files that hold no image. A file is parsed again only where
  /// it has changed since. Those of other files are forgotten. Throws FileError.
  std::vector<std::shared_ptr<const DicomHeader>> of(std::span<const std::string> paths,
                                                     const ReadableFiles& files);

 private:
  /// What tells that a file is another one, or was written to.
  struct Version {
    dev_t device = 0;
    ino_t number = 0;
    off_t bytes = 0;
    timespec written{};
    timespec changed{};  ///< written to, renamed or given another time

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
