// SPDX-License-Identifier: Apache-2.0
// The nesting depth of sequences in a DICOM file (part 5, chapter 7).
#pragma once

#include "volume/file/byte_source.h"

namespace understudy::volume {

/// Whether everything before the pixels consists of valid DICOM elements, and no sequence is nested in more
/// than `most` others. DCMTK 3.6.7 recurses for each level, until its stack overflows. Throws FileError if the
/// file cannot be read.
bool sequences_nest_within(ByteSource& file, int most);

}  // namespace understudy::volume
