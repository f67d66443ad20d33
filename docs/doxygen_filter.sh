#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Doxygen's INPUT_FILTER: the comment at a header's top says what is in it, and becomes the file's description.
#
#   doxygen_filter.sh FILE
exec sed -e '/SPDX-/d' -e '1,/#pragma once/{s|^//\([^/]\)|///\1|;s|^//$|///|;s|^#pragma once|/// \\file\n#pragma once|}' "$1"
