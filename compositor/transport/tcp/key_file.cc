// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/key_file.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace understudy::compositor {

namespace {

constexpr std::string_view public_word = "understudy-key ";
constexpr std::string_view private_word = "understudy-private-key ";
constexpr std::size_t text_bytes = sodium_base64_ENCODED_LEN(32, sodium_base64_VARIANT_ORIGINAL) - 1;
constexpr std::size_t private_file_bytes = private_word.size() + text_bytes + 1;
constexpr std::size_t max_line_bytes = 1024;

using KeyBytes = std::array<unsigned char, 32>;

std::string line_of(std::string_view word, std::span<const unsigned char, 32> key) {
  std::array<char, text_bytes + 1> text{};
  ::sodium_bin2base64(text.data(), text.size(), key.data(), key.size(), sodium_base64_VARIANT_ORIGINAL);
  std::string line = fmt::format("{}{}", word, text.data());
  ::sodium_memzero(text.data(), text.size());
  return line;
}

std::optional<KeyBytes> key_in(std::string_view word, std::string_view line) {
  if (!line.starts_with(word) || line.size() < word.size() + text_bytes) return std::nullopt;
  KeyBytes key{};
  std::size_t bytes = 0;
  if (::sodium_base642bin(key.data(), key.size(), line.data() + word.size(), text_bytes, nullptr, &bytes,
                          nullptr, sodium_base64_VARIANT_ORIGINAL) != 0 ||
      bytes != key.size())
    return std::nullopt;
  return key;
}

}  // namespace

std::string line_of(const PublicKey& key) {
  return line_of(public_word, key);
}

KeyPair make_key_file(const std::filesystem::path& file) {
  const std::filesystem::path public_file = file.string() + ".pub";
  if (std::filesystem::exists(public_file))
    throw std::runtime_error(
        fmt::format("'{}' is there already; name another file, or remove it", public_file.string()));
  const KeyPair key;
  std::string line = line_of(private_word, key.private_key()) + "\n";
  const bool made = make_private_file(file, "key", std::as_bytes(std::span(line)));
  ::sodium_memzero(line.data(), line.size());
  if (!made)
    throw std::runtime_error(
        fmt::format("'{}' is there already; name another file, or remove it", file.string()));
  std::ofstream out(public_file);
  out << line_of(key.public_key()) << "\n";
  if (!out.flush()) throw std::runtime_error(fmt::format("cannot write '{}'", public_file.string()));
  return key;
}

KeyPair read_key_file(const std::filesystem::path& file) {
  std::vector<std::byte> contents =
      read_private_file(file, "key", "make one: understudy key FILE", private_file_bytes, private_file_bytes);
  const std::optional<KeyBytes> bytes =
      key_in(private_word, {reinterpret_cast<const char*>(contents.data()), contents.size()});
  ::sodium_memzero(contents.data(), contents.size());
  if (!bytes)
    throw std::runtime_error(
        fmt::format("'{}' holds no key of its owner; make one: understudy key FILE", file.string()));
  const KeyPair key(*bytes);
  return key;
}

std::vector<PublicKey> read_public_keys(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in)
    throw std::runtime_error(
        fmt::format("cannot read the public keys of '{}'; name a file with lines of understudy key's FILE.pub",
                    file.string()));
  std::vector<PublicKey> keys;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line.front() == '#') continue;
    const std::optional<KeyBytes> key = key_in(public_word, line);
    if (!key || line.size() > max_line_bytes || keys.size() == max_public_keys)
      throw std::runtime_error(fmt::format(
          "{}:{}: no public key; a line is one of understudy key's FILE.pub, and there are at most {}",
          file.string(), number, max_public_keys));
    keys.push_back(*key);
  }
  if (keys.empty())
    throw std::runtime_error(
        fmt::format("'{}' has no public key; append a FILE.pub that understudy key made", file.string()));
  return keys;
}

}  // namespace understudy::compositor
