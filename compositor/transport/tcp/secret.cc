// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/secret.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/limits.h"

namespace understudy::compositor {

Secret::Secret(std::span<const std::byte> contents) {
  static_assert(crypto_auth_KEYBYTES == 32);
  if (::sodium_init() < 0) throw std::runtime_error("this machine has no random numbers for secrets");
  ::crypto_generichash(key_.data(), key_.size(), reinterpret_cast<const unsigned char*>(contents.data()),
                       contents.size(), nullptr, 0);
}

Secret::~Secret() {
  ::sodium_memzero(key_.data(), key_.size());
}

std::vector<std::byte> read_private_file(const std::filesystem::path& file, std::string_view what,
                                         std::string_view origin, std::size_t least, std::size_t most) {
  const FileDescriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!opened || ::fstat(opened.get(), &status) != 0)
    throw std::runtime_error(
        fmt::format("cannot read the {} '{}': {}; {}", what, file.string(), std::strerror(errno), origin));
  if (!S_ISREG(status.st_mode))
    throw std::runtime_error(
        fmt::format("the {} '{}' is no file; name the one that holds it", what, file.string()));
  if (status.st_uid != ::geteuid())
    throw std::runtime_error(
        fmt::format("the {0} '{1}' is user {2}'s, who can change it; use a copy of your own: cp {1} "
                    "~/understudy.{0}",
                    what, file.string(), status.st_uid));
  if ((status.st_mode & 077) != 0)
    throw std::runtime_error(
        fmt::format("others may read the {0} '{1}'; keep it to yourself: chmod 600 {1}", what, file.string()));
  std::vector<std::byte> contents(most + 1);
  const ssize_t bytes = ::read(opened.get(), contents.data(), contents.size());
  const bool fits = bytes >= ssize_t(least) && bytes <= ssize_t(most);
  contents.resize(fits ? std::size_t(bytes) : 0);
  return contents;
}

bool make_private_file(const std::filesystem::path& file, std::string_view what,
                       std::span<const std::byte> contents) {
  std::string fresh = file.string() + ".XXXXXX";
  const FileDescriptor opened(::mkostemp(fresh.data(), O_CLOEXEC));
  const bool written =
      opened && ::write(opened.get(), contents.data(), contents.size()) == ssize_t(contents.size());
  // The file appears complete or not at all, and replaces no other.
  const bool made = written && ::link(fresh.c_str(), file.c_str()) == 0;
  const int reason = errno;
  if (opened) ::unlink(fresh.c_str());
  if (!made && (!written || reason != EEXIST))
    throw std::runtime_error(fmt::format("cannot make the {} '{}': {}; name a file in a folder that is yours",
                                         what, file.string(), std::strerror(reason)));
  return made;
}

Secret read_secret(const std::filesystem::path& file) {
  std::vector<std::byte> contents =
      read_private_file(file, "secret", "copy the file that understudy serve --secret-file uses on its machine",
                        limits::min_secret_bytes, limits::max_secret_bytes);
  if (contents.empty())
    throw std::runtime_error(
        fmt::format("the secret '{}' has not {} to {} bytes; remove it, and understudy serve makes a new one",
                    file.string(), limits::min_secret_bytes, limits::max_secret_bytes));
  const Secret secret(contents);
  ::sodium_memzero(contents.data(), contents.size());
  return secret;
}

Secret read_or_make_secret(const std::filesystem::path& file, bool& made) {
  made = false;
  if (::access(file.c_str(), F_OK) == 0) return read_secret(file);
  if (::sodium_init() < 0) throw std::runtime_error("this machine has no random numbers for secrets");
  std::array<unsigned char, 32> contents{};
  ::randombytes_buf(contents.data(), contents.size());
  made = make_private_file(file, "secret", std::as_bytes(std::span(contents)));
  ::sodium_memzero(contents.data(), contents.size());
  return read_secret(file);
}

}  // namespace understudy::compositor
