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

Secret read_secret(const std::filesystem::path& file) {
  const FileDescriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!opened || ::fstat(opened.get(), &status) != 0)
    throw std::runtime_error(
        fmt::format("cannot read the secret '{}': {}; copy the file that understudy serve --secret-file uses "
                    "on its machine",
                    file.string(), std::strerror(errno)));
  if (!S_ISREG(status.st_mode))
    throw std::runtime_error(
        fmt::format("the secret '{}' is no file; name the one that holds it", file.string()));
  if (status.st_uid != ::geteuid())
    throw std::runtime_error(
        fmt::format("the secret '{0}' is user {1}'s, who can change it; use a copy of your own: cp {0} "
                    "~/understudy.secret",
                    file.string(), status.st_uid));
  if ((status.st_mode & 077) != 0)
    throw std::runtime_error(
        fmt::format("others may read the secret '{0}'; keep it to yourself: chmod 600 {0}", file.string()));
  std::vector<std::byte> contents(limits::max_secret_bytes + 1);
  const ssize_t bytes = ::read(opened.get(), contents.data(), contents.size());
  if (bytes < ssize_t(limits::min_secret_bytes) || bytes > ssize_t(limits::max_secret_bytes))
    throw std::runtime_error(
        fmt::format("the secret '{}' has not {} to {} bytes; remove it, and understudy serve makes a new one",
                    file.string(), limits::min_secret_bytes, limits::max_secret_bytes));
  const Secret secret(std::span<const std::byte>(contents).first(std::size_t(bytes)));
  ::sodium_memzero(contents.data(), contents.size());
  return secret;
}

Secret read_or_make_secret(const std::filesystem::path& file, bool& made) {
  made = false;
  if (::access(file.c_str(), F_OK) == 0) return read_secret(file);
  if (::sodium_init() < 0) throw std::runtime_error("this machine has no random numbers for secrets");
  std::string fresh = file.string() + ".XXXXXX";
  const FileDescriptor opened(::mkostemp(fresh.data(), O_CLOEXEC));
  std::array<unsigned char, 32> contents{};
  ::randombytes_buf(contents.data(), contents.size());
  bool written = opened && ::write(opened.get(), contents.data(), contents.size()) == ssize_t(contents.size());
  ::sodium_memzero(contents.data(), contents.size());
  // Appears at its place whole or not at all, and takes nobody's place.
  if (written && ::link(fresh.c_str(), file.c_str()) == 0)
    made = true;
  else
    written = written && errno == EEXIST;
  const int reason = errno;
  if (opened) ::unlink(fresh.c_str());
  if (!written)
    throw std::runtime_error(
        fmt::format("cannot make the secret '{}': {}; name a file in a folder that is yours", file.string(),
                    std::strerror(reason)));
  return read_secret(file);
}

}  // namespace understudy::compositor
