// SPDX-License-Identifier: Apache-2.0
// Compares the entry library with the installed libraries: it must export everything that they export.
#include <dlfcn.h>
#include <elf.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "dispatch/call_id.h"
#include "run_program.h"

namespace {

using understudy::testing::run_program;

/// Names of the functions that a library exports.
std::set<std::string> exported_functions(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  std::set<std::string> names;
  const auto* header = reinterpret_cast<const Elf64_Ehdr*>(bytes.data());
  if (bytes.size() < sizeof *header || std::memcmp(header->e_ident, ELFMAG, SELFMAG) != 0) return names;
  const auto* sections = reinterpret_cast<const Elf64_Shdr*>(bytes.data() + header->e_shoff);
  for (int i = 0; i < header->e_shnum; ++i) {
    if (sections[i].sh_type != SHT_DYNSYM) continue;
    const auto* symbols = reinterpret_cast<const Elf64_Sym*>(bytes.data() + sections[i].sh_offset);
    const char* text = bytes.data() + sections[sections[i].sh_link].sh_offset;
    for (std::size_t s = 0; s < sections[i].sh_size / sizeof *symbols; ++s) {
      if (symbols[s].st_shndx != SHN_UNDEF && ELF64_ST_TYPE(symbols[s].st_info) == STT_FUNC) {
        names.insert(text + symbols[s].st_name);
      }
    }
  }
  return names;
}

const std::set<std::string>& entry_functions() {
  static const std::set<std::string> names = exported_functions(UNDERSTUDY_ENTRY_LIBRARY);
  return names;
}

TEST(EntryPoints, CoverTheWholeRegistry) {
  for (std::size_t number = 0; number < understudy::spu::call_count; ++number) {
    const char* name = understudy::spu::call_name(static_cast<understudy::spu::CallId>(number));
    EXPECT_TRUE(entry_functions().contains(name)) << name;
  }
}

TEST(EntryPoints, CoverWhatTheLibrariesHereExport) {
  for (const char* library : {REAL_GL, REAL_OPENGL, REAL_GLX, REAL_EGL, REAL_OSMESA}) {
    const std::set<std::string> real = exported_functions(library);
    ASSERT_FALSE(real.empty()) << library;
    std::set<std::string> missing;
    for (const std::string& name : real) {
      if (!entry_functions().contains(name)) missing.insert(name);
    }
#if !defined(__x86_64__)
    if (library == std::string(REAL_GL)) {  // interceptor/outside_registry.cc
      EXPECT_LE(missing.size(), 66U);
      continue;
    }
#endif
    EXPECT_THAT(missing, ::testing::IsEmpty()) << library;
    std::printf("%s: %zu functions\n", library, real.size());
  }
}

TEST(EntryPoints, TheEntryLibraryNeedsNoOpenGlNoXAndNoCxxLibrary) {
  const auto outcome = run_program({}, {"readelf", "-d", UNDERSTUDY_ENTRY_LIBRARY});
  ASSERT_TRUE(outcome.says("NEEDED")) << outcome.text;
  for (const std::string& line : outcome.lines()) {
    if (line.find("NEEDED") == std::string::npos) continue;
    EXPECT_TRUE(line.find("[libc.so") != std::string::npos || line.find("[ld-linux") != std::string::npos)
        << line;
  }
}

// The real libGL.so.1 reads this table by position.
TEST(EntryPoints, GlvndsTableHasGlvndsOrder) {
  void* glvnd = dlopen(REAL_GLX, RTLD_NOW | RTLD_LOCAL);
  void* entry = dlopen(UNDERSTUDY_ENTRY_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  ASSERT_TRUE(glvnd && entry) << dlerror();
  auto* theirs = static_cast<void**>(dlsym(glvnd, "__GLXGL_CORE_FUNCTIONS"));
  auto* ours = static_cast<void**>(dlsym(entry, "__GLXGL_CORE_FUNCTIONS"));
  ASSERT_TRUE(theirs && ours);
  Dl_info info;
  Elf64_Sym* symbol = nullptr;
  ASSERT_NE(dladdr1(theirs, &info, reinterpret_cast<void**>(&symbol), RTLD_DL_SYMENT), 0);
  const std::size_t count = symbol->st_size / sizeof(void*);
  ASSERT_NE(dladdr1(ours, &info, reinterpret_cast<void**>(&symbol), RTLD_DL_SYMENT), 0);
  ASSERT_EQ(symbol->st_size / sizeof(void*), count);
  for (std::size_t i = 0; i < count; ++i) {
    Dl_info their_function;
    Dl_info our_function;
    ASSERT_NE(dladdr(theirs[i], &their_function), 0);
    ASSERT_NE(dladdr(ours[i], &our_function), 0);
    ASSERT_TRUE(their_function.dli_sname && our_function.dli_sname) << i;
    // glXGetProcAddressARB is an alias of glXGetProcAddress in glvnd.
    EXPECT_EQ(std::string(their_function.dli_sname).substr(0, 17),
              std::string(our_function.dli_sname).substr(0, 17))
        << i;
  }
}

}  // namespace
