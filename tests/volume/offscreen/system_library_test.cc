// SPDX-License-Identifier: Apache-2.0
#include "volume/offscreen/system_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace understudy::volume::offscreen {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const ContextUnavailable& absent) {
    return absent.what();
  }
  return "it worked";
}

TEST(SystemLibrary, OpensTheFirstNameThatThereIs) {
  const SystemLibrary c({"libNobodyHas.so.1", "libc.so.6"}, "libc6");
  int (*length)(const char*) = nullptr;
  c.find("strlen", "libc6", length);
  EXPECT_NE(length, nullptr);
}

TEST(SystemLibrary, NamesEveryLibraryThatIsMissingAndWhatToInstall) {
  EXPECT_THAT(
      message_of([] {
        SystemLibrary({"libNobodyHas.so.2", "libNobodyHas.so.1"}, "libnobody2");
      }),
      AllOf(HasSubstr("libNobodyHas.so.2"), HasSubstr("libNobodyHas.so.1"), HasSubstr("install libnobody2")));
}

TEST(SystemLibrary, NamesAFunctionThatIsMissingAndTheVersionThatHasIt) {
  const SystemLibrary c({"libc.so.6"}, "libc6");
  void (*missing)() = nullptr;
  EXPECT_EQ(message_of([&] { c.find("nobody_has_this", "libc6 of another year", missing); }),
            "libc.so.6 has no nobody_has_this; install libc6 of another year");
}

}  // namespace
}  // namespace understudy::volume::offscreen
