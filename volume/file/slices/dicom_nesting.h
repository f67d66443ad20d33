// SPDX-License-Identifier: Apache-2.0
// How deep sequences lie in each other in a DICOM file (part 5, chapter 7).
#pragma once

#include "volume/file/byte_source.h"

namespace understudy::volume {

/// Whether all that comes before the pixels is made of DICOM's elements, and no sequence lies in more than
/// `most` others. DCMTK 3.6.7 calls itself for each of them, until its stack ends. Throws FileError where the
/// file cannot be read.
bool sequences_nest_within(ByteSource& file, int most);

}  // namespace understudy::volume
