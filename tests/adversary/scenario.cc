// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"

namespace adversary {

const char* text_of(Expectation expectation) {
  switch (expectation) {
    case Expectation::must_be_substituted:
      return "must be substituted";
    case Expectation::must_be_left:
      return "must be left";
    default:
      return "either";
  }
}

}  // namespace adversary
