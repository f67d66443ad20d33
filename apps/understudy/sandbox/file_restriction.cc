// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/sandbox/file_restriction.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "compositor/transport/file_descriptor.h"

namespace understudy::launcher {
namespace {

using compositor::FileDescriptor;

// Defined here because kernels are often newer than the distribution's headers.
constexpr std::uint64_t refer_right = 1ULL << 13;     // version 2
constexpr std::uint64_t truncate_right = 1ULL << 14;  // version 3
constexpr std::uint64_t tcp_rights = 3;               // version 4: bind and connect
constexpr std::uint64_t other_processes = 3;          // version 6: abstract sockets and signals

constexpr std::uint64_t listing = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t reading = listing | LANDLOCK_ACCESS_FS_EXECUTE;
/// The kernel accepts only these rights for anything but folders.
constexpr std::uint64_t of_single_files =
    LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE | truncate_right;

struct RulesetAttributes {
  std::uint64_t files = 0;
  std::uint64_t network = 0;
  std::uint64_t scope = 0;
};

/// Returns how many bytes of the structure a kernel of this version supports.
std::size_t bytes_known(int version) {
  if (version >= 6) return sizeof(RulesetAttributes);
  return version >= 4 ? offsetof(RulesetAttributes, scope) : offsetof(RulesetAttributes, network);
}

std::uint64_t writing_rights(int version) {
  std::uint64_t rights = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                         LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                         LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
                         LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO |
                         LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;
  if (version >= 2) rights |= refer_right;
  if (version >= 3) rights |= truncate_right;
  return rights;
}

class Ruleset {
 public:
  explicit Ruleset(int version, const RulesetAttributes& attributes)
      : rules_(int(::syscall(SYS_landlock_create_ruleset, &attributes, bytes_known(version), 0))) {
    if (!rules_) trouble_ = fmt::format("Landlock cannot create a ruleset: {}", std::strerror(errno));
  }

  /// Missing files need no rule.
  void allow(const std::vector<std::filesystem::path>& files, std::uint64_t rights) {
    for (const std::filesystem::path& file : files) allow(file, rights);
  }

  std::string enforce() {
    if (!trouble_.empty()) return trouble_;
    if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        ::syscall(SYS_landlock_restrict_self, rules_.get(), 0) != 0)
      return fmt::format("Landlock cannot be enforced: {}", std::strerror(errno));
    return {};
  }

 private:
  void allow(const std::filesystem::path& file, std::uint64_t rights) {
    const FileDescriptor opened(::open(file.c_str(), O_PATH | O_CLOEXEC));
    struct stat about {};
    if (!opened || !rules_ || ::fstat(opened.get(), &about) != 0) return;
    landlock_path_beneath_attr rule{};
    rule.allowed_access = S_ISDIR(about.st_mode) ? rights : rights & of_single_files;
    rule.parent_fd = opened.get();
    if (::syscall(SYS_landlock_add_rule, rules_.get(), LANDLOCK_RULE_PATH_BENEATH, &rule, 0) != 0)
      trouble_ = fmt::format("Landlock rejects the rule for {}: {}", file.string(), std::strerror(errno));
  }

  FileDescriptor rules_;
  std::string trouble_;
};

constexpr const char* no_landlock =
    "this kernel has no Landlock, which needs Linux 5.13 or later and lsm=landlock";

}  // namespace

int landlock_version() {
  const long version = ::syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  return version > 0 ? int(version) : 0;
}

std::string restrict_files(const UsableFiles& files) {
  const int version = landlock_version();
  if (version == 0) return no_landlock;
  const std::uint64_t all = reading | writing_rights(version);
  Ruleset rules(version, {.files = all, .network = tcp_rights, .scope = other_processes});
  rules.allow(files.read, reading);
  rules.allow(files.written, all);
  rules.allow(files.devices, listing | LANDLOCK_ACCESS_FS_WRITE_FILE);
  return rules.enforce();
}

}  // namespace understudy::launcher
