// SPDX-License-Identifier: Apache-2.0
// The auditor, for LD_AUDIT: the loader asks this library where to look for each library it is about to load.
//
// It runs in a link namespace with its own C library, so it is restricted to a few lines of C.
#include <dlfcn.h>
#include <limits.h>
#include <link.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "interceptor/gl_names.h"
#include "spu/former_names.h"

using namespace understudy::interceptor;

namespace {

StubPaths stubs;
char entry_library[PATH_MAX];

void set_folder(const char* folder) {
  stubs.set_folder(folder);
  const int length = snprintf(entry_library, sizeof entry_library, "%s/../libunderstudy.so", folder);
  if (length < 0 || length >= PATH_MAX) entry_library[0] = '\0';
}

void find_stubs() {
  const char* given = secure_getenv("UNDERSTUDY_ENTRY_DIR");
  if (given == nullptr) given = secure_getenv(understudy::spu::former_entry_folder_variable);
  char folder[PATH_MAX];
  Dl_info self;
  if (given != nullptr && *given != '\0') {
    set_folder(given);
  } else if (dladdr(&stubs, &self) != 0 && realpath(self.dli_fname, folder) != nullptr) {
    const size_t own_name = static_cast<size_t>(base_name(folder) - folder);
    snprintf(folder + own_name, sizeof folder - own_name, "entry");
    set_folder(folder);
  }
}

}  // namespace

#define AUDIT_INTERFACE extern "C" __attribute__((visibility("default")))

AUDIT_INTERFACE unsigned la_version(unsigned offered) {
  find_stubs();
  return offered < LAV_CURRENT ? offered : LAV_CURRENT;
}

AUDIT_INTERFACE unsigned la_objopen(struct link_map* map, Lmid_t, uintptr_t* cookie) {
  *cookie = reinterpret_cast<uintptr_t>(map);
  return 0;
}

AUDIT_INTERFACE char* la_objsearch(const char* name, uintptr_t* cookie, unsigned flag) {
  // The loader gives a stub the name of the file that it replaces, so its $ORIGIN would be that file's folder.
  if (strcmp(name, "libunderstudy.so") == 0 && entry_library[0] != '\0') return entry_library;
  const int stub = stub_for(name);
  if (stub < 0 || stubs.path[stub][0] == '\0') return const_cast<char*>(name);
  // Most names are replaced before the loader searches for a file. For OSMesa, the loader searches until it
  // reaches a file that exists.
  const bool answered_now =
      stub == osmesa_stub ? strchr(name, '/') != nullptr && access(name, R_OK) == 0 : flag == LA_SER_ORIG;
  if (!answered_now) return const_cast<char*>(name);
  const auto* asker = reinterpret_cast<const struct link_map*>(*cookie);
  const bool real = asker != nullptr && asker->l_name != nullptr &&
                    may_have_the_real_one(asker->l_name, secure_getenv("UNDERSTUDY_DRIVER_DIR"));
  return real ? const_cast<char*>(name) : stubs.path[stub];
}
